//! A run from its source to its files, and what all commands that simulate share.

use super::output_files::OutputFiles;
use super::real_times::RealTimes;
use super::sensitivity::measured;
use super::tape::RunTape;
use super::timelines::TimelineFiles;
use crate::args::{EngineName, MachineArgs, SimulationArgs, TablesArgs, ViewArgs};
use crate::error::{Done, Failure, print};
use crate::outputs::{Outputs, REPORT, RUN_TAPE, check_distinct, check_not_read};
use crate::progress::Progress;
use basrelief_dse::Around;
use basrelief_input::Budget;
use basrelief_kernel::{Engine, Probe};
use basrelief_report::model::OutcomeKind;
use basrelief_report::{Report, Style, to_csv, to_text};
use basrelief_sim::{
    self as sim, AnalysisPolicy, AuxForm, AuxOutputInfo, MachineConfig, Observer, Overrides, Run, RunError, RunInput, RunOptions,
    Unobserved, picture_name,
};
use basrelief_tile_server::preview::LivePreview;
use std::cell::Cell;
use std::io::{IsTerminal, Write};
use std::net::SocketAddr;
use std::path::Path;
use std::rc::Rc;
use std::sync::OnceLock;
use std::time::Instant;

/// Seconds since the first call.
pub fn seconds() -> f64 {
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

/// As the command line says; nobody has asked for exhibits yet.
pub fn settings_of((config, given): (MachineConfig, Overrides), simulation: &SimulationArgs, budget: &Budget) -> RunOptions {
    let limits = limits_of(simulation.limits, simulation.no_limits);
    RunOptions {
        config,
        engine: (!simulation.functional).then(|| simulation.engine.into()),
        max_cycles: simulation.max_cycles.unwrap_or(u64::MAX),
        exact: !simulation.no_exact,
        aux_outputs: vec![],
        bottlenecks: limits,
        overrides: given,
        recording: match (&simulation.tape, limits) {
            (Some(_), _) => AnalysisPolicy::Always,
            (None, AnalysisPolicy::Never) => AnalysisPolicy::Never,
            (None, _) => AnalysisPolicy::IfShort,
        },
        costs: simulation.costs,
        requests: simulation.requests.is_some(),
        clock: seconds,
        budget: budget.clone(),
    }
}

/// Whether what limits a run is measured, by `--limits` and `--no-limits`.
pub fn limits_of(always: bool, never: bool) -> AnalysisPolicy {
    match (always, never) {
        (true, _) => AnalysisPolicy::Always,
        (_, true) => AnalysisPolicy::Never,
        _ => AnalysisPolicy::IfShort,
    }
}

/// What is simulated, and what tells how far it is.
pub struct Source {
    pub input: RunInput,
    pub progress: Progress,
    /// Bytes of a trace read so far.
    pub read: Option<Rc<Cell<u64>>>,
    /// When pictures of a server's scene are there.
    pub real: Option<RealTimes>,
    /// Where pictures are shown, if that is wished.
    pub watched: LivePreview,
}

/// Simulates a source.
pub fn simulate_source(
    began: f64,
    Source { input: source, progress, read, real, watched }: Source,
    mut settings: RunOptions,
    around: Option<Around>,
    simulation: &SimulationArgs,
    quiet: bool,
) -> Done {
    // Before the dumps: they may lie in it.
    let outputs = Outputs::begin(&simulation.out).map_err(Failure::file(&simulation.out, "be written"))?;
    check_distinct(&simulation.out, &named_outputs(simulation)).map_err(Failure::Usage)?;
    let mut timelines = TimelineFiles::open(simulation, &source, &settings)?;
    let mut files = OutputFiles::open(simulation, &settings, (outputs, progress, read))?;
    files.real = real;
    files.watched = simulation.watch.map(|at| listen(watched, at, quiet)).transpose()?;
    let watched = files.watched.clone();
    settings.aux_outputs = exhibits(&settings, &files);
    let ran = match &mut timelines {
        None => run_named(source, &settings, &mut files, None),
        Some(timelines) => timelines.watch(|probe| run_named(source, &settings, &mut files, Some(probe))),
    };
    let mut run = match ran {
        Ok(ran) => ran,
        Err(error) => return Err(files.rescue(error)),
    };
    if let Some(around) = around.filter(|_| run.report.outcome.kind == OutcomeKind::Complete) {
        run.report.sensitivity = Some(measured(around, &settings.budget, quiet || simulation.json)?);
    }
    let recording_is_complete = run.recording_is_complete;
    let mut report = run.with_host(seconds() - began);
    if let (Some(host), Some(real)) = (&mut report.host, &files.real) {
        host.path = Some(real.path());
    }
    let (beside, rest) = files.finish(&report, recording_is_complete, simulation)?;
    if simulation.json {
        // In front of what is published: where it cannot be printed, nothing is written.
        print(&report.to_json().map_err(Failure::bad)?)?;
    }
    // Where limits could not be measured, it cannot be timed again either.
    let run_tape = (recording_is_complete && report.limits.is_some()).then_some(rest.run_tape);
    let has_tape = publish(rest.outputs, (rest.frames, &rest.kinds), (&report, run_tape), simulation)?;
    rest.dumps.publish()?;
    timelines.map_or(Ok(()), TimelineFiles::publish)?;
    for (file, path) in beside {
        file.publish().map_err(Failure::file(&path, "be written"))?;
    }
    if let Some(watched) = watched {
        if rest.frames == 1 {
            watched.rename(&picture_name("image", 0, false));
        }
        watched.finish();
    }
    show(&report, (&rest.kinds, &rest.extra, has_tape), simulation, quiet)
}

/// Shows the run in a browser.
fn listen(watched: LivePreview, at: SocketAddr, quiet: bool) -> Done<LivePreview> {
    if !at.ip().is_loopback() {
        return Err(Failure::Usage(format!("--watch={at}: expected an address of this computer, such as 127.0.0.1:8018")));
    }
    let address = watched.listen(at).map_err(Failure::Bad)?;
    if !quiet {
        // Standard output is the report's.
        eprintln!("Watch it at http://{address}/");
    }
    Ok(watched)
}

/// What is shown beside the pictures: pictures, and what is dumped.
fn exhibits(settings: &RunOptions, files: &OutputFiles) -> Vec<AuxOutputInfo> {
    let pictures = basrelief_sim::aux_outputs(settings.config.machine()).into_iter().filter(|e| e.form != AuxForm::Lines);
    pictures.filter(|e| settings.exact || !e.judges).chain(files.dumps.exhibits()).collect()
}

/// Refuses an output that is one of these files, which the run reads; beside them, what its machine and its view are read from.
///
/// # Errors
/// Wrong usage.
pub fn spare_inputs(simulation: &SimulationArgs, input: Option<&Path>, machine: &MachineArgs, view: &ViewArgs) -> Done {
    let of_view = [("--camera", view.camera.as_deref()), ("--views", view.views.as_deref())];
    let options = [("INPUT", input), ("--config", machine.config.as_deref())].into_iter().chain(of_view);
    let read: Vec<(&str, &Path)> = options.filter_map(|(option, path)| Some((option, path?))).collect();
    check_not_read(&named_outputs(simulation), &read).map_err(Failure::Usage)
}

/// Options that name a file, and their files.
fn named_outputs(simulation: &SimulationArgs) -> Vec<(&'static str, &Path)> {
    let timeline = simulation.timeline.iter().map(|path| ("--timeline", &**path));
    let waves = simulation.waves.iter().map(|path| ("--waves", &**path));
    let tokens = simulation.tokens.iter().map(|path| ("--tokens", &**path));
    let requests = simulation.requests.iter().map(|path| ("--requests", &**path));
    let tape = simulation.tape.iter().map(|path| ("--tape", &**path));
    let page = simulation.html.iter().map(|path| ("--html", &**path));
    let dumps = simulation.dump.as_chunks::<2>().0.iter().map(|[_, path]| ("--dump", &**path));
    timeline.chain(waves).chain(tokens).chain(requests).chain(tape).chain(page).chain(dumps).collect()
}

/// A run whose errors name the input, unless it is the parameters or an output that are wrong.
pub fn run_named(
    source: RunInput,
    settings: &RunOptions,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Probe>,
) -> Done<Run> {
    let name = source.name().to_owned();
    sim::run(source, settings, observer, probe).map_err(|e| match e {
        RunError::Trace(_) | RunError::OverBudget(_) | RunError::Fault(_) => Failure::within(&name)(e),
        RunError::Observer(_)
        | RunError::Config(_)
        | RunError::NoShortcuts(_)
        | RunError::NoMethods(..)
        | RunError::NoTimes
        | RunError::Incomplete(_) => e.into(),
    })
}

/// Names the pictures by their number, adds the report and the tape, and puts everything in its place; whether there is a tape.
fn publish(
    outputs: Outputs,
    (frames, kinds): (usize, &[&str]),
    (report, tape): (&Report, Option<RunTape>),
    simulation: &SimulationArgs,
) -> Done<bool> {
    let failed = || Failure::file(&simulation.out, "be written");
    if frames == 1 {
        for kind in kinds {
            outputs.rename(&picture_name(kind, 0, true), &picture_name(kind, 0, false)).map_err(failed())?;
        }
    }
    let has_tape = tape.map_or(Ok(false), |tape| tape.write_to(&outputs)).map_err(failed())?;
    publish_report(outputs, report, simulation.csv).map_err(failed())?;
    Ok(has_tape)
}

/// Writes the report, and its tables where they are wanted, and puts everything in its place.
pub fn publish_report(outputs: Outputs, report: &Report, csv: bool) -> std::io::Result<()> {
    let mut file = outputs.create(REPORT)?;
    report.write_json(&mut file).and_then(|()| file.flush())?;
    if csv {
        let mut file = outputs.create("report.csv")?;
        file.write_all(to_csv(report).as_bytes()).and_then(|()| file.flush())?;
    }
    outputs.publish(REPORT, &[RUN_TAPE])
}

/// Prints the report.
pub fn show_report(report: &Report, tables: &TablesArgs) -> Done {
    print(&to_text(report, style(), &tables.shown()))
}

/// Prints the report, and decides whether the run was a success.
fn show(report: &Report, files: (&[&str], &[String], bool), simulation: &SimulationArgs, quiet: bool) -> Done {
    if !quiet && !simulation.json {
        show_report(report, &simulation.tables)?;
        print(&format!("\nWritten to {}/: {}\n", simulation.out.display(), written(report, files)))?;
    }
    let message = report.outcome.message.clone().unwrap_or_default();
    match report.outcome.kind {
        OutcomeKind::Complete => Ok(()),
        OutcomeKind::Limit => Err(Failure::Bad("stopped at the limit of --max-cycles; the report holds the state so far".into())),
        OutcomeKind::Deadlock | OutcomeKind::Stopped | OutcomeKind::Fault => Err(Failure::Bad(message)),
    }
}

/// Most pictures with names of their own that are told.
const MOST_NAMED: usize = 8;

/// Pictures by their kinds and by their names, the report, and the tape if there is one.
fn written(report: &Report, (kinds, extra, has_tape): (&[&str], &[String], bool)) -> String {
    let several = report.image.len() > 1;
    let names = kinds.iter().map(|kind| if several { format!("{kind}-0001.png ...") } else { picture_name(kind, 0, false) });
    let more = extra.iter().take(MOST_NAMED).cloned().chain((extra.len() > MOST_NAMED).then(|| "...".to_owned()));
    let own = std::iter::once(REPORT).chain(has_tape.then_some(RUN_TAPE));
    names.chain(more).chain(own.map(str::to_owned)).collect::<Vec<_>>().join(", ")
}

/// How tables are set on this terminal.
pub fn style() -> Style {
    let terminal = std::io::stdout().is_terminal();
    let width = std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok()).unwrap_or(120);
    Style { width, color: terminal && std::env::var_os("NO_COLOR").is_none() }
}

/// A run to its end, without pictures, exact picture or progress.
pub fn simulate_quietly(source: RunInput, config: &MachineConfig, engine: Option<Engine>, budget: &Budget) -> Done<Run> {
    let settings = RunOptions {
        config: config.clone(),
        engine: engine.or(Some(Engine::Timed)),
        exact: false,
        budget: budget.clone(),
        ..RunOptions::default()
    };
    let name = source.name().to_owned();
    let run = run_named(source, &settings, &mut Unobserved, None)?;
    match run.report.outcome.kind {
        OutcomeKind::Complete => Ok(run),
        _ => Err(Failure::within(&name)(run.report.outcome.message.as_deref().unwrap_or("incomplete"))),
    }
}
