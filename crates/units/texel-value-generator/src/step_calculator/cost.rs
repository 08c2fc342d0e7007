//! Costs of the step calculator: cycles and hardware.

use super::StepCalculator;
use crate::config::{Method, TexelConfig};
use crate::fixed::iterations;
use crate::signals::ScanSpan;
use basrelief_kernel::stats::{IterativeOperators, UnitStats};
use basrelief_kernel::{HardwareKind, OperatorCounts};
use basrelief_signals::width::NUMBER;
use basrelief_signals::{BitWidth, SignalWidths};

/// Adders of the step calculator, besides those of its points.
const ADDERS: u32 = 3;
/// Arithmetic of the decision if a span needs a division: two squares, two products, two sums and a comparison.
const DECISION: OperatorCounts = OperatorCounts { multiply: 4, add: 3, ..OperatorCounts::NONE };
/// Longest dependent chain of the decision.
const DECISION_CHAIN: OperatorCounts = OperatorCounts { multiply: 2, add: 2, ..OperatorCounts::NONE };
/// Arithmetic of U, V and W of a point, each a product and a sum.
const POINT: OperatorCounts = OperatorCounts { multiply: 1, add: 1, ..OperatorCounts::NONE };

impl StepCalculator {
    /// Returns the occupancy of the decision if a span needs a division \[cycles\].
    pub(super) fn decision(&self) -> u64 {
        self.operators
            .interval(DECISION, OperatorCounts { multiply: self.config.multipliers, add: ADDERS, ..OperatorCounts::NONE })
    }

    /// Returns the cycles of e / |dw|, or of a root.
    pub(super) fn iterations(&self) -> u64 {
        iterations(self.config.step_bits, self.bits_per_cycle).into()
    }

    /// Returns the cycles of a root, or of the look-up that replaces it.
    pub(super) fn root(&self) -> u64 {
        if self.table.is_some() { self.config.table_cycles.into() } else { self.iterations() }
    }

    /// Returns the cycles of the pipelines before and behind the turns.
    pub(super) fn latency(&self) -> u64 {
        let decision = if self.config.method == Method::Adaptive { self.operators.latency(DECISION_CHAIN) } else { 0 };
        decision + self.operators.latency(POINT)
    }

    pub(super) fn tell_hardware(&self, stats: &mut UnitStats) {
        let TexelConfig { method, step_bits, coordinate_bits, multipliers, step_table, .. } = self.config;
        let widths = SignalWidths { texture: coordinate_bits, ..SignalWidths::default() };
        stats.hardware(HardwareKind::Multiplier, "U, V, W of a point", 3_u32, coordinate_bits);
        stats.hardware(HardwareKind::Adder, "U, V, W of a point", 3_u32, coordinate_bits);
        stats.hardware(HardwareKind::Registers, "the span", 1_u32, ScanSpan::bits(&widths));
        if method != Method::Adaptive {
            return;
        }
        stats.hardware(HardwareKind::Registers, "storage element: criterion e", 1_u32, NUMBER);
        let have = OperatorCounts { multiply: multipliers, add: ADDERS, ..OperatorCounts::NONE };
        stats.shared_operators("whether a span is divided; steps", have, DECISION, NUMBER);
        let operator = IterativeOperators { count: 1, turns: 1, width: step_bits, digits_per_cycle: self.bits_per_cycle };
        stats.iterative(HardwareKind::Divider, "e / |dw|", operator);
        match step_table {
            0 => stats.iterative(HardwareKind::SquareRoot, "steps", operator),
            entries => stats.hardware(HardwareKind::Table, "square roots", entries, step_bits),
        }
    }
}
