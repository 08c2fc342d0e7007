//! The power `(N.H)^n`.

use crate::{NormalInterpolationConfig, PowerMethod};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{HardwareKind, OperandWidth, OperatorCounts, Operators};
use basrelief_signals::width::NUMBER;

/// Largest exponent that is computed by multiplication.
const MOST: f32 = 65_536.0;

/// Computes `x^n` for x in 0..=1, n >= 0: by repeated squaring and multiplication for whole n. A fraction of n is not modelled
/// step by step, and the result is then the exact one, rounded.
#[inline]
pub fn power(x: f32, n: f32) -> f32 {
    let whole = n as u32;
    if whole as f32 != n || n > MOST {
        return libm::powf(x, n);
    }
    let (mut result, mut square, mut rest) = (1.0, x, whole);
    while rest > 0 {
        if rest & 1 == 1 {
            result *= square;
        }
        square *= square;
        rest >>= 1;
    }
    result
}

/// Returns the number of multiplications of the iteration: squarings, and a product for each binary one of n except the first. A fraction of n
/// costs as much as the next whole number.
pub(crate) fn multiplications(n: f32) -> u64 {
    let whole = libm::ceilf(n).clamp(1.0, MOST) as u32;
    u64::from(whole.ilog2() + whole.count_ones() - 1)
}

/// Multipliers of a pipelined iteration for the worst n of a display list (up to 1000: ten binary digits, a squaring and a
/// product for each but the first).
const PIPELINE: u64 = 2 * 9;

/// Power function of circuit (50).
#[derive(Clone, Debug, PartialEq)]
pub struct PowerFunction {
    config: NormalInterpolationConfig,
    operators: Operators,
}

impl PowerFunction {
    /// Creates the power function of this configuration.
    pub fn new(config: &NormalInterpolationConfig, operators: &Operators) -> Self {
        Self { config: config.clone(), operators: operators.clone() }
    }

    /// Returns the cycles from N.H to its power. By iteration each multiplication waits for the previous one. By table N.H is
    /// multiplied by the number of entries and rounded to an address, and the entry is read.
    pub fn latency(&self, n: f32) -> u64 {
        match self.config.power {
            PowerMethod::Iteration => multiplications(n) * u64::from(self.operators.multiply.latency),
            PowerMethod::Table => {
                self.operators.latency(OperatorCounts { multiply: 1, add: 1, power: 1, ..OperatorCounts::NONE })
            }
        }
    }

    /// Returns the occupancy by inner products and power of a dot per light \[cycles\]. The power of a dot overlaps with the
    /// inner products of the next.
    pub fn occupancy(&self, n: f32) -> u64 {
        let products = self.inner_products();
        let own = match self.config.power {
            PowerMethod::Iteration if self.config.pipelined => {
                self.operators.interval(OperatorCounts { multiply: 1, ..OperatorCounts::NONE }, OperatorCounts::NONE)
            }
            PowerMethod::Iteration => self.latency(n),
            PowerMethod::Table => self
                .operators
                .interval(OperatorCounts { multiply: 1, add: 1, power: 1, ..OperatorCounts::NONE }, OperatorCounts::NONE),
        };
        own.max(products)
    }

    /// Returns the occupancy by inner products per light \[cycles\].
    pub fn inner_products(&self) -> u64 {
        u64::from(self.config.initiation_interval) * u64::from(self.config.inner_products)
    }

    /// Returns the cycles to fill the table for this n. One multiplier and one adder compute the entries, several at a time. The
    /// next N.H is a sum, its power takes as many multiplications as by iteration, and a sum rounds it.
    pub fn fill_cycles(&self, n: f32) -> u64 {
        let multiply = u32::try_from(multiplications(n)).unwrap_or(u32::MAX);
        match self.config.power {
            PowerMethod::Iteration => 0,
            PowerMethod::Table => {
                let entry =
                    self.operators.interval(OperatorCounts { multiply, add: 2, ..OperatorCounts::NONE }, OperatorCounts::NONE);
                u64::from(self.entries()) * entry
            }
        }
    }

    /// Returns the multiplications needed for [`PowerFunction::bound`].
    pub(crate) fn bound_multiplications(&self, n: f32) -> u64 {
        let powers = if self.config.power == PowerMethod::Table { 2 } else { 1 };
        powers * multiplications(n)
    }

    /// Reports its hardware.
    pub(crate) fn report_stats(&self, stats: &mut UnitStats) {
        match self.config.power {
            PowerMethod::Iteration => {
                let multipliers = if self.config.pipelined { PIPELINE } else { 1 };
                stats.hardware(HardwareKind::Multiplier, "power by iteration", multipliers, OperandWidth::SINGLE);
                stats.hardware(HardwareKind::Registers, "square, power, rest of n", 3 * multipliers, NUMBER);
            }
            PowerMethod::Table => {
                stats.hardware(HardwareKind::Multiplier, "address in the table of powers", 1_u64, OperandWidth::SINGLE);
                stats.hardware(HardwareKind::Adder, "its rounding", 1_u64, OperandWidth::SINGLE);
                stats.hardware(HardwareKind::Multiplier, "filling the table of powers", 1_u64, OperandWidth::SINGLE);
                stats.hardware(HardwareKind::Adder, "the same", 1_u64, OperandWidth::SINGLE);
                stats.hardware(HardwareKind::Table, "powers", self.entries(), self.config.table_bits);
            }
        }
    }

    /// Returns entry `index` for this exponent.
    fn entry(&self, index: u32, n: f32) -> f32 {
        let steps = ((1u32 << self.config.table_bits.clamp(1, 24)) - 1) as f32;
        let x = index as f32 / (self.entries() - 1) as f32;
        (power(x, n) * steps).round() / steps
    }

    fn entries(&self) -> u32 {
        self.config.table_entries.max(2)
    }

    /// Returns the index of the entry nearest to `x`, 0..=1.
    #[inline]
    fn index(&self, x: f32) -> u32 {
        (x * (self.entries() - 1) as f32 + 0.5) as u32
    }

    /// Returns the table for `n`, or an empty one if the method has none.
    pub fn table(&self, n: f32) -> Vec<f32> {
        match self.config.power {
            PowerMethod::Iteration => Vec::new(),
            PowerMethod::Table => (0..self.entries()).map(|i| self.entry(i, n)).collect(),
        }
    }

    /// Computes `x^n` for x in 0..=1. `table` is the [table](Self::table) for `n`.
    #[inline]
    pub fn at(&self, table: &[f32], x: f32, n: f32) -> f32 {
        match self.config.power {
            PowerMethod::Iteration => power(x, n),
            PowerMethod::Table => table.get(self.index(x) as usize).copied().unwrap_or_default(),
        }
    }

    /// Returns an upper bound of the power of any x in 0..=`limit`, here or at a sample point. Both powers grow with x, and a
    /// table may round up.
    pub fn bound(&self, limit: f32, n: f32) -> f32 {
        let exact = power(limit, n);
        match self.config.power {
            PowerMethod::Iteration => exact,
            PowerMethod::Table => exact.max(self.entry(self.index(limit), n)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_kernel::OperatorConfig;
    use proptest::prelude::*;

    // Claim: as iteration_equals_power.
    #[test]
    fn multiplications_follow_repeated_squaring() {
        assert_eq!([1.0, 2.0, 3.0, 50.0, 200.0, 1.5].map(multiplications), [0, 1, 2, 7, 9, 1]);
    }

    /// Returns multiplications and additions of two cycles, pipelined.
    fn operators() -> Operators {
        let two = OperatorConfig::new(2, 1);
        Operators { multiply: two.clone(), add: two, ..Operators::default() }
    }

    #[test]
    fn table_costs_address_rounding_and_filling() {
        let config = NormalInterpolationConfig { power: PowerMethod::Table, ..NormalInterpolationConfig::default() };
        let power = PowerFunction::new(&config, &operators());
        assert_eq!((power.occupancy(50.0), power.latency(50.0)), (1, 2 + 2 + 1), "a product, a sum, a read");
        assert_eq!((power.fill_cycles(50.0), power.fill_cycles(1.0)), (1024 * 7, 1024 * 2), "seven products, or two sums");
        let slow = Operators { multiply: OperatorConfig::new(6, 4), ..operators() };
        let slow = PowerFunction::new(&config, &slow);
        assert_eq!((slow.occupancy(50.0), slow.latency(50.0), slow.fill_cycles(50.0)), (4, 9, 1024 * 28));
    }

    #[test]
    fn iteration_occupies_multiplier_unless_pipelined() {
        let config = NormalInterpolationConfig::default();
        let iteration = PowerFunction::new(&config, &operators());
        assert_eq!((iteration.occupancy(50.0), iteration.latency(50.0), iteration.fill_cycles(50.0)), (14, 14, 0));
        let pipelined = PowerFunction::new(&NormalInterpolationConfig { pipelined: true, ..config.clone() }, &operators());
        assert_eq!((pipelined.occupancy(50.0), pipelined.latency(50.0)), (1, 14));
        assert!((1..=1000).all(|n| multiplications(n as f32) <= PIPELINE));
        let full = NormalInterpolationConfig { inner_products: 2, initiation_interval: 3, pipelined: true, ..config };
        let full = PowerFunction::new(&full, &operators());
        assert_eq!((full.occupancy(50.0), full.inner_products()), (6, 6));
    }

    proptest! {
        // Claim: shade, power: The iteration computes the power with the multiplications of squaring. A table errs by two steps.
        #[test]
        fn iteration_equals_power(x in 0f32..=1.0, n in 1u32..=1000, fraction in prop::sample::select(vec![0f32, 0.25, 0.7])) {
            let n = n as f32 + fraction;
            let exact = libm::pow(f64::from(x), f64::from(n));
            prop_assert!((f64::from(power(x, n)) - exact).abs() <= 1e-4 * exact + 1e-30);
        }

        // Claim: as iteration_equals_power.
        #[test]
        fn table_error_is_two_steps_and_below_bound(
            x in 0f32..=1.0, n in 1u32..=200, entries in 2u32..=4096, bits in 1u32..=24, share in 0f32..=1.0,
        ) {
            let n = n as f32;
            let config = NormalInterpolationConfig {
                power: PowerMethod::Table, table_entries: entries, table_bits: bits, ..NormalInterpolationConfig::default()
            };
            let by_table = PowerFunction::new(&config, &Operators::default());
            let table = by_table.table(n);
            // The slope of the power is at most n.
            let off = 0.5 * n / (entries - 1) as f32 + 0.5 / ((1u32 << bits) - 1) as f32;
            prop_assert!((by_table.at(&table, x, n) - power(x, n)).abs() <= off * 1.001 + 1e-5);
            prop_assert!(by_table.at(&table, x, n) <= by_table.bound(x, n));
            prop_assert!(by_table.at(&table, share * x, n) <= by_table.bound(x, n));
            prop_assert!(power(share * x, n) <= by_table.bound(x, n));
        }
    }
}
