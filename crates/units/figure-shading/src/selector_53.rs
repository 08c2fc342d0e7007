//! Selector (53).

use crate::{BrightnessSelection, CircuitConfig, FigureFlow};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use serde::{Deserialize, Serialize};

/// State of selector (53) between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Selector53State {
    /// Flatness register (16) in normal-interpolation mode. True if the dots come from process 24.
    pub flat: bool,
}

/// Selector (53): passes the output of the adder (52) (input 0) or of process 24 (input 1), as the flatness register (16)
/// selects. Control comes from the adder.
#[derive(Clone, Debug, Default)]
pub struct Selector53 {
    /// Parameters.
    pub config: CircuitConfig,
    /// State between steps.
    pub state: Selector53State,
}

impl Selector53 {
    /// Creates a selector in its power-on state.
    pub fn new(config: CircuitConfig) -> Self {
        Self { config, state: Selector53State::default() }
    }
}

impl Unit for Selector53 {
    basrelief_kernel::unit_info!("flat or not: process 24 or the adder");
    type In = (Option<FigureFlow>, Option<FigureFlow>);
    type Out = Option<FigureFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::Only(usize::from(self.state.flat))
    }

    #[inline]
    fn step(&mut self, (sum, mean): Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let mut cycles = 1;
        let out = sum.or(mean);
        match &out {
            Some(FigureFlow::Dot(_)) => cycles = u64::from(self.config.initiation_interval),
            Some(FigureFlow::Figure(figure)) => {
                let registers = figure.registers;
                self.state.flat = registers.mean_goes_to_53() && registers.selection() == BrightnessSelection::Mean;
            }
            // After an end token from either input, the next tokens come from the adder.
            Some(FigureFlow::End) => self.state.flat = false,
            Some(FigureFlow::Frame(_) | FigureFlow::FrameEnd) | None => {}
        }
        Step::after(u64::from(self.config.latency), out).busy(cycles)
    }

    fn is_empty(&self) -> bool {
        !self.state.flat
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.config.latency, self.config.initiation_interval);
        stats.hardware(HardwareKind::Registers, "flatness register (16) as of the polygon that passes", 1_u64, 1);
    }
}
