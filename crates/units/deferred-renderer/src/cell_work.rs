//! Arithmetic of the initial rasterization (454).

use crate::config::{EngineConfig, LightingMode};
use crate::sizes::TableSizes;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{HardwareKind, OperandWidth, OperatorCounts, Operators};

/// Single-precision number \[bits\].
const NUMBER: u32 = 32;
/// Words of the table of logarithms. A straight line between two of 256 entries is off by at most 1 / (8 ln 2 * 256^2) = 2^-18.5,
/// less than the last of the 18 fraction bits of D (314).
const LOGARITHMS: u32 = 256;
/// Width of a table entry: a logarithm, and the difference to the next one \[bits\].
const LOGARITHM_BITS: u32 = 24 + 16;
/// Numbers of a triangle's set-up: planes of R, G, B, S, T (3 each), and the footprint: origin (2), 1/w and its slopes (3),
/// slopes of S/w and T/w (4).
const SLOPES: u32 = 5 * 3 + 9;

/// Arithmetic of one cell. Footprint: 18 products, 13 sums, and the reciprocal of the interpolated 1/w. Logarithm: a product and
/// two sums behind a table. D: a difference and two bounds. R, G, B, S, T: two products and two sums each. Three coefficients: a
/// product and a sum each.
const CELL: OperatorCounts =
    OperatorCounts { multiply: 18 + 1 + 10 + 3, add: 13 + 2 + 3 + 10 + 3, divide: 1, ..OperatorCounts::NONE };
/// Longest dependent chain of a cell: difference to the first corner, two terms of 1/w, reciprocal, S/w by it, an axis, its
/// square, two products with the reciprocal, logarithm, D.
const CELL_CHAIN: OperatorCounts = OperatorCounts { multiply: 7, add: 8, divide: 1, ..OperatorCounts::NONE };
/// Arithmetic of a triangle's set-up: 1/w relative to the largest (a quotient, 3 products), twice the area (2 products, a
/// difference) and its reciprocal, three planes (6 products and 2 sums each), their differences (16 sums, 4 products), S and T in
/// texels (6 products), colours (18 products), planes of R, G, B, S, T (10 differences).
const SETUP: OperatorCounts =
    OperatorCounts { multiply: 3 + 2 + 18 + 4 + 6 + 18, add: 5 + 1 + 6 + 16 + 10, divide: 2, ..OperatorCounts::NONE };
/// Arithmetic of a vertex under one light: N.L, N.H, the power of it, intensity and coefficients.
const LIT: OperatorCounts =
    OperatorCounts { multiply: 3, add: 4, power: 1, ..OperatorCounts::NONE }.and(OperatorCounts::INNER_PRODUCT.times(2));

/// Operators of the initial rasterization, and their occupancy.
#[derive(Clone, Debug)]
pub(crate) struct CellWork {
    operators: Operators,
    fill_rate: u32,
    dividers: u32,
    setup_units: u32,
}

impl CellWork {
    pub(crate) fn new(config: &EngineConfig, operators: Operators) -> Self {
        let &EngineConfig { fill_rate, dividers, setup_units, .. } = config;
        Self { operators, fill_rate, dividers, setup_units }
    }

    /// Returns the cycles from one group of cells to the next. Dividers take turns. All other operators are as many as a
    /// group needs.
    pub(crate) fn interval(&self) -> u64 {
        let Operators { multiply, add, divide, .. } = &self.operators;
        let quotients = (self.fill_rate * divide.interval).div_ceil(self.dividers);
        u64::from(quotients.max(multiply.interval).max(add.interval))
    }

    /// Returns the cycles from a fragment to its cell.
    pub(crate) fn latency(&self, least: u32) -> u64 {
        self.operators.latency(CELL_CHAIN).max(least.into())
    }

    /// Returns the cycles to set up `triangles` triangles with `vertices` lit vertices under `lights` lights each.
    pub(crate) fn setup(&self, triangles: u32, vertices: u32, lights: u32) -> u64 {
        let work = SETUP.times(triangles).and(LIT.times(vertices.saturating_mul(lights)));
        self.operators.interval(work, self.setup_operators())
    }

    fn setup_operators(&self) -> OperatorCounts {
        OperatorCounts { multiply: self.setup_units, add: self.setup_units, divide: 1, power: 1, ..OperatorCounts::NONE }
    }

    pub(crate) fn tell(&self, lighting: LightingMode, sizes: TableSizes, stats: &mut UnitStats) {
        let cells = CELL.times(self.fill_rate);
        stats.hardware(HardwareKind::Multiplier, "cells: footprint, planes, logarithm", cells.multiply, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Adder, "cells: footprint, planes, logarithm", cells.add, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Divider, "cells: perspective of the footprint", self.dividers, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Table, "cells: logarithms", LOGARITHMS * self.fill_rate, LOGARITHM_BITS);
        let setup = self.setup_operators();
        let lit = if lighting == LightingMode::Gouraud { LIT } else { OperatorCounts::NONE };
        let of_triangles = OperatorCounts { power: 0, ..setup };
        stats.shared_operators("set-up of triangles", of_triangles, SETUP.and(lit), OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "triangle that is set up", SLOPES, NUMBER);
        stats.hardware(HardwareKind::Registers, "its page and wrap modes", 1_u32, sizes.surface_bits());
        if lighting == LightingMode::Gouraud {
            stats.hardware(HardwareKind::Power, "brightness of vertices of bump targets", setup.power, OperandWidth::SINGLE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_kernel::OperatorConfig;

    fn work(dividers: u32) -> CellWork {
        let divide = OperatorConfig::new(17, 17);
        let operators = Operators { divide, power: OperatorConfig::new(54, 54), ..Operators::default() };
        CellWork::new(&EngineConfig { dividers, ..EngineConfig::default() }, operators)
    }

    #[test]
    fn cell_waits_for_its_division() {
        assert_eq!([17, 2, 1].map(|dividers| work(dividers).interval()), [1, 9, 17]);
        assert_eq!(work(1).latency(8), 17 + 7 + 8);
    }

    #[test]
    fn set_up_needs_divider_and_light_needs_power() {
        assert_eq!(work(17).setup(2, 0, 0), 2 * 2 * 17);
        assert_eq!(work(17).setup(1, 4, 2), 8 * 54);
    }
}
