//! The probe that adds up costs.

use super::drawing::Drawing;
use super::flow::Flow;
use super::ledger::{Ledger, kind_of, slot_of};
use super::origin::Origin;
use super::polygons::Polygons;
use super::{CostPoints, Costs};
use basrelief_input::{Budget, Held, OverBudget};
use basrelief_kernel::{Cause, Cycle, Label, MemoryEvent, Probe, RunReport, StageTopology};
use std::collections::VecDeque;

/// Adds up costs, and hands on what it is told to another probe where there is one.
///
/// Whom a step is for is told by the work, how long it took by time: these need not keep step, but for each stage either comes in the
/// order of its steps.
pub(crate) struct CostProbe<'a> {
    stages: Vec<StageTopology>,
    /// No step starts in this cycle or later, nor counts what it takes beyond.
    end: u64,
    flow: Flow,
    drawing: Drawing,
    polygons: Polygons,
    ledgers: Vec<Ledger>,
    /// Of each stage, whom its steps are for whose time is not told yet; and what it has waited for since its last step.
    whose: Vec<VecDeque<Origin>>,
    waits: Vec<Vec<(usize, u64)>>,
    held: Held,
    over: Option<OverBudget>,
    also: Option<&'a mut dyn Probe>,
}

impl<'a> CostProbe<'a> {
    pub(crate) fn new(
        stages: Vec<StageTopology>,
        points: CostPoints,
        (end, budget): (u64, &Budget),
        also: Option<&'a mut dyn Probe>,
    ) -> Self {
        let count = stages.len();
        Self {
            flow: Flow::new(&stages, points),
            stages,
            end,
            drawing: Drawing::default(),
            polygons: Polygons::default(),
            ledgers: vec![Ledger::default(); count],
            whose: vec![VecDeque::new(); count],
            waits: vec![Vec::new(); count],
            held: budget.nothing(),
            over: None,
            also,
        }
    }

    /// Charges a step and what it waited for.
    fn charge(&mut self, stage: usize, busy: u64) -> Result<(), OverBudget> {
        let origin = self.whose[stage].pop_front().unwrap_or_default();
        let Self { ledgers, drawing, polygons, held, waits, .. } = self;
        let spent = polygons.spent(&origin);
        for (slot, cycles) in waits[stage].drain(..).chain([(0, busy)]) {
            spent.charge(kind_of(slot), cycles);
            ledgers[stage].charge((slot, cycles), &origin, drawing, held)?;
        }
        Ok(())
    }

    /// Whether it could hold what it had to; where not, nothing was left for others either.
    ///
    /// # Errors
    /// It was more than may be held.
    pub(crate) fn check(&self) -> Result<(), OverBudget> {
        self.over.clone().map_or(Ok(()), Err)
    }

    /// What the run has cost, by its report.
    pub(crate) fn finish(self, report: &RunReport) -> Costs {
        let Polygons { list, objects, frames, .. } = self.polygons;
        let units = self.ledgers.into_iter().zip(&self.stages).zip(&report.units);
        Costs {
            cycles: report.total,
            frames: self.flow.frames(),
            units: units.map(|((ledger, stage), unit)| ledger.finish(stage, unit)).collect(),
            polygons: list,
            drawing: self.drawing,
            objects,
            whole_frames: frames,
            _held: self.held,
        }
    }
}

impl Probe for CostProbe<'_> {
    fn reads_labels(&self) -> bool {
        self.over.is_none() || self.also.as_ref().is_some_and(|probe| probe.reads_labels())
    }

    fn stepped(&mut self, stage: usize, taken: u32, given: &[(usize, Label)]) {
        if let Some(also) = self.also.as_mut().filter(|probe| probe.reads_labels()) {
            also.stepped(stage, taken, given);
        }
        if self.over.is_some() {
            return;
        }
        let drawn = (&mut self.drawing, &mut self.polygons);
        match self.flow.step((stage, taken), given, drawn, &mut self.held) {
            Ok(whose) => self.whose[stage].push_back(whose),
            Err(over) => self.over = Some(over),
        }
    }

    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        if let Some(also) = &mut self.also {
            also.worked(stage, from, to);
        }
        if self.over.is_none() {
            let busy = Cycle(to.0.min(self.end)).since(from);
            self.over = self.charge(stage, busy).err();
        }
    }

    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        if let Some(also) = &mut self.also {
            also.waited(stage, cause, from, to);
        }
        self.waits[stage].push((slot_of(cause), to.since(from)));
    }

    fn held(&mut self, fifo: usize, at: Cycle, slots: usize) {
        if let Some(also) = &mut self.also {
            also.held(fifo, at, slots);
        }
    }

    fn memory(&mut self, event: MemoryEvent) {
        if let Some(also) = &mut self.also {
            also.memory(event);
        }
    }
}
