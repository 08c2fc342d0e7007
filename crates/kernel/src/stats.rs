//! Statistics of units: their counters, their rates, and their hardware.

use crate::hardware::{Hardware, HardwareKind, OperandWidth};
use crate::{FifoInfo, OperatorCounts};

/// Statistics of the units of a machine, reported by [`Unit::report_stats`](crate::Unit::report_stats) in the order of the
/// wiring. See [`unit_stats`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitStats {
    figures: Vec<UnitFigure>,
    /// Rates of the reporting unit.
    rates: Vec<OutputRate>,
    slow_fifos: Vec<SlowFifo>,
    hardware: Vec<Hardware>,
    /// Name of the reporting unit.
    place: String,
}

/// One figure of the report.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitFigure {
    /// Its name in the report.
    pub name: String,
    /// Its value.
    pub value: FigureValue,
    /// Unit of measure, in the plural; empty for a ratio.
    pub unit: &'static str,
    /// Description, as a sentence without a full stop.
    pub about: &'static str,
    /// Group of related figures.
    pub part: FigureGroup,
}

/// Value of a figure.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FigureValue {
    /// A count.
    Count(u64),
    /// A real number.
    Real(f64),
    /// A list of counts.
    Counts(Vec<u64>),
    /// A list of real numbers.
    Reals(Vec<f64>),
}

/// Group of a figure: figures of one group are shown together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum FigureGroup {
    /// No group.
    #[default]
    Alone,
    /// The work of the machine: cycles and bytes are divided by it.
    Work,
    /// Counts of the route of this name through the machine, in this and other units of measure.
    Route(String),
    /// Cycles of the circuit of this name in which it was started.
    Started(String),
    /// Cycles of the circuit of this name whose results were needed.
    Needed(String),
    /// Counts of the process of this name: runs or cycles.
    Process(String),
    /// A column of a table, a value per row.
    Column {
        /// Name of the table.
        table: &'static str,
        /// Title of the column.
        title: &'static str,
    },
}

impl From<u64> for FigureValue {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for FigureValue {
    fn from(real: f64) -> Self {
        Self::Real(real)
    }
}

impl From<Vec<u64>> for FigureValue {
    fn from(counts: Vec<u64>) -> Self {
        Self::Counts(counts)
    }
}

impl From<Vec<f64>> for FigureValue {
    fn from(reals: Vec<f64>) -> Self {
        Self::Reals(reals)
    }
}

/// The rate at which a unit fills an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct OutputRate {
    output: usize,
    latency: u64,
    interval: u64,
}

/// A FIFO with fewer slots than the rate of its producer needs (law 2). Memory latency is extra and is not considered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SlowFifo {
    /// Its name.
    pub name: String,
    /// Its slots.
    pub depth: u64,
    /// Slots that full throughput needs.
    pub needed: u64,
    /// Cycles from the start of the unit's step to delivery.
    pub unit_latency: u64,
    /// Cycles from delivery to visibility.
    pub fifo_latency: u64,
}

impl SlowFifo {
    /// Cycles for which a token holds its slot.
    pub fn slot_cycles(&self) -> u64 {
        self.unit_latency + self.fifo_latency + 1
    }

    fn of(link: &FifoInfo, rate: OutputRate) -> Option<Self> {
        let (depth, unit_latency, fifo_latency) = (link.depth() as u64, rate.latency, link.latency());
        let mut slow = Self { name: link.name().into(), depth, needed: 0, unit_latency, fifo_latency };
        slow.needed = slow.slot_cycles().div_ceil(rate.interval.max(1));
        (depth < slow.needed).then_some(slow)
    }
}

/// Operators of one kind that compute their results over several cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IterativeOperators {
    /// Number of operators.
    pub count: u32,
    /// Number of operations of a piece of work that take turns in each.
    pub turns: u32,
    /// Width of the operands \[bits\].
    pub width: u32,
    /// Bits of a result that an operator computes in a cycle.
    pub digits_per_cycle: u32,
}

impl UnitStats {
    /// Adds a figure. Counts of one name add up, for units that share the work.
    ///
    /// # Panics
    /// If two units report a figure of this name and one value is not a count.
    pub fn figure(
        &mut self,
        name: &str,
        value: impl Into<FigureValue>,
        unit: &'static str,
        about: &'static str,
    ) -> &mut UnitFigure {
        let value = value.into();
        if let Some(at) = self.figures.iter().position(|f| f.name == name) {
            match (&mut self.figures[at].value, value) {
                (FigureValue::Count(sum), FigureValue::Count(more)) => *sum += more,
                _ => panic!("figure {name} is reported twice, but only counts add up"),
            }
            return &mut self.figures[at];
        }
        let at = self.figures.len();
        self.figures.push(UnitFigure { name: name.into(), value, unit, about, part: FigureGroup::Alone });
        &mut self.figures[at]
    }

    /// Reports the rate at which the unit fills its output `output`, numbered from 0 in the wiring: `latency` cycles from the
    /// start of a step to its delivery, and at most one token per `interval` cycles.
    pub fn rate(&mut self, output: usize, latency: impl Into<u64>, interval: impl Into<u64>) {
        self.rates.push(OutputRate { output, latency: latency.into(), interval: interval.into() });
    }

    /// Reports hardware of the unit: `count` operators or words of `width` bits each. Counts and widths of 0 are skipped.
    pub fn hardware(&mut self, kind: HardwareKind, about: &'static str, count: impl Into<u64>, width: impl Into<OperandWidth>) {
        self.piece(Hardware::new(&self.place, kind, about, count.into(), width));
    }

    /// Reports iterative operators of the unit.
    pub fn iterative(&mut self, kind: HardwareKind, about: &'static str, have: IterativeOperators) {
        let IterativeOperators { count, turns, width, digits_per_cycle } = have;
        self.piece(Hardware { digits_per_cycle, turns, ..Hardware::new(&self.place, kind, about, count.into(), width) });
    }

    /// Reports a table of the unit with so many ports.
    pub fn ported_table(&mut self, about: &'static str, count: impl Into<u64>, width: u32, ports: u32) {
        self.piece(Hardware { ports, ..Hardware::new(&self.place, HardwareKind::Table, about, count.into(), width) });
    }

    /// Reports a table of the unit in `banks` banks, which are read at the same time.
    pub fn banked_table(&mut self, about: &'static str, count: impl Into<u64>, width: u32, banks: u32) {
        self.piece(Hardware { banks, ..Hardware::new(&self.place, HardwareKind::Table, about, count.into(), width) });
    }

    /// Reports a table of `bits` flags, of which `per_cycle` are set in a cycle. Look-ups follow each other in every cycle, and each may
    /// change its flag, so there is a port for reading and one for writing.
    pub fn flags(&mut self, about: &'static str, bits: u32, per_cycle: u32) {
        let table = self.flag_table(about, bits, per_cycle);
        self.piece(table);
    }

    /// Reports the same table with a circuit that examines `per_cycle` flags in a cycle and finds the first that is set.
    pub fn searched_flags(&mut self, about: &'static str, bits: u32, per_cycle: u32) {
        let table = self.flag_table(about, bits, per_cycle);
        self.piece(Hardware { finds_first: true, ..table });
    }

    fn flag_table(&self, about: &'static str, bits: u32, per_cycle: u32) -> Hardware {
        let (words, width) = (bits.div_ceil(per_cycle.max(1)), per_cycle.min(bits));
        Hardware { ports: 2, entries: width, ..Hardware::new(&self.place, HardwareKind::Table, about, words.into(), width) }
    }

    /// Reports a list of `count` entries of `bits` bits in words of `per_cycle` entries. A circuit examines a word in a cycle and finds the
    /// first entry that is set.
    pub fn searched_list(&mut self, about: &'static str, count: u64, [bits, per_cycle]: [u32; 2], ports: u32) {
        let words = count.div_ceil(per_cycle.max(1).into());
        let table = Hardware::new(&self.place, HardwareKind::Table, about, words, bits.saturating_mul(per_cycle));
        self.piece(Hardware { ports, entries: per_cycle, finds_first: true, ..table });
    }

    /// Reports a directory of `count` entries that is searched by a key, with their order of use. A key has fields of these widths, and an
    /// entry has `content` more bits. All entries are searched at once, so each compares its own key. A hit also moves the entries that
    /// were used later, so each compares its position and counts up. The place that an entry describes is its number.
    pub fn directory(&mut self, about: &'static str, count: u32, key: &[u32], content: u32) {
        let position = count.max(1).next_power_of_two().trailing_zeros();
        for &field in key {
            self.hardware(HardwareKind::Adder, "key of an entry", count, OperandWidth::from(field).of_integers());
        }
        let position_width = OperandWidth::from(position).of_integers();
        self.hardware(HardwareKind::Adder, "order of use of the entries", 2 * count, position_width);
        self.hardware(HardwareKind::Registers, about, count, key.iter().sum::<u32>() + content + position);
    }

    /// Reports a buffer of `count` lines that gather writes: `content` bits and the number of the line in each. A write searches all lines
    /// at once, so each line compares its number (assumed: as fully associative write buffers of the time).
    pub fn gathered_lines(&mut self, count: u32, content: u32, number: u32) {
        self.hardware(HardwareKind::Table, "gathered lines", count, content + number);
        self.hardware(HardwareKind::Adder, "whether a line is gathered", count, number);
    }

    fn piece(&mut self, piece: Hardware) {
        if piece.count > 0 && piece.width > 0 {
            self.hardware.push(piece);
        }
    }

    /// Reports the operators of a unit, of all kinds. Each has its operands to itself.
    pub fn operators(&mut self, about: &'static str, have: OperatorCounts, width: impl Into<OperandWidth>) {
        self.shared_operators(about, have, have, width);
    }

    /// Reports operators of a unit, of all kinds, in which the operations of a piece of `work` take turns. So each has a multiplexer in front
    /// of either operand.
    pub fn shared_operators(
        &mut self,
        about: &'static str,
        have: OperatorCounts,
        work: OperatorCounts,
        width: impl Into<OperandWidth>,
    ) {
        let width = width.into();
        let whole = width.of_integers();
        for (kind, count, operations, width) in [
            (HardwareKind::Multiplier, have.multiply, work.multiply, width),
            (HardwareKind::Adder, have.add, work.add, width),
            (HardwareKind::Divider, have.divide, work.divide, width),
            (HardwareKind::SquareRoot, have.square_root, work.square_root, width),
            (HardwareKind::Power, have.power, work.power, width),
            (HardwareKind::Multiplier, have.integer_multiply, work.integer_multiply, whole),
            (HardwareKind::Adder, have.integer_add, work.integer_add, whole),
        ] {
            let turns = operations.div_ceil(count.max(1)).max(1);
            self.piece(Hardware { turns, ..Hardware::new(&self.place, kind, about, count.into(), width) });
        }
    }

    /// All hardware: units in the order of the wiring, each followed by the FIFOs that it fills; then caches and ports.
    pub fn all_hardware(&self) -> &[Hardware] {
        &self.hardware
    }

    /// Hardware of units. The work of the units depends on it, and not on FIFOs or caches.
    pub fn hardware_of_units(&self) -> impl Iterator<Item = &Hardware> {
        self.hardware.iter().filter(|piece| !piece.kind.is_outside_units())
    }

    /// All figures, in order.
    pub fn figures(&self) -> impl Iterator<Item = &UnitFigure> {
        self.figures.iter()
    }

    /// Returns the value of the figure of this name.
    pub fn get(&self, name: &str) -> Option<&FigureValue> {
        self.figures.iter().find(|f| f.name == name).map(|f| &f.value)
    }

    /// Replaces the values of figures with these names.
    pub fn put(&mut self, values: &[(String, FigureValue)]) {
        for figure in &mut self.figures {
            if let Some((_, value)) = values.iter().find(|(name, _)| *name == figure.name) {
                figure.value = value.clone();
            }
        }
    }

    /// Returns a count; 0 if there is none of this name.
    pub fn count(&self, name: &str) -> u64 {
        if let Some(FigureValue::Count(count)) = self.get(name) { *count } else { 0 }
    }

    /// FIFOs that cannot sustain the rate of their producer, in the order of the wiring.
    pub fn slow_fifos(&self) -> &[SlowFifo] {
        &self.slow_fifos
    }
}

impl UnitFigure {
    /// Sets the group.
    pub fn part(&mut self, part: FigureGroup) {
        self.part = part;
    }
}

mod gather;

pub use gather::unit_stats;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_one_name_add_up() {
        let mut stats = UnitStats::default();
        stats.figure("items", 2, "items", "taken early");
        stats.figure("items", 3, "items", "taken late");
        assert_eq!((stats.count("items"), stats.figures().count()), (5, 1));
    }

    #[test]
    #[should_panic(expected = "reported twice")]
    fn other_figures_of_one_name_panic() {
        let mut stats = UnitStats::default();
        stats.figure("mean", 0.5, "", "of one unit");
        stats.figure("mean", 0.5, "", "of another");
    }

    #[test]
    fn fifo_below_rate_of_producer_is_slow() {
        let slow = |depth, interval| SlowFifo::of(&FifoInfo::new("f", depth, 2), OutputRate { output: 0, latency: 5, interval });
        assert_eq!(slow(7, 1).map(|s| (s.needed, s.slot_cycles())), Some((8, 8)));
        assert!(slow(8, 1).is_none() && slow(3, 3).is_none());
        assert_eq!(slow(2, 3).map(|s| s.needed), Some(3));
    }
}
