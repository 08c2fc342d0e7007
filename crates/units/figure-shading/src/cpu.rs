//! CPU (11): costs of its operations, and the operations of a process.
//!
//! A process states its [`CpuOperations`] per polygon, sample point, light or dot. The table ([`CpuConfig`]) gives their cycles. The
//! CPU does one operation after the other: nothing overlaps, and its loops never end before their last point.

use basrelief_kernel::OperatorCounts;
use basrelief_parameters::parameters;

parameters! {
    /// CPU (11) of the microcomputer (10) with its floating-point unit: cycles of each operation.
    pub struct CpuConfig {
        /// Factor of all following cycles: a slower CPU.
        scale: u32 = 1, unit: "", Assumed("the CPU as the other parameters have it. 20 is of the class of an MC68020 with an MC68881 (1984), whose additions take some 50 cycles and multiplications some 70"), range: 1..=1024;
        /// Addition or subtraction.
        add: u32 = 2, unit: "cycles", Assumed("of the class of MIPS R3000 with R3010 at 25 MHz, the fastest of 1989 (Kane, MIPS RISC Architecture, 1988): single precision, 2 cycles"), range: 0..=65_536;
        /// Multiplication.
        multiply: u32 = 4, unit: "cycles", Assumed("the same: 4 cycles"), range: 0..=65_536;
        /// Division.
        divide: u32 = 12, unit: "cycles", Assumed("the same: 12 cycles"), range: 0..=65_536;
        /// Square root.
        square_root: u32 = 50, unit: "cycles", Assumed("the R3010 has none: an estimate of 4 integer operations, three Newton steps of three products and a difference, a product"), range: 0..=65_536;
        /// Comparison and the following branch.
        compare: u32 = 3, unit: "cycles", Assumed("the same: a comparison of 2 cycles, a branch"), range: 0..=65_536;
        /// Load of a number from memory (12).
        load: u32 = 2, unit: "cycles", Assumed("the same: the load and its delay slot"), range: 0..=65_536;
        /// Store of a number to memory (12), a register or a circuit.
        store: u32 = 1, unit: "cycles", Assumed("the same, through a write buffer"), range: 0..=65_536;
        /// Integer operation, or a branch.
        integer: u32 = 1, unit: "cycles", Assumed("the same"), range: 0..=65_536;
        /// Registers for the operands of the floating-point unit, with two ports for reading and one for writing. The light of a sample
        /// point needs 16 at a time: the normal (3), Kd, Ka*Ia, Ks and the colour (6), Is, the sums of diffuse and specular light, a
        /// product and the sum of an inner product, 0 and 1. Fewer would need more loads than the operations of the CPU have.
        registers: u32 = 16, unit: "words", Assumed("the same: 16 registers"), range: 16..=1024;
    }
}

/// Number of operations of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CpuOperations {
    pub(crate) add: u64,
    pub(crate) multiply: u64,
    pub(crate) divide: u64,
    pub(crate) square_root: u64,
    pub(crate) compare: u64,
    pub(crate) load: u64,
    pub(crate) store: u64,
    pub(crate) integer: u64,
}

impl CpuOperations {
    pub(crate) const NONE: Self =
        Self { add: 0, multiply: 0, divide: 0, square_root: 0, compare: 0, load: 0, store: 0, integer: 0 };

    /// Returns the operations of this arithmetic. It has no powers, because the CPU computes a power by multiplications.
    pub(crate) const fn of(work: OperatorCounts) -> Self {
        Self {
            add: work.add as u64,
            multiply: work.multiply as u64,
            divide: work.divide as u64,
            square_root: work.square_root as u64,
            ..Self::NONE
        }
    }

    pub(crate) const fn times(self, times: u64) -> Self {
        Self {
            add: self.add * times,
            multiply: self.multiply * times,
            divide: self.divide * times,
            square_root: self.square_root * times,
            compare: self.compare * times,
            load: self.load * times,
            store: self.store * times,
            integer: self.integer * times,
        }
    }

    pub(crate) const fn and(self, other: Self) -> Self {
        Self {
            add: self.add + other.add,
            multiply: self.multiply + other.multiply,
            divide: self.divide + other.divide,
            square_root: self.square_root + other.square_root,
            compare: self.compare + other.compare,
            load: self.load + other.load,
            store: self.store + other.store,
            integer: self.integer + other.integer,
        }
    }
}

impl CpuConfig {
    /// Returns the cycles of these operations.
    pub(crate) fn cycles(&self, operations: CpuOperations) -> u64 {
        let takes = |times: u64, cycles: u32| times * u64::from(cycles);
        let sum = takes(operations.add, self.add)
            + takes(operations.multiply, self.multiply)
            + takes(operations.divide, self.divide)
            + takes(operations.square_root, self.square_root)
            + takes(operations.compare, self.compare)
            + takes(operations.load, self.load)
            + takes(operations.store, self.store)
            + takes(operations.integer, self.integer);
        sum * u64::from(self.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_parameters::Parameters;

    #[test]
    fn fewer_registers_than_light_needs_are_an_error() {
        let check = |registers| CpuConfig { registers, ..CpuConfig::default() }.check("cpu.");
        let (normal, coefficients, intensity, sums, partial, bounds) = (3, 3 + 3, 1, 2, 2, 2);
        let least = normal + coefficients + intensity + sums + partial + bounds;
        assert!(check(least).is_ok());
        let error = check(least - 1).unwrap_err().to_string();
        assert!(error.contains("cpu.registers") && error.contains("16..=1024"), "{error}");
    }

    #[test]
    fn operation_cycles_follow_table_and_scale() {
        let product = CpuOperations { load: 3, ..CpuOperations::of(OperatorCounts::INNER_PRODUCT) };
        let cpu = CpuConfig::default();
        assert_eq!(cpu.cycles(product), 3 * 2 + 3 * 4 + 2 * 2);
        assert_eq!(cpu.cycles(product.times(2).and(CpuOperations { divide: 1, ..CpuOperations::NONE })), 2 * 22 + 12);
        let every = CpuOperations { add: 1, multiply: 1, divide: 1, square_root: 1, compare: 1, load: 1, store: 1, integer: 1 };
        assert_eq!(cpu.cycles(every), 75);
        assert_eq!(CpuConfig { scale: 40, ..cpu }.cycles(every), 40 * 75);
    }
}
