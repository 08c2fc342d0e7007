//! Time lines that say whom each step was for.

use crate::costs::CostPoints;
use crate::flow::{Flow, Follower, Origin};
use crate::machines::MachineConfig;
use basrelief_input::{Budget, OverBudget};
use basrelief_kernel::{Cause, Cycle, Interval, Label, MemoryEvent, Probe, StageTopology};
use basrelief_timeline::{StepAttribution, TimelineProbe, TokenLife};
use std::collections::VecDeque;
use std::num::NonZeroU64;

/// Tokens whose life is told one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// One of so many: the first, and so on.
    pub every: NonZeroU64,
    /// Of polygons, until they are drawn; otherwise of what they are drawn as: stamps, spans or pixels, as the machine has them.
    pub polygons: bool,
}

/// A probe that shows a run to a [`TimelineProbe`], with whom each step was for.
///
/// Whom it was for is told by the work, when it was by time; these need not keep step. What a unit waited for is for whom the step was that
/// ended the wait.
pub struct Following<'a, 'b> {
    flow: Flow,
    /// Of each stage, whom its steps are for whose time is not told yet, with the clients that they asked; and how it has waited since its
    /// last step.
    whose: Vec<VecDeque<(Origin, u32)>>,
    waits: Vec<Vec<Interval>>,
    over: Option<OverBudget>,
    watcher: &'a mut TimelineProbe<'b>,
}

impl std::fmt::Debug for Following<'_, '_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Following").field("watcher", &self.watcher).finish_non_exhaustive()
    }
}

impl<'a, 'b> Following<'a, 'b> {
    /// Shows a run of a machine of these stages, as it is configured.
    pub fn new(
        config: &MachineConfig,
        stages: &[StageTopology],
        sample: Option<Sample>,
        budget: &Budget,
        watcher: &'a mut TimelineProbe<'b>,
    ) -> Self {
        let count = stages.len();
        Self {
            flow: Flow::new(stages, config.cost_points(), sample, budget),
            whose: vec![VecDeque::new(); count],
            waits: vec![Vec::new(); count],
            over: None,
            watcher,
        }
    }

    /// Shows what was waited for after the last steps.
    ///
    /// # Errors
    /// What it took to know whom steps were for was more than may be held.
    pub fn finish(mut self) -> Result<(), OverBudget> {
        for stage in 0..self.waits.len() {
            self.show_waits(stage, &StepAttribution::default());
        }
        self.over.map_or(Ok(()), Err)
    }

    fn show_waits(&mut self, stage: usize, whose: &StepAttribution) {
        for wait in self.waits[stage].drain(..) {
            self.watcher.add(wait, whose);
        }
    }
}

/// Number of the stage in which the lives of these end that are not cut short: where polygons are drawn, or where visible pixels end.
pub fn last_stage(sample: Sample, config: &MachineConfig, stages: &[StageTopology]) -> Option<usize> {
    let CostPoints { drawn, shown } = config.cost_points();
    if sample.polygons {
        return stages.iter().position(|stage| stage.outputs.iter().any(|output| output == drawn));
    }
    shown.iter().find_map(|fifo| stages.iter().position(|stage| stage.inputs.iter().any(|input| input == fifo)))
}

/// As time lines show it.
fn whose(origin: &Origin) -> StepAttribution {
    let pixel = origin.pixels.map(|pixels| pixels.first());
    let pixels = origin.pixels.map_or(0, |pixels| pixels.count());
    StepAttribution {
        frame: origin.frame,
        object: origin.object,
        polygon: origin.polygon.map(|polygon| polygon.frame),
        level: origin.level(),
        asks: 0,
        life: origin.life.map(|number| TokenLife { number, pixel, pixels }),
    }
}

/// Nothing is kept of tokens but whom they are for.
struct Unfollowed;

impl Follower for Unfollowed {
    fn frame(&mut self, _: [u32; 2]) -> Result<(), OverBudget> {
        Ok(())
    }
    fn entered(&mut self, _: &Origin) -> Result<(), OverBudget> {
        Ok(())
    }
    fn drawn(&mut self, _: &Origin) {}
    fn shown(&mut self, _: &Origin) {}
    fn taken(&mut self, _: &Origin) {}
}

impl Probe for Following<'_, '_> {
    fn reads_labels(&self) -> bool {
        self.over.is_none()
    }

    fn stepped(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        match self.flow.step((stage, taken), given, &mut Unfollowed) {
            Ok(whose) => self.whose[stage].push_back((whose, asked)),
            Err(over) => self.over = Some(over),
        }
    }

    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        let (origin, asks) = self.whose[stage].pop_front().unwrap_or_default();
        let whose = whose(&origin);
        self.show_waits(stage, &whose);
        self.watcher.add(Interval { stage, cause: None, from, to }, &StepAttribution { asks, ..whose });
    }

    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        self.waits[stage].push(Interval { stage, cause: Some(cause), from, to });
    }

    fn held(&mut self, fifo: usize, at: Cycle, slots: usize) {
        self.watcher.held(fifo, at, slots);
    }

    fn memory(&mut self, event: MemoryEvent) {
        self.watcher.memory(event);
    }
}
