//! Warnings about what the analysis of a run leaves out.

use super::ActiveRun;
use crate::analysis::resimulations::MOST_STEPS;
use crate::machine::SimulatedMachine;
use crate::options::AnalysisPolicy;
use basrelief_kernel::RunReport;
use basrelief_report::number::thousands;

impl ActiveRun<'_> {
    /// Returns warnings about analyses that are left out. `analysed`: the run, if its bottlenecks were measured.
    pub(super) fn analysis_warnings(&self, spec: &impl SimulatedMachine, analysed: Option<&RunReport>) -> Vec<String> {
        self.no_bottlenecks(spec).map(str::to_owned).into_iter().chain(analysed.and_then(no_path)).collect()
    }

    /// Warns if there are no bottlenecks although the user asked for them or the run is short.
    fn no_bottlenecks(&self, spec: &impl SimulatedMachine) -> Option<&'static str> {
        if self.lacks_memory {
            return Some(
                "bottlenecks are not analysed, because the recorded steps exceed --memory-limit; raise it, or use --no-bottlenecks",
            );
        }
        if self.has_long_step {
            return Some(
                "bottlenecks are not analysed and the run has no recording, because a step takes more than 4294967295 cycles",
            );
        }
        (self.options.bottlenecks == AnalysisPolicy::Always && spec.acts_at_times()).then_some(
            "bottlenecks are not analysed, because ends of views by time change the steps of the machine; state numbers of tiles \
             instead (defer.left_at_tile)",
        )
    }
}

/// Warns if a run has too many steps for its critical path, on which the bottleneck ladder builds.
fn no_path(run: &RunReport) -> Option<String> {
    let steps: u64 = run.units.iter().map(|unit| unit.steps).sum();
    (steps > MOST_STEPS as u64).then(|| {
        format!(
            "the critical path and the bottleneck ladder are left out, because the run has {} steps, more than {}; a group of resources \
             that saves cycles only together is not found (draw fewer frames or a smaller image)",
            thousands(steps),
            thousands(MOST_STEPS as u64)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_kernel::{Outcome, UnitReport};

    #[test]
    fn run_without_a_path_says_so() {
        let steps = |steps| {
            let (account, inputs, outputs, clients) = Default::default();
            let unit = UnitReport { name: "u".into(), steps, account, inputs, outputs, clients };
            let (marks, fifos, memories, caches) = Default::default();
            let (outcome, units) = (Outcome::Complete, vec![unit.clone(), unit]);
            RunReport { outcome, total: steps, marks, units, fifos, memories, caches }
        };
        assert_eq!(no_path(&steps(MOST_STEPS as u64 / 2)), None);
        assert!(no_path(&steps(MOST_STEPS as u64 / 2 + 1)).is_some_and(|text| text.contains("2,800,002 steps")));
    }
}
