//! `basrelief run` and `basrelief demo`.

use super::ablate::ablate;
use crate::args::{DemoArgs, EngineName, RunArgs, SimulationArgs};
use crate::error::{Done, Failure, print};
use crate::input::{self, Input, demo_of};
use crate::outputs::{Outputs, PartialFile};
use crate::progress::Progress;
use basrelief_kernel::{Engine, Probe, StageTopology};
use basrelief_reference::{Picture, metrics};
use basrelief_report::model::OutcomeKind;
use basrelief_report::{Report, StageNames, Style, Timeline, to_csv, to_text};
use basrelief_session::{
    self as session, MACHINES, MachineConfig, NoProbe, Observer, Pictures, Run, SessionError, Settings, Source, Unobserved,
    picture_name,
};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::cell::Cell;
use std::io::{BufWriter, IsTerminal, Write};
use std::path::Path;
use std::rc::Rc;
use std::sync::OnceLock;
use std::time::Instant;

/// Seconds since the first call.
fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

impl From<EngineName> for Engine {
    fn from(name: EngineName) -> Self {
        match name {
            EngineName::Timed => Self::Timed,
            EngineName::Ticked => Self::Ticked,
        }
    }
}

/// Draws an embedded scene.
pub fn demo(args: &DemoArgs, quiet: bool) -> Done {
    let began = seconds();
    let machine = args.machine.machine.unwrap_or(&MACHINES[0]);
    let name = args.name.as_deref().unwrap_or(machine.demos[0]);
    let scene = input::demo_scene(name, &args.view)?;
    simulate(began, Input::Scene(scene), input::config(&args.machine, Some(name))?, &args.simulation, quiet)
}

/// Draws a model or replays a display list.
pub fn run(args: &RunArgs, quiet: bool) -> Done {
    let began = seconds();
    let input = input::open(&args.input, &args.view)?;
    simulate(began, input, input::config(&args.machine, demo_of(&args.input))?, &args.simulation, quiet)
}

/// Files, progress and pictures of a run.
struct Watcher {
    outputs: Outputs,
    progress: Progress,
    /// Bytes of a trace read so far; a scene counts commands instead.
    read: Option<Rc<Cell<u64>>>,
    frames: usize,
}

impl Observer for Watcher {
    fn progress(&mut self, commands: u64, _: Option<u64>) -> bool {
        self.progress.at(self.read.as_ref().map_or(commands, |read| read.get()));
        true
    }

    fn frame(&mut self, pictures: &Pictures<'_>) -> Result<(), String> {
        self.frames = pictures.index + 1;
        self.save("image", pictures.index, pictures.machine)?;
        let Some((exact, _)) = pictures.exact else { return Ok(()) };
        self.save("reference", pictures.index, exact)?;
        let difference = metrics::difference(exact, pictures.machine).map_err(|e| e.to_string())?;
        self.save("difference", pictures.index, &difference)
    }
}

impl Watcher {
    fn save(&mut self, kind: &str, index: usize, picture: &Picture) -> Result<(), String> {
        let name = picture_name(kind, index, true);
        let failed = |e: &dyn std::fmt::Display| format!("{name}: cannot be written: {e}");
        let mut file = self.outputs.create(&name).map_err(|e| failed(&e))?;
        PngEncoder::new(&mut file)
            .write_image(&picture.to_rgba(), picture.width, picture.height, ExtendedColorType::Rgba8)
            .map_err(|e| failed(&e))?;
        file.flush().map_err(|e| failed(&e))
    }
}

fn simulate(began: f64, input: Input, config: MachineConfig, simulation: &SimulationArgs, quiet: bool) -> Done {
    let settings = Settings {
        config,
        engine: (!simulation.functional).then(|| simulation.engine.into()),
        max_cycles: simulation.max_cycles.unwrap_or(u64::MAX),
        exact: !simulation.no_exact,
        log: false,
        clock: seconds,
    };
    if simulation.ablate {
        return ablate(&input, &settings, simulation, quiet);
    }
    let outputs = Outputs::begin(&simulation.out).map_err(Failure::file(&simulation.out, "be written"))?;
    let (source, progress, read) = source_of(input, quiet || simulation.json);
    let mut watcher = Watcher { outputs, progress, read, frames: 0 };
    let (run, timeline) = match &simulation.timeline {
        None => (run_named(source, &settings, &mut watcher, &mut NoProbe)?, None),
        Some(path) => with_timeline(path, source, &settings, &mut watcher)?,
    };
    let report = run.with_host(seconds() - began);
    let Watcher { outputs, progress, frames, .. } = watcher;
    drop(progress);
    publish(outputs, frames, &report, simulation)?;
    if let (Some(file), Some(path)) = (timeline, &simulation.timeline) {
        file.publish().map_err(Failure::file(path, "be written"))?;
    }
    show(&report, simulation, quiet)
}

fn source_of(input: Input, quiet: bool) -> (Source, Progress, Option<Rc<Cell<u64>>>) {
    match input {
        Input::Scene(scene) => {
            let per_frame: usize = 2 + scene.objects.iter().map(|o| o.mesh.indices.len() / 3 + 1).sum::<usize>();
            let total = (per_frame * scene.frames.len()) as u64;
            (Source::Scene(scene), Progress::new(Some(total), "draw commands", quiet), None)
        }
        Input::Trace(trace) => {
            let (progress, read) = (Progress::new(trace.bytes, "bytes", quiet), Rc::clone(&trace.read));
            (trace.into_source(), progress, Some(read))
        }
    }
}

/// A run whose errors name the input, unless it is the parameters that are wrong.
pub fn run_named<P: Probe>(source: Source, settings: &Settings, observer: &mut dyn Observer, probe: &mut P) -> Done<Run> {
    let name = source.name().to_owned();
    session::run(source, settings, observer, probe).map_err(|e| match e {
        SessionError::Trace(_) | SessionError::Fault(_) | SessionError::Observer(_) => Failure::within(&name)(e),
        SessionError::Config(_) | SessionError::NoShortCuts(_) | SessionError::Incomplete(_) => e.into(),
    })
}

fn with_timeline(path: &Path, source: Source, settings: &Settings, watcher: &mut Watcher) -> Done<(Run, Option<PartialFile>)> {
    let failed = || Failure::file(path, "be written");
    let stages: Vec<StageNames> = session::stages(&source, settings).map_err(Failure::bad)?.into_iter().map(names).collect();
    let mut file = PartialFile::create(path).map_err(failed())?;
    let mut timeline = Timeline::new(BufWriter::new(&mut file), settings.config.machine().name, &stages);
    let run = run_named(source, settings, watcher, &mut timeline)?;
    match &run.timing {
        Some(timing) => timeline.finish(timing).and_then(|mut out| out.flush()).map_err(failed())?,
        None => drop(timeline),
    }
    Ok((run, Some(file)))
}

fn names(stage: StageTopology) -> StageNames {
    StageNames { unit: stage.name, inputs: stage.inputs, outputs: stage.outputs, clients: stage.clients }
}

/// Names the pictures by their number, adds the report, and puts everything in its place.
fn publish(outputs: Outputs, frames: usize, report: &Report, simulation: &SimulationArgs) -> Done {
    let failed = || Failure::file(&simulation.out, "be written");
    if frames == 1 {
        for kind in kinds(report) {
            outputs.rename(&picture_name(kind, 0, true), &picture_name(kind, 0, false)).map_err(failed())?;
        }
    }
    let mut file = outputs.create("report.json").map_err(failed())?;
    report.write_json(&mut file).and_then(|()| file.flush()).map_err(failed())?;
    if simulation.csv {
        let mut file = outputs.create("report.csv").map_err(failed())?;
        file.write_all(to_csv(report).as_bytes()).and_then(|()| file.flush()).map_err(failed())?;
    }
    outputs.publish("report.json").map_err(failed())
}

/// Prints the report, and decides whether the run was a success.
fn show(report: &Report, simulation: &SimulationArgs, quiet: bool) -> Done {
    if simulation.json {
        print(&report.to_json().map_err(Failure::bad)?)?;
    } else if !quiet {
        print(&to_text(report, style()))?;
        print(&format!("\nWritten to {}/: {}\n", simulation.out.display(), written(report)))?;
    }
    let message = report.outcome.message.clone().unwrap_or_default();
    match report.outcome.kind {
        OutcomeKind::Complete => Ok(()),
        OutcomeKind::Limit => Err(Failure::Bad("stopped at the limit of --max-cycles; the report holds the state so far".into())),
        OutcomeKind::Deadlock | OutcomeKind::Stopped | OutcomeKind::Fault => Err(Failure::Bad(message)),
    }
}

/// Which kinds of picture there are: with `--no-exact` only the machine's.
fn kinds(report: &Report) -> &'static [&'static str] {
    if report.quality.is_some() { &["image", "reference", "difference"] } else { &["image"] }
}

fn written(report: &Report) -> String {
    let several = report.image.len() > 1;
    let pictures = kinds(report).iter().filter(|_| !report.image.is_empty());
    let names = pictures.map(|kind| if several { format!("{kind}-0001.png ...") } else { picture_name(kind, 0, false) });
    names.chain(["report.json".to_owned()]).collect::<Vec<_>>().join(", ")
}

/// How tables are set on this terminal.
pub fn style() -> Style {
    let terminal = std::io::stdout().is_terminal();
    let width = std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok()).unwrap_or(120);
    Style { width, color: terminal && std::env::var_os("NO_COLOR").is_none() }
}

/// A run to its end, without pictures, exact picture or progress.
pub fn simulate_quietly(source: Source, config: &MachineConfig, engine: Option<Engine>) -> Done<Run> {
    let settings =
        Settings { config: config.clone(), engine: engine.or(Some(Engine::Timed)), exact: false, ..Settings::default() };
    let name = source.name().to_owned();
    let run = run_named(source, &settings, &mut Unobserved, &mut NoProbe)?;
    match run.report.outcome.kind {
        OutcomeKind::Complete => Ok(run),
        _ => Err(Failure::within(&name)(run.report.outcome.message.as_deref().unwrap_or("incomplete"))),
    }
}
