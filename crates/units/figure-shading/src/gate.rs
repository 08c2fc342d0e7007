//! Gate (51).

use crate::{CircuitConfig, SpecularFlow};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use serde::{Deserialize, Serialize};

/// Counters of the gate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GateCounters {
    /// Dots that passed.
    pub passed: u64,
    /// Dots that were blocked.
    pub blocked: u64,
}

/// State of the gate between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GateState {
    /// Specular register (18).
    pub open: bool,
    /// Counters.
    pub counters: GateCounters,
}

/// Gate (51): passes the output of circuit (50) to the adder (52), or blocks it, as the specular register (18) selects.
#[derive(Clone, Debug, Default)]
pub struct Gate {
    /// Parameters.
    pub config: CircuitConfig,
    /// State between steps.
    pub state: GateState,
}

impl Gate {
    /// Creates a gate in its power-on state.
    pub fn new(config: CircuitConfig) -> Self {
        Self { config, state: GateState::default() }
    }
}

impl Unit for Gate {
    basrelief_kernel::unit_info!("blocks the specular term if it is negligible");
    type In = Option<SpecularFlow>;
    type Out = Option<SpecularFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let state = &mut self.state;
        let (out, cycles) = match input {
            Some(SpecularFlow::Start { open }) => {
                state.open = open;
                (None, 1)
            }
            Some(SpecularFlow::Dot(dot)) => {
                *if state.open { &mut state.counters.passed } else { &mut state.counters.blocked } += 1;
                (state.open.then_some(SpecularFlow::Dot(dot)), u64::from(self.config.initiation_interval))
            }
            end => (end.filter(|_| state.open), 1),
        };
        Step::after(u64::from(self.config.latency), out).busy(cycles)
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.config.latency, self.config.initiation_interval);
        stats.hardware(HardwareKind::Registers, "specular register (18) as of the polygon that passes", 1_u64, 1);
        let c = &self.state.counters;
        stats.figure("gate_passed", c.passed, "dots", "Highlights that the gate let pass");
        stats.figure("gate_blocked", c.blocked, "dots", "Highlights that it held back");
    }
}
