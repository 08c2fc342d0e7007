//! A run from its input to its files, and code that all simulating commands share.

use super::output_files::OutputFiles;
use super::real_times::RealTimes;
use super::reporting::{show_report, written_line};
use super::sensitivity::run_analysis;
use super::timelines::TimelineFiles;
use super::wires::WireFile;
use crate::args::{EngineName, MachineArgs, SimulationArgs, ViewArgs};
use crate::clock::seconds;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::outputs::{OutputFolder, check_distinct, check_outputs_keep_inputs};
use crate::progress::InputProgress;
use crate::terminal;
use basrelief_dse::OneAtATimeBase;
use basrelief_kernel::Engine;
use basrelief_report::Report;
use basrelief_report::model::OutcomeKind;
use basrelief_sim::{
    AnalysisPolicy, AuxForm, AuxOutputInfo, MachineConfig, Overrides, RunInput, RunOptions, RunResult, picture_name, run_named,
};
use basrelief_tile_server::preview::LivePreview;
use std::net::SocketAddr;
use std::path::Path;

impl From<EngineName> for Engine {
    fn from(name: EngineName) -> Self {
        match name {
            EngineName::Timed => Self::Timed,
            EngineName::Ticked => Self::Ticked,
        }
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

/// The input of a run, and its progress.
pub struct RunSource {
    pub input: RunInput,
    pub progress: InputProgress,
    /// Image times of a scene from a server.
    pub real: Option<RealTimes>,
    /// The live preview.
    pub watched: LivePreview,
}

/// A simulation with the options of the command line.
pub struct Simulation<'a> {
    pub args: &'a SimulationArgs,
    pub options: RunOptions,
    pub global: &'a GlobalOptions,
}

impl<'a> Simulation<'a> {
    /// Resolves the options of a machine's run, without auxiliary outputs.
    pub fn new(args: &'a SimulationArgs, machine: (MachineConfig, Overrides), global: &'a GlobalOptions) -> Self {
        let (config, overrides) = machine;
        let limits = limits_of(args.bottlenecks, args.no_bottlenecks);
        let options = RunOptions {
            config,
            engine: (!args.functional).then(|| args.engine.into()),
            max_cycles: args.max_cycles.unwrap_or(u64::MAX),
            exact: !args.no_exact,
            aux_outputs: vec![],
            bottlenecks: limits,
            overrides,
            recording: match (&args.recording, limits) {
                (Some(_), _) => AnalysisPolicy::Always,
                (None, AnalysisPolicy::Never) => AnalysisPolicy::Never,
                (None, _) => AnalysisPolicy::IfShort,
            },
            costs: args.costs,
            requests: args.requests.is_some(),
            clock: seconds,
            budget: global.budget.clone(),
        };
        Self { args, options, global }
    }

    /// Returns true if neither progress nor tables are printed.
    pub fn is_quiet(&self) -> bool {
        self.global.quiet || self.args.json
    }

    /// Runs an input and writes its outputs. With `around`, the report has a sensitivity analysis.
    pub fn run(mut self, source: RunSource, around: Option<OneAtATimeBase>) -> CommandResult {
        let RunSource { input, progress, real, watched } = source;
        self.check_outputs_keep_named_files()?;
        self.check_recording()?;
        // Created before the dumps, which may be in this folder.
        let outputs = OutputFolder::begin(&self.args.out).map_err(CommandError::at_file(&self.args.out, "be written"))?;
        check_distinct(&self.args.out, &named_outputs(self.args)).map_err(CommandError::Usage)?;
        let mut timelines = TimelineFiles::open(self.args, &input, &self.options)?;
        let mut wires = self.args.rtl.clone().map(|path| WireFile::open(path, &input, &self.options)).transpose()?;
        let mut files = OutputFiles::open(self.args, &self.options, outputs, progress)?;
        files.real = real;
        files.watched = self.args.watch.map(|at| start_preview(watched, at, self.global.quiet)).transpose()?;
        let watched = files.watched.clone();
        self.options.aux_outputs = aux_outputs(&self.options, &files);
        let ran = match (&mut timelines, &mut wires) {
            (Some(timelines), _) => timelines.record_run(|probe| run_named(input, &self.options, &mut files, Some(probe))),
            (None, Some(wires)) => wires.record_run(|probe| run_named(input, &self.options, &mut files, Some(probe))),
            (None, None) => run_named(input, &self.options, &mut files, None),
        };
        let run = match ran {
            Ok(ran) => ran,
            Err(error) => return Err(files.keep_best_image(error)),
        };
        let recording_is_complete = run.recording_is_complete;
        let report = self.finish_report(run, around, &files)?;
        // A trace names its files while it is read.
        self.check_outputs_keep_named_files()?;
        let files = files.finish(&report, recording_is_complete, self.args)?;
        if self.args.json {
            // Printed before publication: if printing fails, nothing is written.
            print(&report.to_json().map_err(CommandError::bad_input)?)?;
        }
        let frames = files.frames;
        let names = files.publish(&report, self.args)?;
        timelines.map_or(Ok(()), TimelineFiles::publish)?;
        wires.map_or(Ok(()), WireFile::publish)?;
        if let Some(watched) = watched {
            if frames == 1 {
                watched.rename(&picture_name("image", 0, false));
            }
            watched.finish();
        }
        self.print_report(&report, &names, recording_is_complete)
    }

    /// Refuses to record a run whose work depends on its timing.
    fn check_recording(&self) -> CommandResult {
        if self.args.recording.is_none() || !self.options.config.acts_at_times() {
            return Ok(());
        }
        Err(CommandError::Usage(
            "--recording: the user of this run acts at times, so a recording serves no other timing; set defer.left_at_tile to the \
             figures `view_left_at_tile` of the report instead of times, or leave out --recording"
                .into(),
        ))
    }

    /// Refuses outputs that would overwrite a file that the input names.
    fn check_outputs_keep_named_files(&self) -> CommandResult {
        check_outputs_keep_inputs(Some(&self.args.out), &named_outputs(self.args), &[]).map_err(CommandError::Usage)
    }

    /// Returns the report of a run with the sensitivity analysis and the figures of the host.
    fn finish_report(&self, mut run: RunResult, around: Option<OneAtATimeBase>, files: &OutputFiles) -> CommandResult<Report> {
        if let Some(around) = around.filter(|_| run.report.outcome.is_complete()) {
            run.report.sensitivity = Some(run_analysis(around, self.global, self.is_quiet())?);
        }
        let mut report = run.with_host(seconds());
        if let (Some(host), Some(real)) = (&mut report.host, &files.real) {
            host.path = Some(real.path());
        }
        Ok(report)
    }

    /// Prints the report and decides the outcome of the command.
    fn print_report(&self, report: &Report, names: &str, has_recording: bool) -> CommandResult {
        if !self.is_quiet() {
            show_report(report, &self.args.tables, self.global.text_style())?;
            let is_written = |(option, path): &(&str, &Path)| path.exists() && (has_recording || *option != "--recording");
            let others: Vec<_> = named_outputs(self.args).into_iter().filter(is_written).collect();
            written_line(Some((&self.args.out, names)), &others).map_or(Ok(()), |line| print(&line))?;
        }
        let recording = self.args.recording.as_ref().filter(|_| !has_recording);
        let lost = recording.map_or(String::new(), |path| {
            format!("\n{} (--recording) is not written, because a recording holds a whole run", path.display())
        });
        let message = report.outcome.message.clone().unwrap_or_default() + &lost;
        match report.outcome.kind {
            OutcomeKind::Complete => Ok(()),
            OutcomeKind::Limit => Err(CommandError::BadInput(format!(
                "stopped at --max-cycles {}; the report holds the state so far; a larger --max-cycles, or none, lets the run finish{lost}",
                self.options.max_cycles
            ))),
            OutcomeKind::Deadlock | OutcomeKind::Stopped | OutcomeKind::Fault => Err(CommandError::BadInput(message)),
        }
    }
}

/// Starts the live preview.
fn start_preview(watched: LivePreview, at: SocketAddr, quiet: bool) -> CommandResult<LivePreview> {
    if !at.ip().is_loopback() {
        return Err(CommandError::Usage(format!("--watch={at}: expected a loopback address, for example 127.0.0.1:8018")));
    }
    let address = watched.listen(at).map_err(CommandError::BadInput)?;
    if !quiet {
        // Standard output is reserved for the report.
        terminal::print_note(&format!("Preview: http://{address}/"));
    }
    Ok(watched)
}

/// Returns the auxiliary outputs to compute: images and dumps.
fn aux_outputs(settings: &RunOptions, files: &OutputFiles) -> Vec<AuxOutputInfo> {
    let pictures = basrelief_sim::aux_outputs(settings.config.machine()).into_iter().filter(|e| e.form != AuxForm::Lines);
    pictures.filter(|e| settings.exact || !e.judges).chain(files.dumps.aux_outputs()).collect()
}

/// Refuses outputs that would overwrite an input of the run.
///
/// # Errors
/// Wrong usage.
pub fn spare_inputs(simulation: &SimulationArgs, input: Option<&Path>, machine: &MachineArgs, view: &ViewArgs) -> CommandResult {
    let read = read_files(input, machine, view);
    check_outputs_keep_inputs(Some(&simulation.out), &named_outputs(simulation), &read).map_err(CommandError::Usage)
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
    let wires = simulation.rtl.iter().map(|path| ("--rtl", &**path));
    let requests = simulation.requests.iter().map(|path| ("--requests", &**path));
    let recording = simulation.recording.iter().map(|path| ("--recording", &**path));
    let page = simulation.html.iter().map(|path| ("--html", &**path));
    let dumps = simulation.dump.as_chunks::<2>().0.iter().map(|[_, path]| ("--dump", &**path));
    timeline.chain(waves).chain(tokens).chain(wires).chain(requests).chain(recording).chain(page).chain(dumps).collect()
}
