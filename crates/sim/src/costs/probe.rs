//! The probe that adds up costs.

use super::drawing::Drawing;
use super::ledger::{Ledger, kind_of, slot_of};
use super::polygons::Polygons;
use super::{CostPoints, Costs, StepGroups};
use crate::flow::{Flow, Follower, Origin};
use basrelief_input::{Budget, Held, OverBudget};
use basrelief_kernel::{Cause, Cycle, Label, MemoryEvent, Probe, RunReport, StageTopology};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// Adds up costs, and hands on what it is told to another probe where there is one.
///
/// Whom a step is for is told by the work, how long it took by time: these need not keep step, but for each stage either comes in the
/// order of its steps.
pub(crate) struct CostProbe<'a> {
    stages: Vec<StageTopology>,
    /// No step starts in this cycle or later, nor counts what it takes beyond.
    end: u64,
    flow: Flow,
    tally: Tally,
    ledgers: Vec<Ledger>,
    /// Of each stage, whom its steps are for whose time is not told yet; and what it has waited for since its last step.
    whose: Vec<VecDeque<Origin>>,
    waits: Vec<Vec<(usize, u64)>>,
    /// For whom all steps were, where that is asked for.
    groups: Option<Rc<RefCell<StepGroups>>>,
    over: Option<OverBudget>,
    also: Option<&'a mut dyn Probe>,
}

/// Whom there is something to be charged to.
struct Tally {
    drawing: Drawing,
    polygons: Polygons,
    held: Held,
}

impl Follower for Tally {
    fn frame(&mut self, size: [u32; 2]) -> Result<(), OverBudget> {
        self.drawing.begin(size, &mut self.held)
    }

    fn entered(&mut self, origin: &Origin) -> Result<(), OverBudget> {
        self.polygons.enter(origin, &mut self.held)
    }

    fn drawn(&mut self, origin: &Origin) {
        self.drawing.draw(origin);
        self.polygons.draw(origin);
    }

    fn shown(&mut self, origin: &Origin) {
        self.drawing.show(origin);
    }

    fn taken(&mut self, origin: &Origin) {
        self.drawing.note(origin);
    }
}

impl<'a> CostProbe<'a> {
    pub(crate) fn new(
        stages: Vec<StageTopology>,
        points: CostPoints,
        (end, budget): (u64, &Budget),
        groups: Option<Rc<RefCell<StepGroups>>>,
        also: Option<&'a mut dyn Probe>,
    ) -> Self {
        let count = stages.len();
        Self {
            flow: Flow::new(&stages, points, None, budget),
            stages,
            end,
            tally: Tally { drawing: Drawing::default(), polygons: Polygons::default(), held: budget.nothing() },
            ledgers: vec![Ledger::default(); count],
            whose: vec![VecDeque::new(); count],
            waits: vec![Vec::new(); count],
            groups,
            over: None,
            also,
        }
    }

    /// Charges a step and what it waited for.
    fn charge(&mut self, stage: usize, from: Cycle, to: Cycle) -> Result<(), OverBudget> {
        let origin = self.whose[stage].pop_front().unwrap_or_default();
        if let Some(groups) = &self.groups {
            groups.borrow_mut().step(stage, &origin)?;
        }
        let Self { ledgers, tally: Tally { drawing, polygons, held }, waits, .. } = self;
        let (to, busy) = (to.0.min(self.end), Cycle(to.0.min(self.end)).since(from));
        polygons.live(&origin, from.0, to);
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
        let Tally { drawing, polygons: Polygons { list, objects, frames, .. }, held } = self.tally;
        let units = self.ledgers.into_iter().zip(&self.stages).zip(&report.units);
        Costs {
            cycles: report.total,
            frames: self.flow.frames(),
            units: units.map(|((ledger, stage), unit)| ledger.finish(stage, unit)).collect(),
            polygons: list,
            drawing,
            objects,
            whole_frames: frames,
            _held: held,
        }
    }
}

impl Probe for CostProbe<'_> {
    fn reads_labels(&self) -> bool {
        self.over.is_none() || self.also.as_ref().is_some_and(|probe| probe.reads_labels())
    }

    fn reads_levels(&self) -> bool {
        self.also.as_ref().is_some_and(|probe| probe.reads_levels())
    }

    fn stepped(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        if let Some(also) = self.also.as_mut().filter(|probe| probe.reads_labels()) {
            also.stepped(stage, [taken, asked], given);
        }
        if self.over.is_some() {
            return;
        }
        match self.flow.step((stage, taken), given, &mut self.tally) {
            Ok(whose) => self.whose[stage].push_back(whose),
            Err(over) => self.over = Some(over),
        }
    }

    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        if let Some(also) = &mut self.also {
            also.worked(stage, from, to);
        }
        if self.over.is_none() {
            self.over = self.charge(stage, from, to).err();
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
