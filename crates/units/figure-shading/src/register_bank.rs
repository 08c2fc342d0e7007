//! Registers (14), (16) and (18) as hardware: written by the microcomputer (10), read by the units that they control.

use crate::{FigureFlow, RegisterOrder, RegisterWrite, ShadingRegisters};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Counters of the registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegisterBankCounters {
    /// Writes of the mode register (14).
    pub mode_writes: u64,
    /// Writes of the flatness register (16).
    pub flat_writes: u64,
    /// Writes of the specular register (18).
    pub specular_writes: u64,
}

/// State of the registers between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegisterBankState {
    /// Current values.
    pub registers: ShadingRegisters,
    /// Counters.
    pub counters: RegisterBankCounters,
}

/// Mode register (14), flatness register (16), specular register (18). Each write occupies them for a cycle and appears as a step
/// in the timeline. A polygon that passes from the microcomputer (10) to circuit (21) takes their values along, in band. With two
/// polygon buffers the registers may already hold the values of the next polygon while its dots are drawn.
#[derive(Clone, Debug, Default)]
pub struct RegisterBank {
    /// State between steps.
    pub state: RegisterBankState,
}

impl RegisterBank {
    fn write(&mut self, write: RegisterWrite) {
        let RegisterBankState { registers, counters } = &mut self.state;
        registers.write(write);
        *match write {
            RegisterWrite::Mode(_) => &mut counters.mode_writes,
            RegisterWrite::Flat(_) => &mut counters.flat_writes,
            RegisterWrite::Specular(_) => &mut counters.specular_writes,
        } += 1;
    }
}

impl Unit for RegisterBank {
    basrelief_kernel::unit_info!("mode, flatness and specular register: set by the microcomputer");
    type In = Option<RegisterOrder>;
    type Out = Option<FigureFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let out = match input {
            Some(RegisterOrder::Write(write)) => {
                self.write(write);
                None
            }
            Some(RegisterOrder::Pass(FigureFlow::Figure(mut figure))) => {
                // The microcomputer still holds a polygon that process 24 draws. This then copies the data beside its points.
                Arc::make_mut(&mut figure).registers = self.state.registers;
                Some(FigureFlow::Figure(figure))
            }
            Some(RegisterOrder::Pass(signal)) => Some(signal),
            None => None,
        };
        Step::after(1, out)
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, 1_u64, 1_u64);
        stats.hardware(HardwareKind::Registers, "mode register (14)", 1_u64, 2);
        stats.hardware(HardwareKind::Registers, "flatness register (16)", 1_u64, 1);
        stats.hardware(HardwareKind::Registers, "specular register (18)", 1_u64, 1);
        let c = &self.state.counters;
        stats.figure("register_14_writes", c.mode_writes, "writes", "Writes of the mode register (14)");
        stats.figure("register_16_writes", c.flat_writes, "writes", "Writes of the flatness register (16)");
        stats.figure("register_18_writes", c.specular_writes, "writes", "Writes of the specular register (18)");
    }
}
