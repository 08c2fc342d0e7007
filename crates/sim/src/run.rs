//! One run.

use crate::costs::{CostProbe, StepGroups};
use crate::drive::Session;
use crate::exact::{Exact, SceneAhead};
use crate::exhibits::costs::show as show_costs;
use crate::held;
use crate::machines::{MachineConfig, MachineSpec, for_machine};
use crate::observer::Observer;
use crate::outcome::{Run, SessionError};
use crate::prepared::Prepared;
use crate::record::{CountedDraws, Passed, SceneHash};
use crate::rehearsal::rehearsed;
use crate::settings::{RunInput, RunOptions, When};
use crate::tee::{Tee, TraceNotes};
use basrelief_deferred_renderer::TileSource;
use basrelief_kernel::{Machine, Netlist, NoProbe, Probe};
use basrelief_machines::{ConfigProblem, Draws, SceneFront, TraceFront, UnitStats, numeral_of};
use basrelief_report::model::Input;
use basrelief_signals::Control;
use basrelief_timeline::TimelineLayout;
use basrelief_trace::{Files, Resolver};
use serde::{Deserialize, Serialize};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;
use std::rc::Rc;

/// The machine under these settings, as a time line shows it.
///
/// # Errors
/// Parameters that do not fit together.
pub fn board(source: &RunInput, settings: &RunOptions) -> Result<TimelineLayout, ConfigProblem> {
    for_machine!(&settings.config, spec => board_of(spec, source))
}

fn board_of<S: MachineSpec>(spec: &S, source: &RunInput) -> Result<TimelineLayout, ConfigProblem> {
    let way = match source {
        RunInput::Scene(_) | RunInput::Remote { .. } => Way::Scene,
        RunInput::Trace { .. } => Way::Trace,
    };
    let hz = serde_json::to_value(spec).unwrap_or_default().pointer("/clock/hz").and_then(serde_json::Value::as_u64);
    let mut board = TimelineLayout::new(S::NAME, hz.unwrap_or(0), way.shape(spec)?.diagram());
    board.numerals = board.diagram.stages.iter().map(|stage| numeral_of(S::DIAGRAM, &stage.name).to_owned()).collect();
    Ok(board)
}

/// The way in: what draws at the front of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Way {
    /// The geometry processor.
    Scene,
    /// A display list.
    Trace,
}

impl Way {
    /// The machine behind this way in, without its units.
    pub(crate) fn shape<S: MachineSpec>(self, spec: &S) -> Result<Netlist, ConfigProblem> {
        let shape = match self {
            Self::Scene => Netlist::of(&mut unfed(spec)?),
            Self::Trace => Netlist::of(&mut unfed_trace(spec)?),
        };
        // Its wiring was checked when it was built.
        shape.map_err(|error| ConfigProblem { key: "wiring".into(), message: error.to_string() })
    }

    /// What its units tell before they have done anything.
    pub(crate) fn facts<S: MachineSpec>(self, spec: &S) -> Result<UnitStats, ConfigProblem> {
        match self {
            Self::Scene => unfed(spec).map(|mut machine| machine.facts()),
            Self::Trace => unfed_trace(spec).map(|mut machine| machine.facts()),
        }
    }
}

impl MachineConfig {
    /// Whether its parameters, each in its range, fit together.
    ///
    /// # Errors
    /// Where they do not: the parameter to change, and what to do.
    pub fn check(&self) -> Result<(), ConfigProblem> {
        for_machine!(self, spec => unfed(spec).map(|_| ()))
    }

    /// Names of its memories, in order of number, each with the bytes of its bursts.
    ///
    /// # Errors
    /// As [`MachineConfig::check`].
    pub fn memories(&self) -> Result<Vec<(String, u32)>, ConfigProblem> {
        for_machine!(self, spec => {
            let mut machine = unfed(spec)?;
            Ok(machine.memories().names_and_bursts().map(|(name, bytes)| (name.to_owned(), bytes)).collect())
        })
    }
}

/// A display list on its way into a machine. Behind a pointer: each type of it would be another machine to be compiled.
type Passing = Box<dyn Iterator<Item = Result<(Control, Option<u64>), String>>>;

/// The machine with nothing to draw.
pub(crate) fn unfed<S: MachineSpec>(spec: &S) -> Result<impl Draws + use<S>, ConfigProblem> {
    spec.build(SceneFront::new(CountedDraws::none(), spec.front()))
}

/// The same behind a display list.
pub(crate) fn unfed_trace<S: MachineSpec>(spec: &S) -> Result<impl Draws + use<S>, ConfigProblem> {
    spec.build(TraceFront::new(Box::new(std::iter::empty()) as Passing, spec.front()))
}

/// Runs `source` on the machine: draws it, draws it exactly, measures, reports; `probe` watches every stage.
///
/// A deadlock, the limit of cycles and a stop by the observer are outcomes in the report.
///
/// # Errors
/// What keeps a run from giving a report: see [`SessionError`].
pub fn run(
    source: RunInput,
    settings: &RunOptions,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Probe>,
) -> Result<Run, SessionError> {
    if settings.costs {
        return run_costed(source, settings, observer, probe);
    }
    run_following((source, None), settings, observer, probe)
}

/// For whom steps are, where that is followed.
type Steps = Option<Rc<RefCell<StepGroups>>>;

fn run_following(
    (source, steps): (RunInput, Steps),
    settings: &RunOptions,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Probe>,
) -> Result<Run, SessionError> {
    match probe {
        // By pointer: so the machines are compiled once, with this crate, and not once more in every program that runs them;
        // that took a fifth of the time of a test build.
        Some(mut probe) => run_probed((source, steps), settings, observer, &mut probe),
        #[cfg(feature = "unwatched")]
        None => run_probed((source, steps), settings, observer, &mut NoProbe),
        #[cfg(not(feature = "unwatched"))]
        None => run_following((source, steps), settings, observer, Some(&mut NoProbe)),
    }
}

/// The same, and what it has cost.
fn run_costed(
    source: RunInput,
    settings: &RunOptions,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Probe>,
) -> Result<Run, SessionError> {
    let points = settings.config.cost_points();
    let stages = board(&source, settings)?.diagram.stages;
    let steps = StepGroups::new(stages.len(), settings.budget.nothing());
    let steps = (settings.limits != When::Never).then(|| Rc::new(RefCell::new(steps)));
    let within = (settings.max_cycles, &settings.budget);
    let mut costs = CostProbe::new(stages, points, within, steps.clone(), probe);
    let names = match &source {
        RunInput::Scene(prepared) | RunInput::Remote { scene: prepared, .. } => {
            prepared.scene().objects.iter().map(|object| (object.id, object.name.clone())).collect()
        }
        RunInput::Trace { .. } => BTreeMap::new(),
    };
    let run = run_following((source, steps), settings, observer, Some(&mut costs));
    costs.check()?;
    let mut run = run?;
    let Some(timing) = &run.timing else { return Ok(run) };
    let costs = costs.finish(timing);
    show_costs(&costs, observer).map_err(SessionError::Observer)?;
    run.report.costs = Some(costs.report(&names));
    if let Some(path) = &mut run.report.critical_path {
        path.polygons = Some(costs.path(&run.path_groups));
    }
    run.costs = Some(costs);
    Ok(run)
}

fn run_probed<P: Probe>(
    (source, steps): (RunInput, Steps),
    settings: &RunOptions,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    for_machine!(&settings.config, spec => match source {
        RunInput::Scene(prepared) => run_scene((&prepared, None, steps), spec, settings, observer, probe),
        RunInput::Trace { reader, files, name } => run_trace((reader, files, name), steps, spec, settings, observer, probe),
        RunInput::Remote { scene, tiles, .. } => run_scene((&scene, Some(tiles), steps), spec, settings, observer, probe),
    })
}

fn run_scene<S: MachineSpec, P: Probe>(
    (prepared, tiles, steps): (&Prepared, Option<Box<dyn TileSource>>, Steps),
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    let scene = prepared.scene();
    let _textures = held::textures(scene, S::TEXTURE_COPIES, &settings.budget)?;
    let is_here = tiles.is_none();
    // Who fetches from a real server looks by a real clock; and runs ahead of the run would ask it for its tiles more than once.
    let spec = if is_here { &rehearsed(scene, spec, settings, observer)? } else { spec };
    let passed = Rc::new(Cell::new(Passed::default()));
    let front = SceneFront::new(CountedDraws::new(scene, &passed), spec.front());
    let machine = match tiles {
        Some(tiles) => spec.build_remote(front, tiles)?,
        None => spec.build(front)?,
    };
    let hash = SceneHash::start(prepared, spec.front());
    let per_frame: usize = 2 + scene.objects.iter().map(|o| o.mesh.indices.len() / 3 + 1).sum::<usize>();
    let exact = if settings.exact && is_here { Exact::Scene(SceneAhead::new(prepared, spec.exact_style())) } else { Exact::None };
    let total = Some((per_frame * scene.frames.len()) as u64);
    let commands = Rc::clone(&passed);
    let mut session = Session::new(settings, observer, exact, Box::new(move || (commands.get().commands, total)));
    session.groups = steps;
    // On a real path the next one is waited for; who watches is to see this one by then.
    session.behind = usize::from(is_here);
    let result = session.drive((spec, Way::Scene), machine, probe)?;
    let digest = if passed.get().all { hash.get()? } else { None };
    let sha256 = digest.map(|d| d.to_string()).unwrap_or_default();
    let input = Input { kind: "scene".into(), name: file_name(&scene.name), sha256 };
    let frame = scene.frames.last().map(|f| &**f);
    Ok(session.finish(spec, input, frame, result, &scene.warnings, vec![]))
}

fn run_trace<S: MachineSpec, P: Probe>(
    (reader, mut files, name): (Box<dyn Read>, Box<dyn Files>, String),
    steps: Steps,
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    if spec.acts_at_times() {
        // It is read once, as a stream.
        let message = "a display list is read once, and runs ahead find where views are left at their times: give tiles, `defer.left_at_tile`";
        return Err(SessionError::Fault(message.into()));
    }
    let resolver = Resolver::within(reader, move |name: &str| files.open(name), &settings.budget)?;
    let resolver = resolver.with_texture_copies(S::TEXTURE_COPIES);
    let pictures = held::pictures(settings, resolver.begin());
    let _pictures = pictures.map_err(|error| resolver.over_budget(&error))?;
    let seen = Rc::new(RefCell::new(TraceNotes::default()));
    let tee = Tee::new(resolver, settings.exact.then(|| spec.exact_style()), Rc::clone(&seen), settings);
    let front = TraceFront::new(Box::new(tee) as Passing, spec.front());
    let machine = spec.build(front)?;
    // The first command is read when the machine is built, ahead of the simulation.
    let ahead = seen.borrow().seconds;
    let exact = if settings.exact { Exact::Trace(Rc::clone(&seen)) } else { Exact::None };
    let commands = Rc::clone(&seen);
    let mut session = Session::new(settings, observer, exact, Box::new(move || (commands.borrow().commands, None)));
    session.groups = steps;
    let result = session.drive((spec, Way::Trace), machine, probe);
    if let Some(error) = seen.borrow_mut().error.take() {
        return Err(error.into());
    }
    let result = result?;
    let passed = std::mem::take(&mut *seen.borrow_mut());
    session.simulate_s -= passed.seconds - ahead;
    let sha256 = passed.digest.map(|d| d.to_string()).unwrap_or_default();
    let input = Input { kind: "trace".into(), name: file_name(&name), sha256 };
    Ok(session.finish(spec, input, passed.frame.as_deref(), result, &[], passed.expectations))
}

/// A name without its folders: reports do not differ between them.
fn file_name(name: &str) -> String {
    Path::new(name).file_name().map_or_else(|| name.into(), |file| file.to_string_lossy().into_owned())
}
