//! The power `(N.H)^n`.

use crate::{NormalInterpolationConfig, PowerMethod};

/// Largest exponent that is raised to by multiplication.
const MOST: f32 = 65_536.0;

/// `x^n` for x in 0..=1, n >= 0: by repeated squaring and multiplication where n is whole. A fraction of n is not modelled
/// step by step: the result is then the exact one, rounded.
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

/// Multiplications of the iteration: squarings, and products for the further ones of n in binary. A fraction of n costs as
/// much as the next whole number.
fn multiplications(n: f32) -> u64 {
    let whole = libm::ceilf(n).clamp(1.0, MOST) as u32;
    u64::from(whole.ilog2() + whole.count_ones() - 1)
}

/// The power as circuit (50) has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Power {
    config: NormalInterpolationConfig,
}

impl Power {
    /// As configured.
    pub fn new(config: &NormalInterpolationConfig) -> Self {
        Self { config: config.clone() }
    }

    /// Cycles from N.H to its power.
    pub fn latency(&self, n: f32) -> u64 {
        match self.config.power {
            PowerMethod::Iteration => multiplications(n) * u64::from(self.config.multiply_cycles),
            PowerMethod::Table => u64::from(self.config.table_latency),
        }
    }

    /// Cycles that inner products and power of a dot keep the circuit, per light: the power of a dot is calculated beside the
    /// inner products of the next.
    pub fn occupancy(&self, n: f32) -> u64 {
        let iterates = self.config.power == PowerMethod::Iteration && !self.config.pipelined;
        let products = self.inner_products();
        if iterates { self.latency(n).max(products) } else { products }
    }

    /// Cycles that the inner products keep the circuit, per light.
    pub fn inner_products(&self) -> u64 {
        u64::from(self.config.initiation_interval) * u64::from(self.config.inner_products)
    }

    /// Cycles that it takes to fill the table for another n.
    pub fn fill_cycles(&self) -> u64 {
        match self.config.power {
            PowerMethod::Iteration => 0,
            PowerMethod::Table => u64::from(self.config.table_entries) * u64::from(self.config.table_cycles_per_entry),
        }
    }

    /// Entry `index` for this exponent.
    fn entry(&self, index: u32, n: f32) -> f32 {
        let steps = ((1u32 << self.config.table_bits.clamp(1, 24)) - 1) as f32;
        let x = index as f32 / (self.entries() - 1) as f32;
        (power(x, n) * steps).round() / steps
    }

    fn entries(&self) -> u32 {
        self.config.table_entries.max(2)
    }

    /// The entry nearest to `x`, 0..=1.
    #[inline]
    fn index(&self, x: f32) -> u32 {
        (x * (self.entries() - 1) as f32 + 0.5) as u32
    }

    /// What the table holds for `n`; empty where there is none.
    pub fn table(&self, n: f32) -> Vec<f32> {
        match self.config.power {
            PowerMethod::Iteration => Vec::new(),
            PowerMethod::Table => (0..self.entries()).map(|i| self.entry(i, n)).collect(),
        }
    }

    /// `x^n` for x in 0..=1; `table` is the [table](Self::table) for `n`.
    #[inline]
    pub fn at(&self, table: &[f32], x: f32, n: f32) -> f32 {
        match self.config.power {
            PowerMethod::Iteration => power(x, n),
            PowerMethod::Table => table.get(self.index(x) as usize).copied().unwrap_or_default(),
        }
    }

    /// The most that any x in 0..=`limit` can give here or at a sample point: both powers grow with x, and the rounding of
    /// a table may go up.
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
    use proptest::prelude::*;

    #[test]
    fn multiplications_are_those_of_squaring() {
        assert_eq!([1.0, 2.0, 3.0, 50.0, 200.0, 1.5].map(multiplications), [0, 1, 2, 7, 9, 1]);
    }

    #[test]
    fn a_table_costs_its_filling_and_then_a_look_up() {
        let config = NormalInterpolationConfig { power: PowerMethod::Table, ..NormalInterpolationConfig::default() };
        let power = Power::new(&config);
        assert_eq!((power.occupancy(50.0), power.latency(50.0), power.fill_cycles()), (1, 2, 4096));
        let iteration = Power::new(&NormalInterpolationConfig::default());
        assert_eq!((iteration.occupancy(50.0), iteration.latency(50.0), iteration.fill_cycles()), (14, 14, 0));
        let pipelined = Power::new(&NormalInterpolationConfig { pipelined: true, ..NormalInterpolationConfig::default() });
        assert_eq!((pipelined.occupancy(50.0), pipelined.latency(50.0)), (1, 14));
        let full = NormalInterpolationConfig { inner_products: 2, initiation_interval: 3, ..config };
        assert_eq!((Power::new(&full).occupancy(50.0), Power::new(&full).inner_products()), (6, 6));
    }

    proptest! {
        #[test]
        fn the_iteration_is_the_power(x in 0f32..=1.0, n in 1u32..=1000, fraction in prop::sample::select(vec![0f32, 0.25, 0.7])) {
            let n = n as f32 + fraction;
            let exact = libm::pow(f64::from(x), f64::from(n));
            prop_assert!((f64::from(power(x, n)) - exact).abs() <= 1e-4 * exact + 1e-30);
        }

        #[test]
        fn a_table_is_off_by_its_two_steps_and_never_above_its_bound(
            x in 0f32..=1.0, n in 1u32..=200, entries in 2u32..=4096, bits in 1u32..=24, share in 0f32..=1.0,
        ) {
            let n = n as f32;
            let config = NormalInterpolationConfig {
                power: PowerMethod::Table, table_entries: entries, table_bits: bits, ..NormalInterpolationConfig::default()
            };
            let by_table = Power::new(&config);
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
