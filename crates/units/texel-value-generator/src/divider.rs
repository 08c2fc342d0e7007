//! Dividers: exact u and v at division points.

use crate::config::{DividerConfig, Division};
use crate::signals::{Points, Quotients};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_signals::Flow;
use serde::{Deserialize, Serialize};

/// What the dividers have counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DividerCounters {
    /// Points.
    pub points: u64,
    /// Divisions U / W and V / W.
    pub divisions: u64,
    /// Reciprocals 1 / W.
    pub reciprocals: u64,
    /// Multiplications behind these.
    pub multiplications: u64,
}

/// Everything the dividers remember.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DividerState {
    /// What they have counted.
    pub counters: DividerCounters,
}

/// The dividers of the texel value generator (310): steps 610 and 620, exact values at end points and division points.
///
/// The points of a token are divided in order; all are there when the last one is. A divider that is free takes whatever
/// division is next.
#[derive(Clone, Debug, Default)]
pub struct Divider {
    /// Parameters.
    pub config: DividerConfig,
    /// Everything they remember.
    pub state: DividerState,
}

impl Divider {
    /// Dividers at power-on.
    pub fn new(config: DividerConfig) -> Self {
        Self { config, state: DividerState::default() }
    }

    /// Cycles that so many divisions keep the dividers, and from their start to the last quotient.
    pub fn cycles(&self, divisions: u64) -> (u64, u64) {
        let DividerConfig { count, latency, initiation_interval, .. } = self.config;
        let [count, interval] = [count, initiation_interval].map(u64::from);
        let occupancy = (divisions * interval).div_ceil(count.max(1)).max(1);
        (occupancy, u64::from(latency) + divisions.saturating_sub(1) / count.max(1) * interval)
    }

    fn divide(&mut self, points: &Points) -> (Quotients, u64, u64) {
        let count = points.len() as u64;
        self.state.counters.points += count;
        if self.config.division == Division::Two {
            self.state.counters.divisions += 2 * count;
            let (occupancy, latency) = self.cycles(2 * count);
            return (points.iter().map(|[u, v, w]| [u / w, v / w]).collect(), occupancy, latency);
        }
        self.state.counters.reciprocals += count;
        self.state.counters.multiplications += 2 * count;
        let (occupancy, latency) = self.cycles(count);
        let quotient = |[u, v, w]: &[f64; 3]| {
            let reciprocal = 1.0 / w;
            [u * reciprocal, v * reciprocal]
        };
        (points.iter().map(quotient).collect(), occupancy, latency + u64::from(self.config.multiply_cycles))
    }
}

impl Unit for Divider {
    basrelief_kernel::role!("exact u, v at ends and division points");
    type In = Option<Flow<Points>>;
    type Out = Option<Flow<Quotients>>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut Traffic) -> Step<Self::Out> {
        match input {
            // Nothing to divide: passes.
            Some(Flow::Item(points)) if points.is_empty() => Step::after(0, Some(Flow::Item(Quotients::new()))),
            Some(Flow::Item(points)) => {
                let (quotients, occupancy, latency) = self.divide(&points);
                Step::after(latency, Some(Flow::Item(quotients))).busy(occupancy)
            }
            Some(Flow::Control(control)) => Step::after(0, Some(Flow::Control(control))),
            None => Step::after(0, None),
        }
    }

    fn tell(&self, facts: &mut Facts) {
        // Two divisions keep so many dividers.
        let interval = (2 * self.config.initiation_interval).div_ceil(self.config.count);
        facts.rate(0, self.config.latency, interval);
        let c = &self.state.counters;
        facts.figure("points_divided", c.points, "points", "Points whose u, v were divided");
        facts.figure("divisions", c.divisions, "divisions", "Divisions");
        facts.figure("reciprocals", c.reciprocals, "reciprocals", "Reciprocals in their place");
        facts.figure(
            "multiplications",
            c.multiplications,
            "multiplications",
            "Multiplications of dividers and approximate calculator",
        );
    }
}
