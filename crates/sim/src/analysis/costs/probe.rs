//! Probe that accumulates costs.

use super::accumulator::{CostAccumulator, CycleCharge, kind_of, slot_of};
use super::pixels::PixelRecords;
use super::polygons::PolygonCosts;
use super::run_costs::RunCosts;
use super::step_polygons::StepPolygons;
use crate::analysis::attribution::{FlowEvents, StepTokens, TokenFlow, TokenOrigin};
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_kernel::{Cycle, Label, MemoryEvent, Probe, RunReport, StageTopology, StallCause};
use basrelief_machines::CostPoints;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// Probe that accumulates costs, and forwards all events to another probe.
///
/// The origin of a step comes from execution, its duration from timing. The two streams may be offset, but each is in the order of the
/// stage's steps.
pub(crate) struct CostProbe<'a> {
    stages: Vec<StageTopology>,
    /// First cycle in which no step may start. Later cycles do not count.
    end: u64,
    flow: TokenFlow,
    tally: CostRecipients,
    accumulators: Vec<CostAccumulator>,
    /// Origins of each stage's steps that are executed but not yet timed.
    untimed: Vec<VecDeque<TokenOrigin>>,
    /// Waits of each stage since its last step.
    waits: Vec<Vec<CycleCharge>>,
    /// Polygon of each step, for the critical path.
    step_polygons: Option<Rc<RefCell<StepPolygons>>>,
    over_budget: Option<OverBudget>,
    next: Option<&'a mut dyn Probe>,
}

/// Options of a [`CostProbe`].
pub(crate) struct CostOptions<'a> {
    pub(crate) points: CostPoints,
    /// First cycle in which no step may start.
    pub(crate) end: u64,
    pub(crate) budget: &'a MemoryPool,
}

/// Recipients of costs.
struct CostRecipients {
    pixels: PixelRecords,
    polygons: PolygonCosts,
    held: MemoryReservation,
}

impl FlowEvents for CostRecipients {
    fn on_frame(&mut self, size: [u32; 2]) -> Result<(), OverBudget> {
        self.pixels.set_size(size, &mut self.held)
    }

    fn on_polygon(&mut self, origin: &TokenOrigin) -> Result<(), OverBudget> {
        self.polygons.enter(origin, &mut self.held)
    }

    fn on_fragments(&mut self, origin: &TokenOrigin) {
        self.pixels.count_fragments(origin);
        self.polygons.draw(origin);
    }

    fn on_visible_pixels(&mut self, origin: &TokenOrigin) {
        self.pixels.record_polygon(origin);
    }

    fn on_token_taken(&mut self, origin: &TokenOrigin) {
        self.pixels.record_level_and_entry(origin);
    }
}

impl<'a> CostProbe<'a> {
    pub(crate) fn new(
        stages: Vec<StageTopology>,
        CostOptions { points, end, budget }: CostOptions<'_>,
        step_polygons: Option<Rc<RefCell<StepPolygons>>>,
        next: Option<&'a mut dyn Probe>,
    ) -> Self {
        let count = stages.len();
        Self {
            flow: TokenFlow::new(&stages, points, None, budget),
            stages,
            end,
            tally: CostRecipients {
                pixels: PixelRecords::default(),
                polygons: PolygonCosts::default(),
                held: budget.empty_reservation(),
            },
            accumulators: vec![CostAccumulator::default(); count],
            untimed: vec![VecDeque::new(); count],
            waits: vec![Vec::new(); count],
            step_polygons,
            over_budget: None,
            next,
        }
    }

    /// Charges a step and its waits.
    fn charge(&mut self, stage: usize, from: Cycle, to: Cycle) -> Result<(), OverBudget> {
        let origin = self.untimed[stage].pop_front().unwrap_or_default();
        if let Some(polygons) = &self.step_polygons {
            polygons.borrow_mut().step(stage, &origin)?;
        }
        let Self { accumulators, tally: CostRecipients { pixels, polygons, held }, waits, .. } = self;
        let (to, busy) = (to.0.min(self.end), Cycle(to.0.min(self.end)).since(from));
        polygons.extend_lifetime(&origin, from.0, to);
        let spent = polygons.breakdown_of(&origin);
        for charge in waits[stage].drain(..).chain([CycleCharge { slot: 0, cycles: busy }]) {
            spent.charge(kind_of(charge.slot), charge.cycles);
            accumulators[stage].charge(charge, &origin, pixels, held)?;
        }
        Ok(())
    }

    /// Returns an error if the costs exceeded the memory limit.
    ///
    /// # Errors
    /// The memory limit was exceeded.
    pub(crate) fn check(&self) -> Result<(), OverBudget> {
        self.over_budget.clone().map_or(Ok(()), Err)
    }

    /// Returns the costs of the run with this report.
    pub(crate) fn finish(self, report: &RunReport) -> RunCosts {
        let CostRecipients { pixels, polygons: PolygonCosts { list, objects, frames, .. }, held } = self.tally;
        let units = self.accumulators.into_iter().zip(&self.stages).zip(&report.units);
        RunCosts {
            cycles: report.total,
            frames: self.flow.frames(),
            units: units.map(|((accumulator, stage), unit)| accumulator.finish(stage, unit)).collect(),
            polygons: list,
            pixels,
            objects,
            whole_frames: frames,
            _held: held,
        }
    }
}

impl Probe for CostProbe<'_> {
    fn reads_labels(&self) -> bool {
        self.over_budget.is_none() || self.next.as_ref().is_some_and(|probe| probe.reads_labels())
    }

    fn reads_levels(&self) -> bool {
        self.next.as_ref().is_some_and(|probe| probe.reads_levels())
    }

    fn reads_visible(&self) -> bool {
        self.next.as_ref().is_some_and(|probe| probe.reads_visible())
    }

    fn on_step(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        if let Some(next) = self.next.as_mut().filter(|probe| probe.reads_labels()) {
            next.on_step(stage, [taken, asked], given);
        }
        if self.over_budget.is_some() {
            return;
        }
        match self.flow.step(&StepTokens { stage, taken, given }, &mut self.tally) {
            Ok(origin) => self.untimed[stage].push_back(origin),
            Err(error) => self.over_budget = Some(error),
        }
    }

    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        if let Some(next) = &mut self.next {
            next.on_busy(stage, from, to);
        }
        if self.over_budget.is_none() {
            self.over_budget = self.charge(stage, from, to).err();
        }
    }

    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle) {
        if let Some(next) = &mut self.next {
            next.on_stall(stage, cause, from, to);
        }
        self.waits[stage].push(CycleCharge { slot: slot_of(cause), cycles: to.since(from) });
    }

    fn on_occupancy(&mut self, fifo: usize, at: Cycle, slots: usize) {
        if let Some(next) = &mut self.next {
            next.on_occupancy(fifo, at, slots);
        }
    }

    fn on_visible_count(&mut self, fifo: usize, at: Cycle, tokens: usize) {
        if let Some(next) = &mut self.next {
            next.on_visible_count(fifo, at, tokens);
        }
    }

    fn on_memory_event(&mut self, event: MemoryEvent) {
        if let Some(next) = &mut self.next {
            next.on_memory_event(event);
        }
    }
}
