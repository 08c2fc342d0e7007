//! Dividers: exact u and v at division points.

use crate::config::{DividerConfig, Division};
use crate::fixed::{iterations, nearest, to_fixed};
use crate::signals::{DivisionPoint, DivisionPoints, FixedCoordinates, Quotients};
use basrelief_kernel::stats::{IterativeOperators, UnitStats};
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperatorCounts, Operators, Step, Unit, UnitTable};
use basrelief_signals::Flow;
use serde::{Deserialize, Serialize};

/// The two products behind a reciprocal, with one multiplier each.
const PRODUCTS: OperatorCounts = OperatorCounts { multiply: 2, ..OperatorCounts::NONE };

/// Counters of the dividers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DividerCounters {
    /// Points divided.
    pub points: u64,
    /// Divisions U / W and V / W.
    pub divisions: u64,
    /// Reciprocals 1 / W.
    pub reciprocals: u64,
    /// Multiplications behind reciprocals.
    pub multiplications: u64,
}

/// State of the dividers between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DividerState {
    /// Counters.
    pub counters: DividerCounters,
}

/// Dividers of the texel value generator (310): steps 610 and 620, exact values at end points and division points.
///
/// The points of a token are divided in order, and all results leave with the last one. A free divider takes the next division.
/// Quotients are rounded to the nearest step of fixed point. A reciprocal has as many bits as a quotient, and its product is
/// rounded.
#[derive(Clone, Debug, Default)]
pub struct Divider {
    /// Parameters.
    pub config: DividerConfig,
    /// Width of u and v \[bits\].
    pub bits: u32,
    /// Latencies of the operators.
    pub operators: Operators,
    /// State between steps.
    pub state: DividerState,
}

impl Divider {
    /// Creates dividers in their power-on state, for u and v of `bits` bits.
    pub fn new(config: DividerConfig, bits: u32, operators: Operators) -> Self {
        Self { config, bits, operators, state: DividerState::default() }
    }

    /// Returns latency and initiation interval of a division in one divider \[cycles\].
    fn division(&self) -> [u64; 2] {
        let latency = iterations(self.bits, self.config.bits_per_cycle).into();
        [latency, if self.config.pipelined { 1 } else { latency }]
    }

    /// Returns the occupancy of the dividers by this many divisions, and the latency to the last quotient \[cycles\].
    pub fn cycles(&self, divisions: u64) -> (u64, u64) {
        let ([latency, interval], count) = (self.division(), u64::from(self.config.count.max(1)));
        let occupancy = (divisions * interval).div_ceil(count).max(1);
        (occupancy, latency + divisions.saturating_sub(1) / count * interval)
    }

    /// Returns the divisions of a point.
    fn per_point(&self) -> u64 {
        if self.config.division == Division::Two { 2 } else { 1 }
    }

    fn divide(&mut self, points: &DivisionPoints) -> (Quotients, u64, u64) {
        let (count, bits) = (points.len() as u64, self.bits);
        let (occupancy, latency) = self.cycles(self.per_point() * count);
        let counters = &mut self.state.counters;
        counters.points += count;
        if self.config.division == Division::Two {
            counters.divisions += 2 * count;
            let quotient = |DivisionPoint([u, v, w]): &DivisionPoint| FixedCoordinates([u / w, v / w].map(|c| to_fixed(c, bits)));
            return (points.iter().map(quotient).collect(), occupancy, latency);
        }
        counters.reciprocals += count;
        counters.multiplications += 2 * count;
        let quotient = |DivisionPoint([u, v, w]): &DivisionPoint| {
            let reciprocal = nearest(1.0 / w, bits);
            FixedCoordinates([u * reciprocal, v * reciprocal].map(|c| to_fixed(c, bits)))
        };
        let products = self.operators.interval(PRODUCTS, PRODUCTS) * count;
        let latency = latency + self.operators.latency(OperatorCounts { multiply: 1, ..OperatorCounts::NONE });
        (points.iter().map(quotient).collect(), occupancy.max(products), latency)
    }
}

impl Unit for Divider {
    basrelief_kernel::unit_info!("exact u, v at ends and division points");
    type In = Option<Flow<DivisionPoints>>;
    type Out = Option<Flow<Quotients>>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        match input {
            // A token without points passes.
            Some(Flow::Item(points)) if points.is_empty() => Step::after(0, Some(Flow::Item(Quotients::new()))),
            Some(Flow::Item(points)) => {
                let (quotients, occupancy, latency) = self.divide(&points);
                Step::after(latency, Some(Flow::Item(quotients))).busy(occupancy)
            }
            Some(Flow::Control(control)) => Step::after(0, Some(Flow::Control(control))),
            None => Step::after(0, None),
        }
    }

    /// Returns latency and interval of a division, divisions of a point, and the interval and latency of its products.
    fn twin_tables(&self) -> Vec<UnitTable> {
        let [latency, interval] = self.division();
        let (mut product, mut products) = (0, 0);
        if self.config.division == Division::Reciprocal {
            product = self.operators.latency(OperatorCounts { multiply: 1, ..OperatorCounts::NONE });
            products = self.operators.interval(PRODUCTS, PRODUCTS);
        }
        let numbers = [
            ("latency", latency),
            ("interval", interval),
            ("per_point", self.per_point()),
            ("product", product),
            ("products", products),
        ];
        numbers.into_iter().map(|(name, value)| UnitTable::number(name, value)).collect()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let (interval, latency) = self.cycles(self.per_point());
        stats.rate(0, latency, interval);
        let c = &self.state.counters;
        stats.figure("points_divided", c.points, "points", "Points whose u, v were divided");
        stats.figure("divisions", c.divisions, "divisions", "Divisions U / W and V / W");
        stats.figure("reciprocals", c.reciprocals, "reciprocals", "Reciprocals in their place");
        stats.figure(
            "multiplications",
            c.multiplications,
            "multiplications",
            "Multiplications of dividers and approximate calculator",
        );
        // A pipeline has the hardware of an iteration once per cycle of latency.
        let copies = if self.config.pipelined { iterations(self.bits, self.config.bits_per_cycle) } else { 1 };
        // U and V of a point take turns if there are fewer dividers.
        let turns = (self.per_point() as u32).div_ceil(self.config.count.max(1));
        let (count, digits_per_cycle) = (self.config.count * copies, self.config.bits_per_cycle);
        let dividers = IterativeOperators { count, turns, width: self.bits, digits_per_cycle };
        stats.iterative(HardwareKind::Divider, "u and v at division points", dividers);
        if self.config.division == Division::Reciprocal {
            stats.hardware(HardwareKind::Multiplier, "U and V by a reciprocal", PRODUCTS.multiply, self.bits);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_take_turns_in_one_divider() {
        let turns = |count| {
            let mut stats = UnitStats::default();
            let config = DividerConfig { count, division: Division::Two, ..DividerConfig::default() };
            Divider::new(config, 29, Operators::default()).report_stats(&mut stats);
            stats.all_hardware()[0].turns
        };
        assert_eq!([1, 2, 4].map(turns), [2, 1, 1]);
    }
}
