//! Trial run of a plan: which figures its reports have.

use super::{Plan, PlanPoint};
use crate::figures::{ReportFigure, figures, no_figure};
use crate::{OpenedInput, SweepHost};
use basrelief_report::derived::undefined_figures;
use basrelief_signals::{Frame, Scene};
use basrelief_sim::{MachineConfig, NoObserver, RunInput, RunOptions, doc_trace, run};
use std::sync::Arc;

/// Maximum number of cycles of the trial run. Its few pixels take fewer, even over the slowest path. Waiting cycles take no host time.
const REHEARSAL: u64 = 1 << 40;
/// Size of its picture \[pixels\].
const SMALL: (u32, u32) = (16, 12);

/// Returns the options of a run in this configuration.
pub(crate) fn run_options(config: MachineConfig, max_cycles: u64, host: &dyn SweepHost) -> RunOptions {
    RunOptions { config, max_cycles, budget: host.budget().clone(), ..RunOptions::default() }
}

/// Figures of the trial run.
pub(super) struct TrialFigures {
    /// Name of the input of the run.
    input: String,
    /// Figures of the report.
    known: Vec<ReportFigure>,
    /// Figures that the report leaves out because their divisor is 0 or unknown, each with its formula.
    undefined: Vec<(String, String)>,
}

impl TrialFigures {
    pub fn has(&self, name: &str) -> bool {
        self.known.iter().any(|figure| figure.name == name)
    }

    /// Returns the message for a figure that the report does not have.
    pub fn missing(&self, name: &str) -> String {
        let of_ratio = |(ratio, _): &&(String, String)| name.strip_prefix("derived.") == Some(ratio);
        match self.undefined.iter().find(of_ratio) {
            Some((_, formula)) => format!(
                "a trial run of {} has no figure `{name}`: the divisor of its formula, {formula}, is 0 or unknown; name another figure, or \
                 put an input with this figure first",
                self.input
            ),
            None => no_figure(name, &self.known),
        }
    }
}

/// Returns the figures of the plan's reports, from a run of its first valid point with a small picture. Returns `None` if no such run
/// gives a report.
pub(super) fn run_small(plan: &Plan, host: &dyn SweepHost) -> Option<TrialFigures> {
    let fits = |point: &&PlanPoint| plan.config(&point.places).is_ok_and(|config| config.check().is_ok());
    let config = plan.points.iter().find(fits).and_then(|point| plan.config(&point.places).ok());
    config.into_iter().chain([plan.machine.default_config()]).find_map(|config| {
        let input = plan.inputs.first()?;
        let source = match &input.opened {
            OpenedInput::Scene(prepared) => RunInput::scene(Arc::new(small_scene(prepared.scene())?)),
            OpenedInput::Trace => RunInput::trace(std::io::Cursor::new(doc_trace()), "quad.dl.jsonl"),
        };
        let run = run(source, &run_options(config, REHEARSAL, host), &mut NoObserver, None).ok()?;
        let known = figures(&serde_json::to_value(&run.report).ok()?);
        Some(TrialFigures { input: input.name.clone(), known, undefined: undefined_figures(&run.report) })
    })
}

/// The first frame of a scene as a small picture.
fn small_scene(scene: &Scene) -> Option<Scene> {
    let frame = Frame { width: SMALL.0, height: SMALL.1, ..(**scene.frames.first()?).clone() };
    Some(Scene { frames: vec![Arc::new(frame)], ..scene.clone() })
}
