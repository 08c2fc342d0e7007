//! Timelines with the origin of each step.

use super::flow::{FlowEvents, StepTokens, TokenFlow};
use super::origin::{TokenOrigin, TokenSample};
use basrelief_input::{MemoryPool, OverBudget};
use basrelief_kernel::{Cycle, Interval, Label, MemoryEvent, Probe, StageTopology, StallCause};
use basrelief_machines::{CostPoints, MachineConfig};
use basrelief_timeline::{AttributedProbe, StepAttribution, TokenLife};
use std::collections::VecDeque;

/// Probe that passes a run to another probe, with the origin of each step.
///
/// The origin comes from execution, the timestamps from timing; the two streams may be offset. A wait belongs to the step that ended it.
pub struct AttributionProbe<'a, P> {
    flow: TokenFlow,
    /// Origins of each stage's steps that are executed but not yet timed, with the memory clients that they used.
    untimed: Vec<VecDeque<(TokenOrigin, u32)>>,
    /// Waits of each stage since its last step.
    waits: Vec<Vec<Interval>>,
    over_budget: Option<OverBudget>,
    timeline: &'a mut P,
}

impl<P: std::fmt::Debug> std::fmt::Debug for AttributionProbe<'_, P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AttributionProbe").field("timeline", &self.timeline).finish_non_exhaustive()
    }
}

impl<'a, P: AttributedProbe> AttributionProbe<'a, P> {
    /// Creates a probe for a machine with these stages.
    pub fn new(
        config: &MachineConfig,
        stages: &[StageTopology],
        sample: Option<TokenSample>,
        budget: &MemoryPool,
        timeline: &'a mut P,
    ) -> Self {
        let count = stages.len();
        Self {
            flow: TokenFlow::new(stages, config.cost_points(), sample, budget),
            untimed: vec![VecDeque::new(); count],
            waits: vec![Vec::new(); count],
            over_budget: None,
            timeline,
        }
    }

    /// Passes on the waits after the last steps.
    ///
    /// # Errors
    /// The attribution exceeded the memory limit.
    pub fn finish(mut self) -> Result<(), OverBudget> {
        for stage in 0..self.waits.len() {
            self.show_waits(stage, &StepAttribution::default());
        }
        self.over_budget.map_or(Ok(()), Err)
    }

    fn show_waits(&mut self, stage: usize, owner: &StepAttribution) {
        for wait in self.waits[stage].drain(..) {
            self.timeline.add(wait, owner);
        }
    }
}

/// Returns the number of the stage in which a complete trace ends: the stage that creates fragments, or the one that finishes visible
/// pixels.
pub fn last_stage(sample: TokenSample, config: &MachineConfig, stages: &[StageTopology]) -> Option<usize> {
    let CostPoints { drawn, shown } = config.cost_points();
    if sample.polygons {
        return stages.iter().position(|stage| stage.outputs.iter().any(|output| output == drawn));
    }
    shown.iter().find_map(|fifo| stages.iter().position(|stage| stage.inputs.iter().any(|input| input == fifo)))
}

/// Converts an origin for the timelines.
fn attribution(origin: &TokenOrigin) -> StepAttribution {
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

/// Ignores all events.
struct NoEvents;

impl FlowEvents for NoEvents {
    fn on_frame(&mut self, _: [u32; 2]) -> Result<(), OverBudget> {
        Ok(())
    }
    fn on_polygon(&mut self, _: &TokenOrigin) -> Result<(), OverBudget> {
        Ok(())
    }
    fn on_fragments(&mut self, _: &TokenOrigin) {}
    fn on_visible_pixels(&mut self, _: &TokenOrigin) {}
    fn on_token_taken(&mut self, _: &TokenOrigin) {}
}

impl<P: AttributedProbe> Probe for AttributionProbe<'_, P> {
    fn reads_labels(&self) -> bool {
        self.over_budget.is_none()
    }

    fn reads_visible(&self) -> bool {
        self.timeline.reads_visible()
    }

    fn on_step(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        match self.flow.step(&StepTokens { stage, taken, given }, &mut NoEvents) {
            Ok(origin) => self.untimed[stage].push_back((origin, asked)),
            Err(error) => self.over_budget = Some(error),
        }
    }

    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        let (origin, asks) = self.untimed[stage].pop_front().unwrap_or_default();
        let owner = attribution(&origin);
        self.show_waits(stage, &owner);
        self.timeline.add(Interval { stage, cause: None, from, to }, &StepAttribution { asks, ..owner });
    }

    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle) {
        self.waits[stage].push(Interval { stage, cause: Some(cause), from, to });
    }

    fn on_occupancy(&mut self, fifo: usize, at: Cycle, slots: usize) {
        self.timeline.on_occupancy(fifo, at, slots);
    }

    fn on_visible_count(&mut self, fifo: usize, at: Cycle, tokens: usize) {
        self.timeline.on_visible_count(fifo, at, tokens);
    }

    fn on_memory_event(&mut self, event: MemoryEvent) {
        self.timeline.on_memory_event(event);
    }
}
