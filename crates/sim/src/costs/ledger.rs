//! What each unit was kept by, and waited for, pixel by pixel.

use super::drawing::Drawing;
use crate::flow::Origin;
use basrelief_input::{Held, OverBudget};
use basrelief_kernel::{Account, Cause, MAX_CLIENTS, MAX_LINKS, StageTopology, UnitReport};

/// Parts of a cycle that pixels share: so many that up to 16 pixels, as many as a token has, share a cycle without a rest.
pub const PARTS: u64 = 720_720;

/// On what a cycle was spent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CostKind {
    /// At work.
    Busy,
    /// Waiting for a token.
    Starved,
    /// Waiting for credits or answers.
    Memory,
    /// Waiting for a slot.
    Blocked,
}

impl CostKind {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Busy => "busy",
            Self::Starved => "starved",
            Self::Memory => "memory",
            Self::Blocked => "blocked",
        }
    }
}

/// Cycles that a unit spent on one thing: at work, or waiting for one FIFO or memory client.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WayCost {
    /// On what.
    pub kind: CostKind,
    /// Name of the FIFO or the client; empty at work.
    pub of: String,
    /// Cycles for pixels of the picture.
    pub on_pixels: u64,
    /// Cycles for polygons, objects and frames beside their pixels.
    pub elsewhere: u64,
    /// Cycles for nobody: waits after the last step.
    pub for_nobody: u64,
    /// [`PARTS`] of a cycle by pixel, row by row; empty where no pixel has any.
    pub parts: Vec<u64>,
}

/// Where the cycles of a unit went, and for whom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitCost {
    /// Its name.
    pub unit: String,
    /// At work, then every wait that it has had.
    pub ways: Vec<WayCost>,
    /// Cycles after its last step: for nobody.
    pub done: u64,
}

const STARVED: usize = 1;
const MEMORY: usize = STARVED + MAX_LINKS;
const BLOCKED: usize = MEMORY + MAX_CLIENTS;
const SLOTS: usize = BLOCKED + MAX_LINKS;

/// Where a wait is kept; work is at 0.
pub(super) fn slot_of(cause: Cause) -> usize {
    match cause {
        Cause::Starved(i) => STARVED + i,
        Cause::Memory(i) => MEMORY + i,
        Cause::Blocked(i) => BLOCKED + i,
    }
}

/// What is kept there.
pub(super) fn kind_of(slot: usize) -> CostKind {
    match slot {
        BLOCKED.. => CostKind::Blocked,
        MEMORY.. => CostKind::Memory,
        STARVED.. => CostKind::Starved,
        0 => CostKind::Busy,
    }
}

#[derive(Clone, Debug, Default)]
struct Slot {
    parts: Vec<u64>,
    on_pixels: u64,
    elsewhere: u64,
}

/// What a unit was kept by and waited for so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Ledger([Slot; SLOTS]);

impl Ledger {
    /// Charges cycles.
    ///
    /// Pixels share them evenly. What cannot be shared, in a span of more than 16, goes to the first ones, a part each.
    ///
    /// # Errors
    /// More than may be held.
    pub(super) fn charge(
        &mut self,
        (slot, cycles): (usize, u64),
        origin: &Origin,
        drawing: &Drawing,
        held: &mut Held,
    ) -> Result<(), OverBudget> {
        let slot = &mut self.0[slot];
        let count = drawing.places(origin).count() as u64;
        if count == 0 {
            slot.elsewhere += cycles;
            return Ok(());
        }
        if slot.parts.is_empty() {
            let [width, height] = drawing.size.map(u64::from);
            held.grow(size_of::<u64>() as u64 * width * height, "what each pixel costs")?;
            slot.parts = vec![0; (width * height) as usize];
        }
        slot.on_pixels += cycles;
        let (each, rest) = (cycles * PARTS / count, cycles * PARTS % count);
        for (i, place) in (0..).zip(drawing.places(origin)) {
            slot.parts[place] += each + u64::from(i < rest);
        }
        Ok(())
    }

    /// In the end, by the report of the unit: what was not charged was for nobody.
    pub(super) fn finish(self, stage: &StageTopology, report: &UnitReport) -> UnitCost {
        let Account { busy, done, starved, memory, blocked } = &report.account;
        let all = std::iter::once(busy).chain(starved).chain(memory).chain(blocked);
        let way = |(at, (slot, &cycles)): (usize, (Slot, &u64))| {
            let Slot { parts, on_pixels, elsewhere } = slot;
            let kind = kind_of(at);
            let of = match kind {
                CostKind::Busy => None,
                CostKind::Starved => stage.inputs.get(at - STARVED),
                CostKind::Memory => stage.clients.get(at - MEMORY),
                CostKind::Blocked => stage.outputs.get(at - BLOCKED),
            };
            let for_nobody = cycles.saturating_sub(on_pixels + elsewhere);
            WayCost { kind, of: of.cloned().unwrap_or_default(), on_pixels, elsewhere, for_nobody, parts }
        };
        let ways = self.0.into_iter().zip(all).enumerate().map(way);
        let any = |way: &WayCost| way.kind == CostKind::Busy || way.on_pixels + way.elsewhere + way.for_nobody > 0;
        UnitCost { unit: stage.name.clone(), ways: ways.filter(any).collect(), done: *done }
    }
}
