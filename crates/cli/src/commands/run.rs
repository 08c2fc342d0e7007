//! `basrelief run` and `basrelief demo`.

use super::ablate::ablate;
use crate::args::{DemoArgs, EngineName, MachineArgs, RunArgs, SimulationArgs, ViewArgs};
use crate::error::{Done, Failure, print};
use crate::exhibits::{self, Dumps, round_name};
use crate::input::{self, Input, demo_of};
use crate::outputs::{Outputs, PartialFile};
use crate::progress::Progress;
use crate::remote::{Patience, RemoteTiles, TileCache, fetch_polygons, hash_of};
use basrelief_kernel::{Engine, Probe, StageTopology};
use basrelief_reference::{Picture, metrics};
use basrelief_report::model::OutcomeKind;
use basrelief_report::{Report, StageNames, Style, Timeline, to_csv, to_text};
use basrelief_session::{
    self as session, Exhibit, MACHINES, MachineConfig, MachineInfo, NoProbe, Observer, Pictures, Run, SessionError, Settings,
    Source, Unobserved, picture_name,
};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::cell::Cell;
use std::io::{BufWriter, Cursor, IsTerminal, Write};
use std::path::{Path, PathBuf};
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
    if let Some(url) = &args.from {
        return run_from(began, url, args, quiet);
    }
    let path = args.input.as_deref().unwrap_or(Path::new("-"));
    let input = input::open(path, &args.view)?;
    simulate(began, input, input::config(&args.machine, demo_of(path))?, &args.simulation, quiet)
}

/// Renders what a server offers.
fn run_from(began: f64, url: &str, args: &RunArgs, quiet: bool) -> Done {
    if args.machine.machine.is_some_and(|m| m.name != "defer") {
        return Err(Failure::Usage("--from: only machine `defer` renders from a server".into()));
    }
    if args.view != ViewArgs::default() {
        return Err(Failure::Usage(
            "--from: the server has the view; give --size, --camera, --frames and --orbit to serve".into(),
        ));
    }
    let machine = MachineArgs { machine: Some(MachineInfo::named("defer").map_err(Failure::Usage)?), ..args.machine.clone() };
    let config = input::config(&machine, None)?;
    let MachineConfig::Defer(device) = &config else { return Err(Failure::Usage("--from: needs machine defer".into())) };
    let patience = Patience::default();
    let polygons = fetch_polygons(url, patience).map_err(Failure::Bad)?;
    let open = |folder: &PathBuf| TileCache::open(folder, &hash_of(&polygons)).map_err(Failure::file(folder, "be written"));
    let cache = args.tile_cache.as_ref().map(open).transpose()?;
    let encoding = (device.tile.encoding, device.tile.jpeg_quality);
    let tiles = Box::new(RemoteTiles::new(url, encoding, device.path.requests, patience, cache));
    let source = Source::Remote { reader: Box::new(Cursor::new(polygons)), name: url.into(), tiles };
    let progress = Progress::new(None, "commands", quiet || args.simulation.json);
    let mut settings = settings_of(config, &args.simulation);
    settings.exact = false;
    simulate_source(began, (source, progress, None), &settings, &args.simulation, quiet)
}

/// Files, progress and pictures of a run.
struct Watcher {
    outputs: Outputs,
    progress: Progress,
    /// Bytes of a trace read so far; a scene counts commands instead.
    read: Option<Rc<Cell<u64>>>,
    frames: usize,
    dumps: Dumps,
    /// Pictures of the current frame that are not its last.
    rounds: u32,
    /// Names of the pictures beside those of frames.
    extra: Vec<String>,
}

impl Observer for Watcher {
    fn progress(&mut self, commands: u64, _: Option<u64>) -> bool {
        self.progress.at(self.read.as_ref().map_or(commands, |read| read.get()));
        true
    }

    fn frame(&mut self, pictures: &Pictures<'_>) -> Result<(), String> {
        self.frames = pictures.index + 1;
        self.save("image", pictures.index, pictures.machine)?;
        if self.rounds > 0 {
            let last = round_name(pictures.index as u32, std::mem::take(&mut self.rounds));
            self.write(&last, pictures.machine)?;
            self.extra.push(last);
        }
        let Some((exact, _)) = pictures.exact else { return Ok(()) };
        self.save("reference", pictures.index, exact)?;
        let difference = metrics::difference(exact, pictures.machine).map_err(|e| e.to_string())?;
        self.save("difference", pictures.index, &difference)
    }

    fn exhibit(&mut self, exhibit: &Exhibit) -> Result<(), String> {
        self.rounds += u32::from(matches!(exhibit, Exhibit::Round(_)));
        self.dumps.write(exhibit)?;
        let Some((name, picture)) = exhibits::picture(exhibit) else { return Ok(()) };
        self.write(&name, &picture)?;
        self.extra.push(name);
        Ok(())
    }
}

impl Watcher {
    /// A run has failed: the best picture of a frame that was under way stays, if there was any.
    fn rescue(self, error: Failure) -> Failure {
        let Some(best) = self.rounds.checked_sub(1).map(|round| round_name(self.frames as u32, round)) else { return error };
        match self.outputs.rename(&best, "image.png").and_then(|()| self.outputs.publish("image.png")) {
            Ok(()) => error,
            Err(e) => Failure::Bad(format!("{error}\nThe best picture so far cannot be written: {e}")),
        }
    }

    fn save(&mut self, kind: &str, index: usize, picture: &Picture) -> Result<(), String> {
        self.write(&picture_name(kind, index, true), picture)
    }

    fn write(&mut self, name: &str, picture: &Picture) -> Result<(), String> {
        let failed = |e: &dyn std::fmt::Display| format!("{name}: cannot be written: {e}");
        let mut file = self.outputs.create(name).map_err(|e| failed(&e))?;
        PngEncoder::new(&mut file)
            .write_image(&picture.to_rgba(), picture.width, picture.height, ExtendedColorType::Rgba8)
            .map_err(|e| failed(&e))?;
        file.flush().map_err(|e| failed(&e))
    }
}

fn settings_of(config: MachineConfig, simulation: &SimulationArgs) -> Settings {
    // Its further pictures are made of the log.
    let log = config.machine().name == "defer";
    Settings {
        config,
        engine: (!simulation.functional).then(|| simulation.engine.into()),
        max_cycles: simulation.max_cycles.unwrap_or(u64::MAX),
        exact: !simulation.no_exact,
        log,
        clock: seconds,
    }
}

fn simulate(began: f64, input: Input, config: MachineConfig, simulation: &SimulationArgs, quiet: bool) -> Done {
    let settings = settings_of(config, simulation);
    if simulation.ablate {
        return ablate(&input, &settings, simulation, quiet);
    }
    simulate_source(began, source_of(input, quiet || simulation.json), &settings, simulation, quiet)
}

fn simulate_source(
    began: f64,
    (source, progress, read): (Source, Progress, Option<Rc<Cell<u64>>>),
    settings: &Settings,
    simulation: &SimulationArgs,
    quiet: bool,
) -> Done {
    let dumps = Dumps::begin(&simulation.dump, settings.config.machine())?;
    let outputs = Outputs::begin(&simulation.out).map_err(Failure::file(&simulation.out, "be written"))?;
    let mut watcher = Watcher { outputs, progress, read, frames: 0, dumps, rounds: 0, extra: Vec::new() };
    let ran = match &simulation.timeline {
        None => run_named(source, settings, &mut watcher, &mut NoProbe).map(|run| (run, None)),
        Some(path) => with_timeline(path, source, settings, &mut watcher),
    };
    let (run, timeline) = match ran {
        Ok(ran) => ran,
        Err(error) => return Err(watcher.rescue(error)),
    };
    let report = run.with_host(seconds() - began);
    let Watcher { outputs, progress, frames, dumps, extra, .. } = watcher;
    drop(progress);
    publish(outputs, frames, &report, simulation)?;
    dumps.publish()?;
    if let (Some(file), Some(path)) = (timeline, &simulation.timeline) {
        file.publish().map_err(Failure::file(path, "be written"))?;
    }
    show(&report, &extra, simulation, quiet)
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
fn show(report: &Report, extra: &[String], simulation: &SimulationArgs, quiet: bool) -> Done {
    if simulation.json {
        print(&report.to_json().map_err(Failure::bad)?)?;
    } else if !quiet {
        print(&to_text(report, style()))?;
        print(&format!("\nWritten to {}/: {}\n", simulation.out.display(), written(report, extra)))?;
    }
    let message = report.outcome.message.clone().unwrap_or_default();
    match report.outcome.kind {
        OutcomeKind::Complete => Ok(()),
        OutcomeKind::Limit => Err(Failure::Bad("stopped at the limit of --max-cycles; the report holds the state so far".into())),
        OutcomeKind::Deadlock | OutcomeKind::Stopped | OutcomeKind::Fault => Err(Failure::Bad(message)),
    }
}

/// Most pictures beside those of frames that are told by name.
const MOST_NAMED: usize = 8;

/// Which kinds of picture there are: with `--no-exact` only the machine's.
fn kinds(report: &Report) -> &'static [&'static str] {
    if report.quality.is_some() { &["image", "reference", "difference"] } else { &["image"] }
}

fn written(report: &Report, extra: &[String]) -> String {
    let several = report.image.len() > 1;
    let pictures = kinds(report).iter().filter(|_| !report.image.is_empty());
    let names = pictures.map(|kind| if several { format!("{kind}-0001.png ...") } else { picture_name(kind, 0, false) });
    // Of many, those of the first frame say enough.
    let shown = extra.iter().take(MOST_NAMED).cloned().chain((extra.len() > MOST_NAMED).then(|| "...".to_owned()));
    names.chain(shown).chain(["report.json".to_owned()]).collect::<Vec<_>>().join(", ")
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
