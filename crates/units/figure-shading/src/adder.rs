//! Adder (52).

use crate::{BrightnessSelection, CircuitConfig, FigureFlow, ShadedDot, SpecularDot, SpecularFlow};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, OperatorCounts, Operators, Step, Unit, UnitTable};
use serde::{Deserialize, Serialize};

/// Counters of the adder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AdderCounters {
    /// Dots to which a specular term was added.
    pub sums: u64,
}

/// State of the adder between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AdderState {
    /// True if the polygon's dots come from both circuits.
    pub joins: bool,
    /// Counters.
    pub counters: AdderCounters,
}

/// Adder (52): adds the output of circuit (21) (input 0) and the output of circuit (50) that passes gate (51) (input 1).
///
/// Both circuits scan the same dots in the same order. They may deliver at different times, and the adder waits for the later
/// one. Different screen addresses are a fault. Nothing is saturated here or earlier.
#[derive(Clone, Debug, Default)]
pub struct Adder {
    /// Parameters.
    pub config: CircuitConfig,
    operators: Operators,
    /// State between steps.
    pub state: AdderState,
}

impl Adder {
    /// Creates an adder in its power-on state.
    pub fn new(config: CircuitConfig, operators: Operators) -> Self {
        Self { config, operators, state: AdderState::default() }
    }

    /// Returns the latency of an addition and a register.
    fn latency(&self) -> u64 {
        u64::from(self.config.latency) + u64::from(self.operators.add.latency)
    }

    #[inline]
    fn sum(&mut self, dot: ShadedDot, highlight: SpecularDot, traffic: &mut MemoryPorts) -> ShadedDot {
        if (dot.x, dot.y) != (highlight.x, highlight.y) {
            traffic.fault(format!(
                "adder (52): circuit (21) is at dot {}, {} and circuit (50) at {}, {}; they run in lock step",
                dot.x, dot.y, highlight.x, highlight.y
            ));
        }
        self.state.counters.sums += 1;
        ShadedDot { brightness: dot.brightness.map(|b| b + highlight.brightness), ..dot }
    }
}

impl Unit for Adder {
    basrelief_kernel::unit_info!("adds the specular term");
    type In = (Option<FigureFlow>, Option<SpecularFlow>);
    type Out = Option<FigureFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.joins { Demand::All } else { Demand::Only(0) }
    }

    #[inline]
    fn step(&mut self, (signal, highlight): Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let mut cycles = 1;
        let out = match (signal, highlight) {
            (Some(FigureFlow::Dot(dot)), highlight) => {
                cycles = u64::from(self.config.initiation_interval);
                match highlight {
                    None => Some(FigureFlow::Dot(dot)),
                    Some(SpecularFlow::Dot(highlight)) => Some(FigureFlow::Dot(self.sum(dot, highlight, traffic))),
                    Some(_) => {
                        traffic.fault("adder (52): circuit (50) has fewer dots than circuit (21)".into());
                        None
                    }
                }
            }
            (Some(FigureFlow::Figure(figure)), _) => {
                self.state.joins = figure.registers.selection() == BrightnessSelection::LinearAndSpecular;
                Some(FigureFlow::Figure(figure))
            }
            (Some(FigureFlow::End), Some(SpecularFlow::Dot(_))) => {
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

    fn twin_tables(&self) -> Vec<UnitTable> {
        vec![UnitTable::number("latency", self.latency())]
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.latency(), self.config.initiation_interval);
        let sums = OperatorCounts { add: 3, ..OperatorCounts::NONE };
        let adders = self.operators.sustaining(sums, self.config.initiation_interval).add;
        stats.hardware(HardwareKind::Adder, "sum of red, green and blue", adders, OperandWidth::SINGLE);
        stats.figure("adder_sums", self.state.counters.sums, "dots", "Dots to which a highlight was added");
    }
}
