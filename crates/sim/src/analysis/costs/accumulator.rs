//! Accumulation of a unit's cycles by activity and pixel.

use super::cycle_breakdown::CostKind;
use super::pixels::PixelRecords;
use crate::analysis::attribution::TokenOrigin;
use basrelief_input::{MemoryReservation, OverBudget};
use basrelief_kernel::{CycleAccount, MAX_CLIENTS, MAX_LINKS, StageTopology, StallCause, UnitReport};

/// Parts of a cycle: divisible by all numbers up to 16, the maximum number of pixels in most tokens, so that pixels can share a cycle
/// without a remainder.
pub const PARTS: u64 = 720_720;

/// Cycles that a unit spent in one activity: busy, or waiting for one FIFO or memory client.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActivityCost {
    /// Activity.
    pub kind: CostKind,
    /// FIFO or memory client that the unit waited for; empty if busy.
    pub of: String,
    /// Cycles for pixels.
    pub on_pixels: u64,
    /// Cycles for polygons, objects and frames without pixels.
    pub non_pixel: u64,
    /// Cycles for no token: waits after the last step.
    pub unattributed: u64,
    /// [`PARTS`] of a cycle of each pixel, row by row; empty if no pixel has any.
    pub parts: Vec<u64>,
}

/// Costs of a unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitCost {
    /// Name of the unit.
    pub unit: String,
    /// Busy cycles, then each kind of wait.
    pub activities: Vec<ActivityCost>,
    /// Cycles after the last step.
    pub done: u64,
}

const STARVED: usize = 1;
const MEMORY: usize = STARVED + MAX_LINKS;
const BLOCKED: usize = MEMORY + MAX_CLIENTS;
const SLOTS: usize = BLOCKED + MAX_LINKS;

/// Returns the slot of a wait. Busy cycles have slot 0.
pub(super) fn slot_of(cause: StallCause) -> usize {
    match cause {
        StallCause::Starved(i) => STARVED + i,
        StallCause::Memory(i) => MEMORY + i,
        StallCause::Blocked(i) => BLOCKED + i,
    }
}

/// Returns the activity of a slot.
pub(super) fn kind_of(slot: usize) -> CostKind {
    match slot {
        BLOCKED.. => CostKind::Blocked,
        MEMORY.. => CostKind::Memory,
        STARVED.. => CostKind::Starved,
        0 => CostKind::Busy,
    }
}

#[derive(Clone, Debug, Default)]
struct ActivitySlot {
    parts: Vec<u64>,
    on_pixels: u64,
    elsewhere: u64,
}

/// Cycles to charge.
#[derive(Clone, Copy)]
pub(super) struct CycleCharge {
    pub(super) slot: usize,
    pub(super) cycles: u64,
}

/// Cycles of a unit so far.
#[derive(Clone, Debug, Default)]
pub(super) struct CostAccumulator([ActivitySlot; SLOTS]);

impl CostAccumulator {
    /// Charges cycles to an origin.
    ///
    /// Pixels share the cycles evenly. The remainder in a span of more than 16 pixels goes to the first pixels, one part each.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    pub(super) fn charge(
        &mut self,
        CycleCharge { slot, cycles }: CycleCharge,
        origin: &TokenOrigin,
        pixels: &PixelRecords,
        held: &mut MemoryReservation,
    ) -> Result<(), OverBudget> {
        let slot = &mut self.0[slot];
        let count = pixels.indices(origin).count() as u64;
        if count == 0 {
            slot.elsewhere += cycles;
            return Ok(());
        }
        if slot.parts.is_empty() {
            let [width, height] = pixels.size.map(u64::from);
            held.try_grow(size_of::<u64>() as u64 * width * height, "costs of pixels")?;
            slot.parts = vec![0; (width * height) as usize];
        }
        slot.on_pixels += cycles;
        let (each, rest) = (cycles * PARTS / count, cycles * PARTS % count);
        for (i, place) in (0..).zip(pixels.indices(origin)) {
            slot.parts[place] += each + u64::from(i < rest);
        }
        Ok(())
    }

    /// Completes the costs with the account of the unit. Cycles that were not charged belong to no token.
    pub(super) fn finish(self, stage: &StageTopology, report: &UnitReport) -> UnitCost {
        let CycleAccount { busy, done, starved, memory, blocked } = &report.account;
        let all = std::iter::once(busy).chain(starved).chain(memory).chain(blocked);
        let activity = |(at, (slot, &cycles)): (usize, (ActivitySlot, &u64))| {
            let ActivitySlot { parts, on_pixels, elsewhere } = slot;
            let kind = kind_of(at);
            let of = match kind {
                CostKind::Busy => None,
                CostKind::Starved => stage.inputs.get(at - STARVED),
                CostKind::Memory => stage.clients.get(at - MEMORY),
                CostKind::Blocked => stage.outputs.get(at - BLOCKED),
            };
            let for_nobody = cycles.saturating_sub(on_pixels + elsewhere);
            ActivityCost {
                kind,
                of: of.cloned().unwrap_or_default(),
                on_pixels,
                non_pixel: elsewhere,
                unattributed: for_nobody,
                parts,
            }
        };
        let activities = self.0.into_iter().zip(all).enumerate().map(activity);
        let any = |activity: &ActivityCost| {
            activity.kind == CostKind::Busy || activity.on_pixels + activity.non_pixel + activity.unattributed > 0
        };
        UnitCost { unit: stage.name.clone(), activities: activities.filter(any).collect(), done: *done }
    }
}
