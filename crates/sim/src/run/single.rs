//! One run.

use super::display_list::{DrawProgress, SceneHash, counted_draws};
use super::exact::{ExactSource, SceneExact};
use super::memory_estimates;
use super::result::{RunError, RunResult};
use super::session::{ActiveRun, InputInfo};
use super::trace_tap::{TraceNotes, TraceTap};
use super::view_schedule_solver::solve_view_schedule;
use crate::analysis::costs::{CostOptions, CostProbe, StepPolygons};
use crate::machine::SimulatedMachine;
use crate::observer::Observer;
use crate::options::{AnalysisPolicy, RunInput, RunOptions};
use crate::outputs::cost_maps::send_maps as show_cost_maps;
use crate::prepared::PreparedScene;
use basrelief_deferred_renderer::TileSource;
use basrelief_kernel::Probe;
use basrelief_machines::{ConfigProblem, FrontEnd, InputKind, MachineSpec, for_machine, numeral_of};
use basrelief_parameters::to_json;
use basrelief_report::model::Input;
use basrelief_timeline::TimelineLayout;
use basrelief_trace::{BeginCommand, TextureFiles, TraceResolver};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;
use std::rc::Rc;

/// Returns the layout of timelines for a run.
///
/// # Errors
/// Parameters that do not fit together.
pub fn timeline_layout(source: &RunInput, options: &RunOptions) -> Result<TimelineLayout, ConfigProblem> {
    for_machine!(&options.config, spec => layout(spec, source.kind()))
}

fn layout<S: MachineSpec>(spec: &S, input: InputKind) -> Result<TimelineLayout, ConfigProblem> {
    let hz = to_json(spec).unwrap_or_default().pointer("/clock/hz").and_then(serde_json::Value::as_u64);
    let mut board = TimelineLayout::new(S::NAME, hz.unwrap_or(0), input.shape(spec)?.diagram());
    board.numerals = board.diagram.stages.iter().map(|stage| numeral_of(S::DIAGRAM, &stage.name).to_owned()).collect();
    Ok(board)
}

/// Runs an input on the machine: simulates it, draws the reference image, compares both, and makes the report. `probe` observes every
/// stage.
///
/// A deadlock, the cycle limit, and a stop by the observer are outcomes in the report.
///
/// # Errors
/// See [`RunError`].
pub fn run(
    source: RunInput,
    options: &RunOptions,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Probe>,
) -> Result<RunResult, RunError> {
    if options.costs {
        return run_with_costs(source, options, observer, probe);
    }
    let job = RunJob { options, observer, step_polygons: None };
    job.run(source, probe)
}

/// Options of a run, with the parts that differ between runs with and without costs.
struct RunJob<'a> {
    options: &'a RunOptions,
    observer: &'a mut dyn Observer,
    /// Polygon of each step, if the critical path is broken down by polygon.
    step_polygons: Option<Rc<RefCell<StepPolygons>>>,
}

/// A scene and its tiles.
struct SceneInput {
    prepared: PreparedScene,
    /// Tiles of a server.
    tiles: Option<Box<dyn TileSource>>,
}

/// A trace, as in [`RunInput::Trace`].
struct TraceInput {
    reader: Box<dyn Read>,
    files: Box<dyn TextureFiles>,
    name: String,
}

/// Runs an input, and attributes its cycles.
fn run_with_costs(
    source: RunInput,
    options: &RunOptions,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Probe>,
) -> Result<RunResult, RunError> {
    let stages = timeline_layout(&source, options)?.diagram.stages;
    let polygons = StepPolygons::new(stages.len(), options.budget.empty_reservation());
    let polygons = (options.bottlenecks != AnalysisPolicy::Never).then(|| Rc::new(RefCell::new(polygons)));
    let (points, end, budget) = (options.config.cost_points(), options.max_cycles, &options.budget);
    let mut costs = CostProbe::new(stages, CostOptions { points, end, budget }, polygons.clone(), probe);
    let names = match &source {
        RunInput::Scene(prepared) | RunInput::Remote { scene: prepared, .. } => {
            prepared.scene().objects.iter().map(|object| (object.id, object.name.clone())).collect()
        }
        RunInput::Trace { .. } => BTreeMap::new(),
    };
    let run = RunJob { options, observer: &mut *observer, step_polygons: polygons }.run(source, Some(&mut costs));
    costs.check()?;
    let mut run = run?;
    let Some(timing) = &run.timing else { return Ok(run) };
    let costs = costs.finish(timing);
    show_cost_maps(&costs, observer).map_err(RunError::Observer)?;
    run.report.costs = Some(costs.report(&names));
    if let Some(path) = &mut run.report.critical_path {
        path.polygons = Some(costs.path(&run.path_groups));
    }
    run.costs = Some(costs);
    Ok(run)
}

impl RunJob<'_> {
    fn run(self, source: RunInput, probe: Option<&mut dyn Probe>) -> Result<RunResult, RunError> {
        let options = self.options;
        for_machine!(&options.config, spec => match source {
            RunInput::Scene(prepared) => self.run_scene(SceneInput { prepared, tiles: None }, spec, probe),
            RunInput::Trace { reader, files, name } => self.run_trace(TraceInput { reader, files, name }, spec, probe),
            RunInput::Remote { scene, tiles, .. } => self.run_scene(SceneInput { prepared: scene, tiles: Some(tiles) }, spec, probe),
        })
    }

    fn run_scene<S: SimulatedMachine>(
        self,
        source: SceneInput,
        spec: &S,
        probe: Option<&mut dyn Probe>,
    ) -> Result<RunResult, RunError> {
        let Self { options, observer, step_polygons } = self;
        let SceneInput { prepared, tiles } = source;
        let scene = prepared.scene();
        let _textures = memory_estimates::reserve_textures(scene, S::TEXTURE_COPIES, &options.budget)?;
        let _pictures = memory_estimates::reserve_frames::<S>(options, scene)?;
        let is_local = tiles.is_none();
        // With a real server, the clock is real too, and preliminary runs would request the tiles more than once.
        let spec = if is_local { &solve_view_schedule(scene, spec, options, observer)? } else { spec };
        let progress = Rc::new(Cell::new(DrawProgress::default()));
        let front = FrontEnd::of_scene(counted_draws(scene, &progress), spec.front());
        let machine = match tiles {
            Some(tiles) => spec.build_remote(front, tiles)?,
            None => spec.build(front)?,
        };
        let hash = SceneHash::start(&prepared, spec.front());
        let per_frame: usize = 2 + scene.objects.iter().map(|o| o.mesh.indices.len() / 3 + 1).sum::<usize>();
        let exact = if options.exact && is_local {
            ExactSource::Scene(SceneExact::new(&prepared, spec.exact_style()))
        } else {
            ExactSource::None
        };
        let total = Some((per_frame * scene.frames.len()) as u64);
        let commands = Rc::clone(&progress);
        let mut session = ActiveRun::new(options, observer, exact, Box::new(move || (commands.get().commands, total)));
        session.step_polygons = step_polygons;
        // With a real server, the machine waits for the path. A frame is passed on before the next one begins.
        session.max_comparing = usize::from(is_local);
        let result = session.run_machine(spec, InputKind::Scene, machine, probe)?;
        let digest = if progress.get().all { hash.get()? } else { None };
        let sha256 = digest.map(|d| d.to_string()).unwrap_or_default();
        let input = Input { kind: "scene".into(), name: file_name(&scene.name), sha256 };
        let frame = scene.frames.last().map(|f| &**f);
        Ok(session.finish(spec, InputInfo { input, frame, warnings: &scene.warnings, expectations: vec![] }, result))
    }

    fn run_trace<S: SimulatedMachine>(
        self,
        source: TraceInput,
        spec: &S,
        probe: Option<&mut dyn Probe>,
    ) -> Result<RunResult, RunError> {
        let Self { options, observer, step_polygons } = self;
        let TraceInput { reader, files, name } = source;
        if spec.acts_at_times() {
            // A trace is a stream that can be read only once.
            let message = "a trace can be read only once, but the times in `defer.left_at_ms` need preliminary runs; set `defer.left_at_tile` instead";
            return Err(RunError::Fault(message.into()));
        }
        let resolver = TraceResolver::new(reader, files, &options.budget)?;
        let resolver = resolver.with_texture_copies(S::TEXTURE_COPIES);
        let &BeginCommand { width, height, .. } = resolver.begin();
        let pictures = memory_estimates::reserve_pictures::<S>(options, [width, height]);
        let _pictures = pictures.map_err(|error| resolver.over_budget(&error))?;
        let seen = Rc::new(RefCell::new(TraceNotes::default()));
        let tap = TraceTap::new(resolver, options.exact.then(|| spec.exact_style()), Rc::clone(&seen), options);
        let machine = spec.build(FrontEnd::of_trace(tap, spec.front()))?;
        // The first command is read when the machine is built, before the simulation.
        let ahead = seen.borrow().seconds;
        let exact = if options.exact { ExactSource::Trace(Rc::clone(&seen)) } else { ExactSource::None };
        let commands = Rc::clone(&seen);
        let mut session = ActiveRun::new(options, observer, exact, Box::new(move || (commands.borrow().commands, None)));
        session.step_polygons = step_polygons;
        let result = session.run_machine(spec, InputKind::Trace, machine, probe);
        if let Some(error) = seen.borrow_mut().error.take() {
            return Err(error.into());
        }
        let result = result?;
        let seen = std::mem::take(&mut *seen.borrow_mut());
        session.simulate_s -= seen.seconds - ahead;
        let sha256 = seen.digest.map(|d| d.to_string()).unwrap_or_default();
        let input = Input { kind: "trace".into(), name: file_name(&name), sha256 };
        let warnings: Vec<String> = seen.dented.iter().map(ToString::to_string).collect();
        let info = InputInfo { input, frame: seen.frame.as_deref(), warnings: &warnings, expectations: seen.expectations };
        Ok(session.finish(spec, info, result))
    }
}

/// Returns the file name without folders, so that reports do not depend on them.
fn file_name(name: &str) -> String {
    Path::new(name).file_name().map_or_else(|| name.into(), |file| file.to_string_lossy().into_owned())
}
