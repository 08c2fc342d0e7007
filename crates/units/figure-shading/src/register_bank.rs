//! Registers (14), (16) and (18) as hardware: written by the microcomputer (10), read by what they select.

use crate::{FigureFlow, Order, RegisterWrite, Registers};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, HardwareKind, Step, Traffic, Unit};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What the registers have counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegisterBankCounters {
    /// Writes of the mode register (14).
    pub mode_writes: u64,
    /// Writes of the flatness register (16).
    pub flat_writes: u64,
    /// Writes of the specular register (18).
    pub specular_writes: u64,
}

/// Everything the registers remember.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegisterBankState {
    /// As they stand.
    pub registers: Registers,
    /// What they have counted.
    pub counters: RegisterBankCounters,
}

/// Mode register (14), flatness register (16), specular register (18): each write keeps them for a cycle and shows as a step in the time
/// line. A polygon that passes on its way from the microcomputer (10) to circuit (21) takes their values with it, in band: with
/// two polygon buffers they may stand for the next polygon while its dots are drawn.
#[derive(Clone, Debug, Default)]
pub struct RegisterBank {
    /// Everything they remember.
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
    basrelief_kernel::role!("mode, flatness and specular register: set by the microcomputer");
    type In = Option<Order>;
    type Out = Option<FigureFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut Traffic) -> Step<Self::Out> {
        let out = match input {
            Some(Order::Write(write)) => {
                self.write(write);
                None
            }
            Some(Order::Pass(FigureFlow::Figure(mut figure))) => {
                // The microcomputer keeps the polygon that process 24 draws: then this copies what stands beside its points.
                Arc::make_mut(&mut figure).registers = self.state.registers;
                Some(FigureFlow::Figure(figure))
            }
            Some(Order::Pass(signal)) => Some(signal),
            None => None,
        };
        Step::after(1, out)
    }

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, 1_u64, 1_u64);
        facts.hardware(HardwareKind::Registers, "mode register (14)", 1_u64, 2);
        facts.hardware(HardwareKind::Registers, "flatness register (16)", 1_u64, 1);
        facts.hardware(HardwareKind::Registers, "specular register (18)", 1_u64, 1);
        let c = &self.state.counters;
        facts.figure("register_14_writes", c.mode_writes, "writes", "Writes of the mode register (14)");
        facts.figure("register_16_writes", c.flat_writes, "writes", "Writes of the flatness register (16)");
        facts.figure("register_18_writes", c.specular_writes, "writes", "Writes of the specular register (18)");
    }
}
