//! Steps and waits of units as a list.

use crate::layout::{TimelineLayout, wait_cause, wait_name};
use crate::probe::{AttributedProbe, StepAttribution};
use basrelief_kernel::{Cycle, Interval, Probe, StallCause};

/// A step or a wait of a unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimelineStep {
    /// Number of the stage in the diagram.
    pub stage: usize,
    /// First cycle.
    pub from: u64,
    /// End \[cycle, exclusive\].
    pub to: u64,
    /// `busy`, `memory`, `starved` or `blocked`.
    pub kind: &'static str,
    /// State and arguments, for example `busy: frame 1, polygon 12`.
    pub text: String,
}

/// Lists the steps and waits within the window of a layout. Steps are listed one by one; adjacent equal waits are joined.
#[derive(Debug)]
pub struct StepList {
    layout: TimelineLayout,
    steps: Vec<TimelineStep>,
}

impl StepList {
    /// Makes an empty list.
    pub fn new(layout: TimelineLayout) -> Self {
        Self { layout, steps: vec![] }
    }

    /// Returns the list. The steps of a stage are in order of time.
    pub fn finish(self) -> Vec<TimelineStep> {
        self.steps
    }
}

impl AttributedProbe for StepList {
    fn add(&mut self, Interval { stage, cause, from, to }: Interval, whose: &StepAttribution) {
        let (from, to) = (from.0.max(self.layout.from), to.0.min(self.layout.to));
        if from >= to {
            return;
        }
        let unit = &self.layout.diagram.stages[stage];
        let (kind, mut text) =
            cause.map_or_else(|| ("busy", "busy".into()), |cause| (wait_cause(unit, cause).0, wait_name(unit, cause)));
        let mut separator = if cause.is_some() { ", " } else { ": " };
        let mut add = |argument: String| {
            text.push_str(std::mem::replace(&mut separator, ", "));
            text.push_str(&argument);
        };
        for (name, value) in whose.numbers() {
            value.into_iter().for_each(|value| add(format!("{name} {value}")));
        }
        if let Some((life, [x, y])) = whose.life.and_then(|life| Some((life, life.pixel?))) {
            add(format!("{} {} at {x},{y}", life.pixels, if life.pixels == 1 { "pixel" } else { "pixels" }));
        }
        if whose.asks != 0 {
            add(format!("uses {}", whose.clients(&unit.clients)));
        }
        match self.steps.iter_mut().rev().find(|step| step.stage == stage) {
            Some(last) if cause.is_some() && last.to == from && last.text == text => last.to = to,
            _ => self.steps.push(TimelineStep { stage, from, to, kind, text }),
        }
    }
}

impl Probe for StepList {
    fn reads_levels(&self) -> bool {
        false
    }

    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: None, from, to }, &StepAttribution::default());
    }

    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: Some(cause), from, to }, &StepAttribution::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TokenLife, samples};

    #[test]
    fn steps_have_their_arguments() {
        let layout = TimelineLayout { from: 2, to: 20, ..samples::board() };
        let stage = layout.diagram.stages.iter().position(|stage| !stage.clients.is_empty()).unwrap();
        let client = layout.diagram.stages[stage].clients[0].clone();
        let life = Some(TokenLife { number: 3, pixel: Some([4, 5]), pixels: 2 });
        let whose = StepAttribution { frame: Some(0), polygon: Some(7), asks: 1, life, ..StepAttribution::default() };
        let object = StepAttribution { object: Some(1), ..StepAttribution::default() };
        let mut list = StepList::new(layout);
        let mut add = |cause, from, to, whose| list.add(Interval { stage, cause, from: Cycle(from), to: Cycle(to) }, &whose);
        add(None, 0, 5, whose);
        add(Some(StallCause::Memory(0)), 5, 7, object);
        add(Some(StallCause::Memory(0)), 7, 9, object);
        let none = StepAttribution::default();
        add(None, 9, 10, none);
        add(None, 10, 11, none);
        add(None, 20, 21, none);
        let steps = list.finish();
        let told: Vec<_> = steps.iter().map(|step| (step.from, step.to, step.kind, step.text.as_str())).collect();
        let busy = format!("busy: frame 1, polygon 7, 2 pixels at 4,5, uses {client}");
        let memory = format!("memory: {client}, object 1");
        let expected =
            [(2, 5, "busy", busy.as_str()), (5, 9, "memory", &memory), (9, 10, "busy", "busy"), (10, 11, "busy", "busy")];
        assert_eq!(told, expected);
    }
}
