//! Operands of the CPU (11) in memory (12). The CPU waits for each of them, and then works.

use super::Microcomputer;
use super::operand_access::{NumberRange, WaitingWork};
use super::outputs::{Out, nothing};
use crate::cpu::CpuOperations;
use basrelief_kernel::{MemoryPorts, Step};

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
