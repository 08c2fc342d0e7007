//! A run from its input to its files, and code that all simulating commands share.

use super::output_files::OutputFiles;
use super::real_times::RealTimes;
use super::recording::ShortRecording;
use super::sensitivity::measured;
use super::timelines::TimelineFiles;
use crate::args::{EngineName, MachineArgs, SimulationArgs, TablesArgs, ViewArgs};
use crate::error::{Done, Failure, print};
use crate::outputs::{OLD_RUN_RECORDING, Outputs, REPORT, RUN_RECORDING, check_distinct, check_outputs_keep_inputs};
use crate::progress::Progress;
use crate::terminal;
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

/// Returns the seconds since the first call.
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

/// Returns the run options of the command line, without auxiliary outputs.
pub fn settings_of((config, given): (MachineConfig, Overrides), simulation: &SimulationArgs, budget: &Budget) -> RunOptions {
    let limits = limits_of(simulation.bottlenecks, simulation.no_bottlenecks);
    RunOptions {
        config,
        engine: (!simulation.functional).then(|| simulation.engine.into()),
        max_cycles: simulation.max_cycles.unwrap_or(u64::MAX),
        exact: !simulation.no_exact,
        aux_outputs: vec![],
        bottlenecks: limits,
        overrides: given,
        recording: match (&simulation.recording, limits) {
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

/// Returns the policy of the bottleneck analysis.
pub fn limits_of(always: bool, never: bool) -> AnalysisPolicy {
    match (always, never) {
        (true, _) => AnalysisPolicy::Always,
        (_, true) => AnalysisPolicy::Never,
        _ => AnalysisPolicy::IfShort,
    }
}

/// The input of a run and its progress.
pub struct Source {
    pub input: RunInput,
    pub progress: Progress,
    /// Bytes of the trace read so far.
    pub read: Option<Rc<Cell<u64>>>,
    /// Image times of a scene from a server.
    pub real: Option<RealTimes>,
    /// The live preview.
    pub watched: LivePreview,
}

/// Simulates an input and writes its outputs.
pub fn simulate_source(
    began: f64,
    Source { input: source, progress, read, real, watched }: Source,
    mut settings: RunOptions,
    around: Option<Around>,
    simulation: &SimulationArgs,
    quiet: bool,
) -> Done {
    // Created before the dumps, which may be in this folder.
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
        // Printed before publication: if printing fails, nothing is written.
        print(&report.to_json().map_err(Failure::bad)?)?;
    }
    // Without a bottleneck analysis the recording cannot be resimulated either.
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

/// Starts the live preview.
fn listen(watched: LivePreview, at: SocketAddr, quiet: bool) -> Done<LivePreview> {
    if !at.ip().is_loopback() {
        return Err(Failure::Usage(format!("--watch={at}: expected a loopback address, for example 127.0.0.1:8018")));
    }
    let address = watched.listen(at).map_err(Failure::Bad)?;
    if !quiet {
        // Standard output is reserved for the report.
        terminal::note(&format!("Preview: http://{address}/"));
    }
    Ok(watched)
}

/// Returns the auxiliary outputs to compute: images and dumps.
fn exhibits(settings: &RunOptions, files: &OutputFiles) -> Vec<AuxOutputInfo> {
    let pictures = basrelief_sim::aux_outputs(settings.config.machine()).into_iter().filter(|e| e.form != AuxForm::Lines);
    pictures.filter(|e| settings.exact || !e.judges).chain(files.dumps.exhibits()).collect()
}

/// Refuses outputs that would overwrite an input of the run.
///
/// # Errors
/// Wrong usage.
pub fn spare_inputs(simulation: &SimulationArgs, input: Option<&Path>, machine: &MachineArgs, view: &ViewArgs) -> Done {
    let read = read_files(input, machine, view);
    check_outputs_keep_inputs(Some(&simulation.out), &named_outputs(simulation), &read).map_err(Failure::Usage)
}

/// Returns the files that a command reads, with their options.
pub fn read_files<'a>(input: Option<&'a Path>, machine: &'a MachineArgs, view: &'a ViewArgs) -> Vec<(&'static str, &'a Path)> {
    let of_view = [("--camera", view.camera.as_deref()), ("--views", view.views.as_deref())];
    let options = [("INPUT", input), ("--config", machine.config.as_deref())].into_iter().chain(of_view);
    options.filter_map(|(option, path)| Some((option, path?))).collect()
}

/// Returns the options that name an output, with their files.
fn named_outputs(simulation: &SimulationArgs) -> Vec<(&'static str, &Path)> {
    let timeline = simulation.timeline.iter().map(|path| ("--timeline", &**path));
    let waves = simulation.waves.iter().map(|path| ("--waves", &**path));
    let tokens = simulation.tokens.iter().map(|path| ("--tokens", &**path));
    let requests = simulation.requests.iter().map(|path| ("--requests", &**path));
    let recording = simulation.recording.iter().map(|path| ("--recording", &**path));
    let page = simulation.html.iter().map(|path| ("--html", &**path));
    let dumps = simulation.dump.as_chunks::<2>().0.iter().map(|[_, path]| ("--dump", &**path));
    timeline.chain(waves).chain(tokens).chain(requests).chain(recording).chain(page).chain(dumps).collect()
}

/// Runs the machine. Errors name the input, unless a parameter or an output is at fault.
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

/// Renames the images of a single frame, adds report and recording, and publishes everything. Returns true if there is a recording.
fn publish(
    outputs: Outputs,
    (frames, kinds): (usize, &[&str]),
    (report, tape): (&Report, Option<ShortRecording>),
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

/// Writes the report and its tables, and publishes everything.
pub fn publish_report(outputs: Outputs, report: &Report, csv: bool) -> std::io::Result<()> {
    let mut file = outputs.create(REPORT)?;
    report.write_json(&mut file).and_then(|()| file.flush())?;
    if csv {
        let mut file = outputs.create("report.csv")?;
        file.write_all(to_csv(report).as_bytes()).and_then(|()| file.flush())?;
    }
    outputs.publish(REPORT, &[RUN_RECORDING, OLD_RUN_RECORDING])
}

/// Prints the report.
pub fn show_report(report: &Report, tables: &TablesArgs) -> Done {
    print(&to_text(report, style(), &tables.shown()))
}

/// Prints the report and decides the outcome of the command.
fn show(report: &Report, files: (&[&str], &[String], bool), simulation: &SimulationArgs, quiet: bool) -> Done {
    if !quiet && !simulation.json {
        show_report(report, &simulation.tables)?;
        print(&format!("\nWritten to {}/: {}\n", simulation.out.display(), written(report, files)))?;
    }
    let message = report.outcome.message.clone().unwrap_or_default();
    match report.outcome.kind {
        OutcomeKind::Complete => Ok(()),
        OutcomeKind::Limit => Err(Failure::Bad("stopped at --max-cycles; the report holds the state so far".into())),
        OutcomeKind::Deadlock | OutcomeKind::Stopped | OutcomeKind::Fault => Err(Failure::Bad(message)),
    }
}

/// Maximum number of further images in the message.
const MOST_NAMED: usize = 8;

/// Returns the names of the written files.
fn written(report: &Report, (kinds, extra, has_tape): (&[&str], &[String], bool)) -> String {
    let several = report.image.len() > 1;
    let names = kinds.iter().map(|kind| if several { format!("{kind}-0001.png ...") } else { picture_name(kind, 0, false) });
    let more = extra.iter().take(MOST_NAMED).cloned().chain((extra.len() > MOST_NAMED).then(|| "...".to_owned()));
    let own = std::iter::once(REPORT).chain(has_tape.then_some(RUN_RECORDING));
    names.chain(more).chain(own.map(str::to_owned)).collect::<Vec<_>>().join(", ")
}

/// Returns the width and colours of this terminal.
pub fn style() -> Style {
    let terminal = std::io::stdout().is_terminal();
    let width = std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok()).unwrap_or(120);
    Style { width, color: terminal && std::env::var_os("NO_COLOR").is_none() }
}

/// Runs to the end without images, reference image and progress.
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
