//! `basrelief size-fifos`: finds the smallest FIFO depths that keep the cycles of runs.

use super::recording::{failure, open as open_recording, place_of};
use crate::args::{MachineArgs, SizeFifosArgs, ViewArgs};
use crate::clock::seconds;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::input::{self, Input};
use crate::scene_input::demo_of;
use crate::terminal;
use basrelief_input::MemoryPool;
use basrelief_report::number::thousands;
use basrelief_sim::{
    AnalysisPolicy, DepthChoice, FifoSizing, KeptRecording, MachineConfig, NoObserver, Overrides, RecordingError, RunOptions,
    is_model, run_named, size_fifos as sized,
};
use basrelief_trace::TraceForm;
use std::fmt::Write;
use std::io::{Cursor, Read};
use std::path::Path;

/// Finds the depths, checks them with full runs where possible, and prints them.
pub fn size_fifos(args: &SizeFifosArgs, global: &GlobalOptions) -> CommandResult {
    let MachineArgs { machine, config, settings } = &args.machine;
    let is_told_how = machine.is_some() || config.is_some() || !settings.is_empty() || args.view != ViewArgs::default();
    if is_told_how && !args.inputs.iter().any(|input| is_drawn(input)) {
        return Err(CommandError::Usage(
            "a recording has its own machine and view; options for these apply to models and traces only".into(),
        ));
    }
    let mut inputs =
        args.inputs.iter().map(|input| RecordedInput::open(input, args, global)).collect::<CommandResult<Vec<_>>>()?;
    let names: Vec<String> = inputs.iter().map(|input| input.name.clone()).collect();
    let readers = inputs.iter_mut().map(|input| &mut *input.recording as &mut dyn Read).collect();
    let name = |number: usize| names.get(number).map_or("", |name| name);
    let sizes = sized(readers, &args.within, &global.budget).map_err(|error| match error {
        RecordingError::Different { number, .. } => CommandError::in_input(name(number))(error),
        RecordingError::OneOf { number, error } => failure(name(number))(*error),
        error => failure(&names.join(", "))(error),
    })?;
    for (number, input) in inputs.iter().enumerate() {
        input.check(number, &sizes)?;
    }
    sizes.warnings.iter().for_each(|warning| terminal::print_note(warning));
    if args.json {
        return print(&format!("{}\n", serde_json::to_string_pretty(&sizes).map_err(CommandError::bad_input)?));
    }
    print(&text(&sizes))
}

/// Returns true if the name of an input is that of a model or a trace.
fn is_drawn(path: &Path) -> bool {
    is_model(path) || demo_of(path).is_some() || TraceForm::for_file_name(&path.to_string_lossy()).is_some()
}

/// An input and the recording of its run.
struct RecordedInput {
    name: String,
    recording: Box<dyn Read>,
    /// Input and options; `None` for a recording.
    drawn: Option<(Input, RunOptions)>,
}

impl RecordedInput {
    fn open(path: &Path, args: &SizeFifosArgs, global: &GlobalOptions) -> CommandResult<Self> {
        if !is_drawn(path) {
            let path = place_of(path);
            return Ok(Self { name: path.display().to_string(), recording: Box::new(open_recording(&path)?), drawn: None });
        }
        let budget = &global.budget;
        let (config, given) = input::config(&args.machine, demo_of(path), budget)?;
        let input = input::open(path, &args.view, global)?.for_several_runs(budget);
        let options = options(config, given, budget);
        let mut kept = KeptRecording::new(budget);
        let run =
            run_named(input.reopen()?, &RunOptions { recording: AnalysisPolicy::Always, ..options.clone() }, &mut kept, None)?;
        let name = path.display().to_string();
        if !run.recording_is_complete {
            return Err(CommandError::in_input(&name)(
                "the run does not end, its user acts at times, or a step takes more than 4294967295 cycles; so it has no recording",
            ));
        }
        Ok(Self { name, recording: Box::new(Cursor::new(kept)), drawn: Some((input, options)) })
    }

    /// Runs the input with the depths found; the run must take the computed cycles.
    fn check(&self, number: usize, sizes: &FifoSizing) -> CommandResult {
        let Some((input, options)) = &self.drawn else { return Ok(()) };
        for choice in &sizes.choices {
            let mut given = options.overrides.clone();
            given.settings.extend(choice.depths.iter().map(|(name, depth)| (format!("fifo.{name}.depth"), depth.to_string())));
            let config = given.config(options.config.machine(), &[]).map_err(CommandError::bad_input)?;
            let run =
                run_named(input.reopen()?, &RunOptions { config, overrides: given, ..options.clone() }, &mut NoObserver, None)?;
            let cycles = run.report.frame_cycles();
            if cycles != choice.cycles[number] {
                let promised = choice.cycles[number];
                let text = format!("a full run takes {cycles} cycles, the resimulation {promised}; please report this as a bug");
                return Err(CommandError::in_input(&self.name)(text));
            }
        }
        Ok(())
    }
}

/// Returns run options for timing only.
fn options(config: MachineConfig, given: Overrides, budget: &MemoryPool) -> RunOptions {
    RunOptions { config, overrides: given, exact: false, clock: seconds, budget: budget.clone(), ..RunOptions::default() }
}

fn text(sizes: &FifoSizing) -> String {
    let mut text = format!("{}: smallest FIFOs found that keep the render cycles\n\n", sizes.machine);
    let Some((recorded, found)) = sizes.choices.split_first() else { return text };
    for choice in &sizes.choices {
        let within = choice.within_percent.map_or("as recorded".into(), |percent| format!("within {percent} %"));
        let fewer = slots_saved(choice, recorded);
        let cycles: Vec<String> = choice.cycles.iter().map(|cycles| thousands(*cycles)).collect();
        let (slots, bits, area) = (thousands(choice.slots), thousands(choice.bits), thousands(choice.area_ge));
        let cycles = cycles.join(", ");
        let _ = writeln!(text, "{within:<14} {slots:>8} slots {bits:>12} bits {area:>10} GE  {cycles} cycles{fewer}");
    }
    for choice in found {
        let changed = choice.depths.iter().zip(&recorded.depths).filter(|(new, old)| new.1 != old.1);
        let sets: Vec<String> = changed.map(|((name, depth), _)| format!("--set fifo.{name}.depth={depth}")).collect();
        let _ = write!(text, "\nwithin {} %: {}\n", choice.within_percent.unwrap_or_default(), sets.join(" "));
        text += &shown_least(choice);
    }
    text
}

/// States what was shown of a choice: no FIFO has a spare slot, and some need more slots together than alone.
fn shown_least(choice: &DepthChoice) -> String {
    if choice.depths.iter().all(|(_, depth)| *depth == 1) {
        return "Each FIFO has one slot, the least.\n".into();
    }
    let both = choice.depths.iter().zip(&choice.least_alone).filter(|(together, alone)| together.1 > alone.1);
    let listed: Vec<String> = both.map(|((name, together), (_, alone))| format!("{name} {together} ({alone})")).collect();
    let more = if listed.is_empty() { String::new() } else { format!(" More slots together than alone: {}.", listed.join(", ")) };
    format!("One slot less in any FIFO exceeds the tolerance.{more}\n")
}

fn slots_saved(choice: &DepthChoice, recorded: &DepthChoice) -> String {
    if choice.within_percent.is_none() {
        return String::new();
    }
    format!("  ({:.0} % fewer slots)", 100.0 - 100.0 * choice.slots as f64 / recorded.slots.max(1) as f64)
}
