//! Costs of the approximate calculator (310a): cycles and hardware.

use super::ApproximateCalculator;
use crate::config::MipPer;
use crate::fixed::iterations;
use crate::signals::LineSegment;
use basrelief_kernel::stats::{IterativeOperators, UnitStats};
use basrelief_kernel::{HardwareKind, OperatorCounts};
use basrelief_signals::{BitWidth, SignalWidths};

/// Longest dependent chain from the ends of a segment to a pixel: their difference, times a reciprocal from the table, times the
/// position or step by step, and the start.
const CHAIN: OperatorCounts = OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE };
/// Longest dependent chain from 1 / W to du, dv: a product.
const GRADIENT: OperatorCounts = OperatorCounts { multiply: 1, ..OperatorCounts::NONE };

impl ApproximateCalculator {
    /// Returns the cycles of a reciprocal 1 / W.
    pub(super) fn reciprocal(&self) -> u32 {
        iterations(self.config.reciprocal_bits, self.bits_per_cycle)
    }

    /// Returns the cycles from start to delivery of a pixel. `divides` is true if its gradient needs a reciprocal.
    pub(super) fn latency(&self, divides: bool) -> u64 {
        let reciprocal = u64::from(self.reciprocal()) + self.operators.latency(GRADIENT);
        let chain = self.operators.latency(CHAIN);
        if divides { chain.max(reciprocal) } else { chain }
    }

    pub(super) fn tell_hardware(&self, stats: &mut UnitStats) {
        let (bits, words) = (self.bits, SignalWidths { texture: self.bits, ..SignalWidths::default() });
        stats.hardware(HardwareKind::Table, "reciprocals of lengths", self.longest, bits);
        stats.hardware(HardwareKind::Multiplier, "u, v per pixel", 2_u32, bits);
        stats.hardware(HardwareKind::Adder, "difference of the ends", 2_u32, bits);
        stats.hardware(HardwareKind::Adder, "interpolation of u, v", 2_u32, bits + self.guard());
        stats.hardware(HardwareKind::Adder, "interpolation of depth", 1_u32, words.depth);
        stats.hardware(HardwareKind::Registers, "the segment", 1_u32, LineSegment::bits(&words));
        stats.hardware(HardwareKind::Registers, "u, v: start, end", 4_u32, bits);
        stats.hardware(HardwareKind::Registers, "u, v: change and sum", 4_u32, bits + self.guard());
        if self.gradients == Some(MipPer::Pixel) {
            let width = self.config.reciprocal_bits;
            let divider = IterativeOperators { count: 1, turns: 1, width, digits_per_cycle: self.bits_per_cycle };
            stats.iterative(HardwareKind::Divider, "1 / W for du, dv", divider);
            stats.hardware(HardwareKind::Multiplier, "du, dv of a pixel", 4_u32, width);
            stats.hardware(HardwareKind::Adder, "du, dv of a pixel", 2_u32, width);
        }
    }
}
