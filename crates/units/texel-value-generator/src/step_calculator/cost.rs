//! What the step calculator takes: cycles and hardware.

use super::StepCalculator;
use crate::config::{Method, TexelConfig};
use crate::fixed::iterations;
use crate::signals::Span;
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{HardwareKind, Work};
use basrelief_signals::width::NUMBER;
use basrelief_signals::{BitWidth, SignalWidths};

/// Adders of the step calculator, beside those of its points.
const ADDERS: u32 = 3;
/// What decides whether a span needs a division: two squares, two products; two sums and a comparison.
const DECISION: Work = Work { multiply: 4, add: 3, ..Work::NONE };
/// The longest way through that.
const DECISION_CHAIN: Work = Work { multiply: 2, add: 2, ..Work::NONE };
/// From e / |dw| to what the root of the first step is taken of, and from that root to the step.
pub(super) const FIRST_STEP: Work = Work { multiply: 1, add: 1, ..Work::NONE };
/// From a step to what the next root is taken of, which is e t more or less, and from that root to the next step.
pub(super) const NEXT_STEP: Work = Work { multiply: 1, add: 2, ..Work::NONE };
/// U, V and W of a point, each a product and a sum.
const POINT: Work = Work { multiply: 1, add: 1, ..Work::NONE };

impl StepCalculator {
    /// Cycles for which a span keeps the unit to decide whether it needs a division.
    pub(super) fn decision(&self) -> u64 {
        self.operators.interval(DECISION, Work { multiply: self.config.multipliers, add: ADDERS, ..Work::NONE })
    }

    /// Cycles of e / |dw|, or of a root.
    pub(super) fn iterations(&self) -> u64 {
        iterations(self.config.step_bits, self.bits_per_cycle).into()
    }

    /// Cycles of a root, or of the look-up in its place.
    pub(super) fn root(&self) -> u64 {
        if self.table.is_some() { self.config.table_cycles.into() } else { self.iterations() }
    }

    /// Cycles through the pipelines in front of the turns and behind them.
    pub(super) fn latency(&self) -> u64 {
        let decision = if self.config.method == Method::Adaptive { self.operators.latency(DECISION_CHAIN) } else { 0 };
        decision + self.operators.latency(POINT)
    }

    pub(super) fn tell_hardware(&self, facts: &mut Facts) {
        let TexelConfig { method, step_bits, coordinate_bits, multipliers, step_table, .. } = self.config;
        let widths = SignalWidths { texture: coordinate_bits, ..SignalWidths::default() };
        facts.hardware(HardwareKind::Multiplier, "U, V, W of a point", 3_u32, coordinate_bits);
        facts.hardware(HardwareKind::Adder, "U, V, W of a point", 3_u32, coordinate_bits);
        facts.hardware(HardwareKind::Registers, "the span", 1_u32, Span::bits(&widths));
        if method != Method::Adaptive {
            return;
        }
        facts.hardware(HardwareKind::Registers, "storage element: criterion e", 1_u32, NUMBER);
        facts.hardware(HardwareKind::Multiplier, "whether a span is divided; steps", multipliers, NUMBER);
        facts.hardware(HardwareKind::Adder, "whether a span is divided; steps", ADDERS, NUMBER);
        facts.hardware(HardwareKind::Divider, "e / |dw|", 1_u32, step_bits);
        match step_table {
            0 => facts.hardware(HardwareKind::SquareRoot, "steps", 1_u32, step_bits),
            entries => facts.hardware(HardwareKind::Table, "square roots", entries, step_bits),
        }
    }
}
