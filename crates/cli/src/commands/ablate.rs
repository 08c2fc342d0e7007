//! `--ablate`: what each short cut of a machine saves, and what it costs.

use super::run::{run_named, style};
use crate::args::SimulationArgs;
use crate::error::{Done, Failure, print};
use crate::input::Input;
use crate::outputs::Outputs;
use crate::progress::Progress;
use basrelief_report::Ablation;
use basrelief_session::{self as session, NoProbe, Observer, Settings, Source};
use std::io::Write;
use std::sync::Arc;

/// Runs the input once per variant, and writes the table.
pub fn ablate(input: &Input, settings: &Settings, simulation: &SimulationArgs, quiet: bool) -> Done {
    let source = || match input {
        Input::Scene(scene) => Ok(Source::Scene(Arc::clone(scene))),
        Input::Trace(trace) => trace.again().map(|trace| trace.into_source()),
    };
    let outputs = Outputs::begin(&simulation.out).map_err(Failure::file(&simulation.out, "be written"))?;
    let mut watcher = Watcher(Progress::new(None, "commands", quiet || simulation.json));
    let run = |settings: &Settings, observer: &mut dyn Observer| run_named(source()?, settings, observer, &mut NoProbe);
    let ablation = session::ablate(settings, &mut watcher, run)?;
    drop(watcher);
    publish(outputs, &ablation, simulation)?;
    if simulation.json {
        print(&ablation.to_json().map_err(Failure::bad)?)
    } else if quiet {
        Ok(())
    } else {
        let folder = simulation.out.display();
        print(&format!("{}\nWritten to {folder}/: ablation.csv, ablation.json\n", ablation.to_text(style())))
    }
}

struct Watcher(Progress);

impl Observer for Watcher {
    fn progress(&mut self, commands: u64, _: Option<u64>) -> bool {
        self.0.at(commands);
        true
    }
}

fn publish(outputs: Outputs, ablation: &Ablation, simulation: &SimulationArgs) -> Done {
    let failed = || Failure::file(&simulation.out, "be written");
    let json = ablation.to_json().map_err(Failure::bad)?;
    for (name, text) in [("ablation.csv", ablation.to_csv()), ("ablation.json", json)] {
        let mut file = outputs.create(name).map_err(failed())?;
        file.write_all(text.as_bytes()).and_then(|()| file.flush()).map_err(failed())?;
    }
    outputs.publish("ablation.json").map_err(failed())
}
