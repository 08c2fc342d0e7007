//! Tables of several runs of one input: `--ablate` (saving of each shortcut) and `--compare-methods` (cost of each method at the same
//! error).

use super::simulate::Simulation;
use crate::args::SimulationArgs;
use crate::error::{CommandError, CommandResult, print, print_styled};
use crate::input::Input;
use crate::outputs::OutputFolder;
use crate::progress::Progress;
use basrelief_sim::{self as sim, Observer, RunOptions, RunResult, run_named};
use std::io::Write;

/// A finished table.
struct FinishedTable {
    /// Name of its files.
    name: &'static str,
    text: String,
    csv: String,
    json: String,
}

/// Runs with the given options and observer.
type RunOnce<'a> = &'a mut dyn FnMut(&RunOptions, &mut dyn Observer) -> CommandResult<RunResult>;

/// Runs the input once per ablation and writes the table.
pub fn ablate(input: &Input, simulation: &Simulation<'_>) -> CommandResult {
    write_table(input, simulation, |observer, run| {
        let table = sim::ablate(&simulation.options, observer, run)?;
        let json = table.to_json().map_err(CommandError::bad_input)?;
        Ok(FinishedTable { name: "ablation", text: table.to_text(simulation.global.text_style()), csv: table.to_csv(), json })
    })
}

/// Runs the input with each method and writes the table.
pub fn compare_methods(input: &Input, simulation: &Simulation<'_>) -> CommandResult {
    write_table(input, simulation, |observer, run| {
        let table = sim::compare_methods(&simulation.options, observer, run)?;
        let json = table.to_json().map_err(CommandError::bad_input)?;
        Ok(FinishedTable { name: "methods", text: table.to_text(simulation.global.text_style()), csv: table.to_csv(), json })
    })
}

fn write_table(
    input: &Input,
    simulation: &Simulation<'_>,
    make: impl FnOnce(&mut dyn Observer, RunOnce<'_>) -> CommandResult<FinishedTable>,
) -> CommandResult {
    let args = simulation.args;
    let outputs = OutputFolder::begin(&args.out).map_err(CommandError::at_file(&args.out, "be written"))?;
    let mut observer = ProgressObserver(Progress::new(None, "commands", simulation.is_quiet()));
    let mut run = |settings: &RunOptions, observer: &mut dyn Observer| run_named(input.reopen()?, settings, observer, None);
    let table = make(&mut observer, &mut run)?;
    drop(observer);
    if args.json {
        // Printed before publication: if printing fails, nothing is written.
        print(&table.json)?;
    }
    publish(outputs, &table, args)?;
    if simulation.is_quiet() {
        Ok(())
    } else {
        let (folder, name) = (args.out.display(), table.name);
        let style = simulation.global.text_style();
        print_styled(&format!("{}\nWritten to {folder}/: {name}.csv, {name}.json\n", table.text), style)
    }
}

struct ProgressObserver(Progress);

impl Observer for ProgressObserver {
    fn progress(&mut self, commands: u64, _: Option<u64>) -> bool {
        self.0.set_position(commands);
        true
    }
}

fn publish(outputs: OutputFolder, table: &FinishedTable, args: &SimulationArgs) -> CommandResult {
    let failed = || CommandError::at_file(&args.out, "be written");
    let [csv, json] = ["csv", "json"].map(|ending| format!("{}.{ending}", table.name));
    for (name, text) in [(&csv, &table.csv), (&json, &table.json)] {
        let mut file = outputs.create(name).map_err(failed())?;
        file.write_all(text.as_bytes()).and_then(|()| file.flush()).map_err(failed())?;
    }
    outputs.publish(&json, |_| vec![]).map_err(failed())
}
