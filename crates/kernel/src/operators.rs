//! Operators: the time that arithmetic takes, the same everywhere in a machine.
//!
//! A unit states the operations of a piece of work and the number of its operators, both as [`OperatorCounts`]. The machine's table
//! [`Operators`] gives the time:
//!
//! ```
//! use basrelief_kernel::{OperatorConfig, OperatorCounts, Operators};
//!
//! let operators = Operators { divide: OperatorConfig::new(7, 7), multiply: OperatorConfig::new(4, 1), ..Operators::default() };
//! let projection = OperatorCounts { divide: 1, multiply: 3, ..OperatorCounts::NONE };
//! let unit = OperatorCounts { divide: 1, multiply: 2, ..OperatorCounts::NONE };
//! assert_eq!(operators.interval(projection, unit), 7, "one divider, busy for 7 cycles; two multipliers take 2 meanwhile");
//! assert_eq!(operators.latency(OperatorCounts { divide: 1, multiply: 1, ..OperatorCounts::NONE }), 11, "a quotient, then a product of it");
//! ```

#[cfg(not(feature = "config"))]
use crate::plain_parameters::{parameter_groups, parameters};
#[cfg(feature = "config")]
use basrelief_parameters::{parameter_groups, parameters};

parameters! {
    /// One kind of operator.
    pub struct OperatorConfig {
        /// Cycles from operands to result.
        latency: u32 = 1, unit: "cycles", Assumed("each machine has its own"), range: 1..=1024;
        /// Initiation interval: cycles from one operation to the next in the same operator; 1 if it is fully pipelined.
        interval: u32 = 1, unit: "cycles", Assumed("each machine has its own"), range: 1..=1024;
    }
}

impl OperatorConfig {
    /// An operator of this latency and interval \[cycles\].
    pub const fn new(latency: u32, interval: u32) -> Self {
        Self { latency, interval }
    }
}

parameter_groups! {
    /// The operators of a machine. All units use the same latencies and intervals. The first five take floating-point numbers.
    pub struct Operators {
        /// Multiplication.
        multiply: OperatorConfig = OperatorConfig::default(),
        /// Addition, subtraction and comparison.
        add: OperatorConfig = OperatorConfig::default(),
        /// Division; a reciprocal is one.
        divide: OperatorConfig = OperatorConfig::default(),
        /// Square root.
        square_root: OperatorConfig = OperatorConfig::default(),
        /// Power with any exponent.
        power: OperatorConfig = OperatorConfig::default(),
        /// Multiplication of integers and fixed-point numbers.
        integer_multiply: OperatorConfig = OperatorConfig::default(),
        /// Addition, subtraction and comparison of integers and fixed-point numbers.
        integer_add: OperatorConfig = OperatorConfig::default(),
    }
}

/// Number of operations of each kind, or number of operators of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OperatorCounts {
    /// Multiplications.
    pub multiply: u32,
    /// Additions, subtractions and comparisons.
    pub add: u32,
    /// Divisions.
    pub divide: u32,
    /// Square roots.
    pub square_root: u32,
    /// Powers.
    pub power: u32,
    /// Multiplications of integers.
    pub integer_multiply: u32,
    /// Additions, subtractions and comparisons of integers.
    pub integer_add: u32,
}

impl OperatorCounts {
    /// No operation.
    pub const NONE: Self = Self { multiply: 0, add: 0, divide: 0, square_root: 0, power: 0, integer_multiply: 0, integer_add: 0 };
    /// Dot product of two vectors of three.
    pub const INNER_PRODUCT: Self = Self { multiply: 3, add: 2, ..Self::NONE };
    /// Normalization of a vector of three: the square of its length, a root, a reciprocal, three products.
    pub const NORMALIZE: Self = Self { multiply: 6, add: 2, divide: 1, square_root: 1, ..Self::NONE };

    /// Returns these counts multiplied by `times`.
    #[must_use]
    pub const fn times(self, times: u32) -> Self {
        Self {
            multiply: self.multiply.saturating_mul(times),
            add: self.add.saturating_mul(times),
            divide: self.divide.saturating_mul(times),
            square_root: self.square_root.saturating_mul(times),
            power: self.power.saturating_mul(times),
            integer_multiply: self.integer_multiply.saturating_mul(times),
            integer_add: self.integer_add.saturating_mul(times),
        }
    }

    /// Returns the sum of both counts.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self {
            multiply: self.multiply.saturating_add(other.multiply),
            add: self.add.saturating_add(other.add),
            divide: self.divide.saturating_add(other.divide),
            square_root: self.square_root.saturating_add(other.square_root),
            power: self.power.saturating_add(other.power),
            integer_multiply: self.integer_multiply.saturating_add(other.integer_multiply),
            integer_add: self.integer_add.saturating_add(other.integer_add),
        }
    }
}

impl Operators {
    /// Cycles for which a piece of work occupies the operators if `have` operators of each kind work in parallel. The scarcest
    /// kind decides; the result is at least 1. For each kind that is needed there is at least one operator.
    pub fn interval(&self, work: OperatorCounts, have: OperatorCounts) -> u64 {
        self.max_over_kinds(work, have, |times, of, interval| times.div_ceil(of) * interval)
    }

    /// Cycles from one piece of work to the next in a stream of equal, independent pieces. Operators of a kind take turns, so
    /// seven dividers of 7 cycles each start a division in every cycle, while [`Operators::interval`] waits for all of them.
    pub fn stream_interval(&self, work: OperatorCounts, have: OperatorCounts) -> u64 {
        self.max_over_kinds(work, have, |times, of, interval| (times * interval).div_ceil(of))
    }

    /// Returns the fewest operators that start `work` once every `interval` cycles, in a stream of equal, independent pieces. This is the
    /// inverse of [`Operators::stream_interval`].
    pub fn sustaining(&self, work: OperatorCounts, interval: u32) -> OperatorCounts {
        let needed = |times: u32, of: &OperatorConfig| times.saturating_mul(of.interval).div_ceil(interval.max(1));
        OperatorCounts {
            multiply: needed(work.multiply, &self.multiply),
            add: needed(work.add, &self.add),
            divide: needed(work.divide, &self.divide),
            square_root: needed(work.square_root, &self.square_root),
            power: needed(work.power, &self.power),
            integer_multiply: needed(work.integer_multiply, &self.integer_multiply),
            integer_add: needed(work.integer_add, &self.integer_add),
        }
    }

    /// Returns the maximum, and at least 1, of `kept` over all kinds. Its arguments are operations, operators (>= 1), and
    /// interval.
    fn max_over_kinds(&self, work: OperatorCounts, have: OperatorCounts, kept: impl Fn(u64, u64, u64) -> u64) -> u64 {
        // Most work needs few kinds, and a division takes longer than the rest of a kind.
        let kept = |times: u32, of: u32, operator: &OperatorConfig| match times {
            0 => 0,
            _ => kept(u64::from(times), u64::from(of.max(1)), u64::from(operator.interval)),
        };
        [
            kept(work.multiply, have.multiply, &self.multiply),
            kept(work.add, have.add, &self.add),
            kept(work.divide, have.divide, &self.divide),
            kept(work.square_root, have.square_root, &self.square_root),
            kept(work.power, have.power, &self.power),
            kept(work.integer_multiply, have.integer_multiply, &self.integer_multiply),
            kept(work.integer_add, have.integer_add, &self.integer_add),
        ]
        .into_iter()
        .fold(1, u64::max)
    }

    /// Cycles of a chain in which each operation waits for the previous one.
    pub fn latency(&self, chain: OperatorCounts) -> u64 {
        let takes = |times: u32, operator: &OperatorConfig| u64::from(times) * u64::from(operator.latency);
        takes(chain.multiply, &self.multiply)
            + takes(chain.add, &self.add)
            + takes(chain.divide, &self.divide)
            + takes(chain.square_root, &self.square_root)
            + takes(chain.power, &self.power)
            + takes(chain.integer_multiply, &self.integer_multiply)
            + takes(chain.integer_add, &self.integer_add)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scarcest_operator_sets_the_interval() {
        let operators = Operators {
            multiply: OperatorConfig::new(4, 1),
            divide: OperatorConfig::new(7, 7),
            square_root: OperatorConfig::new(7, 7),
            ..Operators::default()
        };
        let have = |multiply, divide| OperatorCounts { multiply, divide, ..OperatorCounts::NONE };
        assert_eq!(operators.interval(OperatorCounts::NONE, OperatorCounts::NONE), 1);
        assert_eq!(operators.interval(OperatorCounts::NORMALIZE, have(4, 1)), 7);
        assert_eq!(operators.interval(OperatorCounts::NORMALIZE.times(2), have(4, 1)), 14);
        assert_eq!(operators.interval(OperatorCounts::NORMALIZE.times(2), have(4, 2)), 14, "there is still one root");
        assert_eq!(operators.interval(OperatorCounts::INNER_PRODUCT.times(16), have(3, 0)), 32, "one adder for 32 sums");
    }

    #[test]
    fn alternating_operators_keep_pace_with_stream() {
        let operators = Operators { divide: OperatorConfig::new(7, 7), ..Operators::default() };
        let divide = |divide| OperatorCounts { divide, ..OperatorCounts::NONE };
        assert_eq!(operators.interval(divide(1), divide(7)), 7, "alone");
        assert_eq!([1, 4, 7, 14].map(|have| operators.stream_interval(divide(1), divide(have))), [7, 2, 1, 1]);
        assert_eq!(operators.stream_interval(divide(2), divide(7)), 2);
        assert_eq!([7, 2, 1].map(|interval| operators.sustaining(divide(1), interval)), [1, 4, 7].map(divide));
    }
}
