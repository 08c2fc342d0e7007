//! One run.

use crate::device::Device;
use crate::drive::Session;
use crate::exact::Exact;
use crate::machine::{MachineConfig, for_device};
use crate::observer::Observer;
use crate::outcome::{Run, SessionError};
use crate::record::{Drawn, HashedDraws};
use crate::settings::{Settings, Source};
use crate::tee::{Seen, Tee};
use crate::watch::{Watch, Watched};
use basrelief_deferred_renderer::TileSource;
use basrelief_display_list::{Files, NoFiles, Resolver};
use basrelief_kernel::{self as kernel, NoProbe, Probe, StageTopology};
use basrelief_machines::{ConfigProblem, SceneFront, TraceFront};
use basrelief_report::model::Input;
use basrelief_signals::{Control, Draw, Scene};
use std::cell::RefCell;
use std::io::Read;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// The stages of the machine under these settings, in the order in which a probe numbers them.
///
/// # Errors
/// Parameters that do not fit together.
pub fn stages(source: &Source, settings: &Settings) -> Result<Vec<StageTopology>, ConfigProblem> {
    for_device!(&settings.config, device => stages_of(device, source))
}

fn stages_of<D: Device>(device: &D, source: &Source) -> Result<Vec<StageTopology>, ConfigProblem> {
    match source {
        Source::Scene(_) => {
            let front = SceneFront::new(std::iter::empty::<Draw>(), device.front());
            device.build(front).map(|mut m| kernel::topology(&mut m))
        }
        Source::Trace { .. } | Source::Remote { .. } => {
            let front = TraceFront::new(std::iter::empty::<Result<(Control, Option<u64>), String>>(), device.front());
            device.build(front).map(|mut m| kernel::topology(&mut m))
        }
    }
}

impl MachineConfig {
    /// Whether its parameters, each in its range, fit together.
    ///
    /// # Errors
    /// Where they do not: the parameter to change, and what to do.
    pub fn check(&self) -> Result<(), ConfigProblem> {
        for_device!(self, device => fits(device))
    }
}

fn fits<D: Device>(device: &D) -> Result<(), ConfigProblem> {
    device.build(SceneFront::new(std::iter::empty::<Draw>(), device.front())).map(|_| ())
}

/// Runs `source` on the machine: draws it, draws it exactly, measures, reports; `probe` watches every stage.
///
/// A deadlock, the limit of cycles and a stop by the observer are outcomes in the report.
///
/// # Errors
/// What keeps a run from giving a report: see [`SessionError`].
pub fn run(
    source: Source,
    settings: &Settings,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Watch>,
) -> Result<Run, SessionError> {
    match probe {
        Some(watch) => run_probed(source, settings, observer, &mut Watched(watch)),
        None => run_probed(source, settings, observer, &mut NoProbe),
    }
}

fn run_probed<P: Probe>(
    source: Source,
    settings: &Settings,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    for_device!(&settings.config, device => match source {
        Source::Scene(scene) => run_scene(&scene, device, settings, observer, probe),
        Source::Trace { reader, files, name } => run_trace((reader, files, name), None, device, settings, observer, probe),
        Source::Remote { reader, name, tiles } => {
            run_trace((reader, Box::new(NoFiles), name), Some(tiles), device, settings, observer, probe)
        }
    })
}

fn run_scene<D: Device, P: Probe>(
    scene: &Arc<Scene>,
    device: &D,
    settings: &Settings,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    let drawn = Rc::new(RefCell::new(Drawn::default()));
    let draws = HashedDraws::new(scene, device.front(), Rc::clone(&drawn), settings.clock);
    let machine = device.build(SceneFront::new(draws, device.front()))?;
    let per_frame: usize = 2 + scene.objects.iter().map(|o| o.mesh.indices.len() / 3 + 1).sum::<usize>();
    let exact = if settings.exact { Exact::Scene(Arc::clone(scene), device.exact_style()) } else { Exact::None };
    let total = Some((per_frame * scene.frames.len()) as u64);
    // The first command is drawn when the machine is built, ahead of the simulation.
    let ahead = drawn.borrow().seconds;
    let commands = Rc::clone(&drawn);
    let mut session = Session::new(settings, observer, exact, Box::new(move || (commands.borrow().commands, total)));
    let driven = session.drive(machine, probe)?;
    let passed = std::mem::take(&mut *drawn.borrow_mut());
    if let Some(error) = passed.error {
        return Err(error.into());
    }
    session.simulate_s -= passed.seconds - ahead;
    let sha256 = passed.digest.map(|d| d.to_string()).unwrap_or_default();
    let input = Input { kind: "scene".into(), name: file_name(&scene.name), sha256 };
    let frame = scene.frames.last().map(|f| &**f);
    Ok(session.finish(device, input, frame, driven, &scene.warnings, vec![]))
}

fn run_trace<D: Device, P: Probe>(
    (reader, mut files, name): (Box<dyn Read>, Box<dyn Files>, String),
    tiles: Option<Box<dyn TileSource>>,
    device: &D,
    settings: &Settings,
    observer: &mut dyn Observer,
    probe: &mut P,
) -> Result<Run, SessionError> {
    let resolver = Resolver::new(reader, move |name: &str| files.open(name))?;
    let seen = Rc::new(RefCell::new(Seen::default()));
    let tee = Tee::new(resolver, settings.exact.then(|| device.exact_style()), Rc::clone(&seen), settings.clock);
    let front = TraceFront::new(tee, device.front());
    let machine = match tiles {
        Some(tiles) => device.build_remote(front, tiles)?,
        None => device.build(front)?,
    };
    // The first command is read when the machine is built, ahead of the simulation.
    let ahead = seen.borrow().seconds;
    let exact = if settings.exact { Exact::Trace(Rc::clone(&seen)) } else { Exact::None };
    let commands = Rc::clone(&seen);
    let mut session = Session::new(settings, observer, exact, Box::new(move || (commands.borrow().commands, None)));
    let driven = session.drive(machine, probe);
    if let Some(error) = seen.borrow_mut().error.take() {
        return Err(error.into());
    }
    let driven = driven?;
    let passed = std::mem::take(&mut *seen.borrow_mut());
    session.simulate_s -= passed.seconds - ahead;
    let sha256 = passed.digest.map(|d| d.to_string()).unwrap_or_default();
    let input = Input { kind: "trace".into(), name: file_name(&name), sha256 };
    Ok(session.finish(device, input, passed.frame.as_deref(), driven, &[], passed.expectations))
}

/// A name without its folders: reports do not differ between them.
fn file_name(name: &str) -> String {
    Path::new(name).file_name().map_or_else(|| name.into(), |file| file.to_string_lossy().into_owned())
}
