//! Costs of the approximate calculator (310a): cycles and hardware.

use super::ApproximateCalculator;
use crate::config::MipPer;
use crate::fixed::iterations;
use crate::pixel_pace::PixelPace;
use crate::signals::LineSegment;
use basrelief_kernel::stats::{IterativeOperators, UnitStats};
use basrelief_kernel::{HardwareKind, OperatorCounts};
use basrelief_signals::{BitWidth, SignalWidths};

/// Longest dependent chain from the ends of a segment to a pixel: their difference, times a reciprocal from the table, times the
/// position or step by step, and the start.
const CHAIN: OperatorCounts = OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE };
/// Arithmetic of u, v at a pixel. A segment may have a single pixel, so each pixel may need the products of a segment.
const PRODUCTS: OperatorCounts = OperatorCounts { multiply: 2, ..OperatorCounts::NONE };
/// Differences of the ends, or sums at a pixel, of u, v.
const SUMS: OperatorCounts = OperatorCounts { add: 2, ..OperatorCounts::NONE };
/// Step of the depth.
const DEPTH: OperatorCounts = OperatorCounts { add: 1, ..OperatorCounts::NONE };
/// Arithmetic of du, dv at a pixel: a product and a difference each, and a product with 1 / W.
const CHANGE: OperatorCounts = OperatorCounts { multiply: 4, add: 2, ..OperatorCounts::NONE };
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
        let pace = PixelPace { operators: &self.operators, interval: self.config.initiation_interval };
        pace.tell("u, v per pixel", PRODUCTS, bits, stats);
        pace.tell("difference of the ends", SUMS, bits, stats);
        pace.tell("interpolation of u, v", SUMS, bits + self.guard(), stats);
        pace.tell("interpolation of depth", DEPTH, words.depth, stats);
        stats.hardware(HardwareKind::Registers, "the segment", 1_u32, LineSegment::bits(&words));
        stats.hardware(HardwareKind::Registers, "u, v: start, end", 4_u32, bits);
        stats.hardware(HardwareKind::Registers, "u, v: change and sum", 4_u32, bits + self.guard());
        if self.gradients == Some(MipPer::Pixel) {
            let width = self.config.reciprocal_bits;
            let divider = IterativeOperators { count: 1, turns: 1, width, digits_per_cycle: self.bits_per_cycle };
            stats.iterative(HardwareKind::Divider, "1 / W for du, dv", divider);
            pace.tell("du, dv of a pixel", CHANGE, width, stats);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{ApproximationConfig, TexelConfig};
    use basrelief_kernel::Operators;

    #[test]
    fn slower_pixels_share_operators() {
        let counts = |initiation_interval| {
            let config = ApproximationConfig { initiation_interval, ..ApproximationConfig::default() };
            let unit =
                ApproximateCalculator::new(config, &TexelConfig::default(), [2, 24], Some(MipPer::Pixel), Operators::default());
            let mut stats = UnitStats::default();
            unit.tell_hardware(&mut stats);
            let operators = stats.all_hardware().iter().filter(|piece| piece.kind.computes() && piece.digits_per_cycle == 0);
            operators.map(|piece| (piece.count, piece.turns)).collect::<Vec<_>>()
        };
        assert_eq!(counts(1), [2, 2, 2, 1, 4, 2].map(|count| (count, 1)));
        assert_eq!(counts(3), [(1, 2), (1, 2), (1, 2), (1, 1), (2, 2), (1, 2)]);
        assert_eq!(counts(16), [2, 2, 2, 1, 4, 2].map(|turns| (1, turns)));
    }
}
