//! Adder (52).

use crate::dots::needed;
use crate::{CircuitConfig, Dot, FigureFlow, Highlight, Highlights, Selection};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, HardwareKind, Operators, Step, Traffic, Unit};
use basrelief_signals::width::NUMBER;
use serde::{Deserialize, Serialize};

/// What the adder has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AdderCounters {
    /// Dots with a specular term added.
    pub sums: u64,
}

/// Everything the adder remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AdderState {
    /// The polygon's dots come from both sides.
    pub joins: bool,
    /// What it has counted.
    pub counters: AdderCounters,
}

/// Adder (52): the output of circuit (21) (input 0) plus what gate (51) lets through of circuit (50) (input 1).
///
/// Both circuits scan the same dots in the same order; they may come at different times, and the adder waits for the later.
/// Screen addresses that differ are a fault. Nothing is saturated here or before.
#[derive(Clone, Debug, Default)]
pub struct Adder {
    /// Parameters.
    pub config: CircuitConfig,
    operators: Operators,
    /// Everything it remembers.
    pub state: AdderState,
}

impl Adder {
    /// An adder at power-on.
    pub fn new(config: CircuitConfig, operators: Operators) -> Self {
        Self { config, operators, state: AdderState::default() }
    }

    /// An addition, and a register.
    fn latency(&self) -> u64 {
        u64::from(self.config.latency) + u64::from(self.operators.add.latency)
    }

    #[inline]
    fn sum(&mut self, dot: Dot, highlight: Highlight, traffic: &mut Traffic) -> Dot {
        if (dot.x, dot.y) != (highlight.x, highlight.y) {
            traffic.fault(format!(
                "adder (52): circuit (21) is at dot {}, {} and circuit (50) at {}, {}; they run in lock step",
                dot.x, dot.y, highlight.x, highlight.y
            ));
        }
        self.state.counters.sums += 1;
        Dot { brightness: dot.brightness.map(|b| b + highlight.brightness), ..dot }
    }
}

impl Unit for Adder {
    basrelief_kernel::role!("adds the specular term");
    type In = (Option<FigureFlow>, Option<Highlights>);
    type Out = Option<FigureFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.joins { Demand::All } else { Demand::Only(0) }
    }

    #[inline]
    fn step(&mut self, (signal, highlight): Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let mut cycles = 1;
        let out = match (signal, highlight) {
            (Some(FigureFlow::Dot(dot)), highlight) => {
                cycles = u64::from(self.config.initiation_interval);
                match highlight {
                    None => Some(FigureFlow::Dot(dot)),
                    Some(Highlights::Dot(highlight)) => Some(FigureFlow::Dot(self.sum(dot, highlight, traffic))),
                    Some(_) => {
                        traffic.fault("adder (52): circuit (50) has fewer dots than circuit (21)".into());
                        None
                    }
                }
            }
            (Some(FigureFlow::Figure(figure)), _) => {
                self.state.joins = figure.registers.selection() == Selection::LinearAndSpecular;
                Some(FigureFlow::Figure(figure))
            }
            (Some(FigureFlow::End), Some(Highlights::Dot(_))) => {
                traffic.fault("adder (52): circuit (50) has more dots than circuit (21)".into());
                None
            }
            (other, _) => {
                self.state.joins = false;
                other
            }
        };
        Step::after(self.latency(), out).busy(cycles)
    }

    fn is_empty(&self) -> bool {
        !self.state.joins
    }

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, self.latency(), self.config.initiation_interval);
        let adders = needed(3, self.operators.add.interval, self.config.initiation_interval);
        facts.hardware(HardwareKind::Adder, "sum of red, green and blue", adders, NUMBER);
        facts.figure("adder_sums", self.state.counters.sums, "dots", "Dots to which a highlight was added");
    }
}
