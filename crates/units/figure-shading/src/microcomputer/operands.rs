//! Operands of the CPU (11) in memory (12). The CPU waits for each of them, and then works.

use super::Microcomputer;
use super::outputs::{Out, nothing};
use crate::cpu::CpuOperations;
use crate::{NormalLoad, RegisterOrder};
use basrelief_kernel::{MemoryPorts, Step};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Numbers that lie together in memory (12): address of the first, and their count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct NumberRange {
    from: u64,
    numbers: u64,
}

/// Work that begins when its operands have arrived: its cycles, and its outputs to the registers and to circuit (50).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WaitingWork {
    cycles: u64,
    order: Option<RegisterOrder>,
    load: Option<Arc<NormalLoad>>,
}

/// Accesses to memory (12) of the current work.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct OperandAccess {
    fetches: VecDeque<NumberRange>,
    stores: VecDeque<NumberRange>,
    /// Cycles of the load operations that are not spent yet.
    load_cycles: u64,
    work: Option<WaitingWork>,
}

impl OperandAccess {
    /// Returns true if no work waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.work.is_none()
    }
}

impl Microcomputer {
    /// Queues a read. The current work begins with its data.
    pub(super) fn fetch(&mut self, from: u64, numbers: u64) {
        if numbers > 0 {
            self.state.operands.fetches.push_back(NumberRange { from, numbers });
        }
    }

    /// Queues a posted write of the current work.
    pub(super) fn store_numbers(&mut self, from: u64, numbers: u64) {
        if numbers > 0 {
            self.state.operands.stores.push_back(NumberRange { from, numbers });
        }
    }

    /// Counts the loads among the operations of the current work.
    pub(super) fn count_loads(&mut self, operations: CpuOperations) {
        let loads = CpuOperations { load: operations.load, ..CpuOperations::NONE };
        self.state.operands.load_cycles += self.config.cycles(loads);
    }

    /// Makes the current work wait for its operands, if it has any.
    pub(super) fn after_operands(&mut self, step: Out, traffic: &mut MemoryPorts) -> Out {
        if self.state.operands.fetches.is_empty() {
            self.state.operands.load_cycles = 0;
            return step;
        }
        let Step { out: (order, load, ..), latency: cycles, .. } = step;
        self.state.operands.work = Some(WaitingWork { cycles, order, load });
        self.fetch_next(traffic)
    }

    /// Fetches the next operand, and waits for it. After the last one the work begins.
    pub(super) fn fetch_next(&mut self, traffic: &mut MemoryPorts) -> Out {
        let operands = &mut self.state.operands;
        if let Some(NumberRange { from, numbers }) = operands.fetches.pop_front() {
            self.port.read(traffic, from, numbers);
            let loads = self.config.cycles(CpuOperations { load: numbers, ..CpuOperations::NONE });
            let cycles = loads.min(operands.load_cycles);
            operands.load_cycles -= cycles;
            operands.work.iter_mut().for_each(|work| work.cycles -= cycles.min(work.cycles));
            return nothing(cycles).blocking();
        }
        operands.load_cycles = 0;
        for NumberRange { from, numbers } in operands.stores.drain(..) {
            self.port.write(traffic, from, numbers);
        }
        let Some(WaitingWork { cycles, order, load }) = operands.work.take() else { return nothing(1) };
        Step::after(cycles, (order, load, None, None)).busy(cycles.max(1))
    }
}
