//! What units tell of themselves: what they counted, and how fast they are.

use crate::hardware::{Hardware, HardwareKind};
use crate::{FifoInfo, OperatorCounts};

/// What the units of a machine tell, each in [`Unit::tell`], in the order of the wiring. See [`facts`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitStats {
    figures: Vec<Figure>,
    /// Of the unit that is telling.
    rates: Vec<Rate>,
    slow_fifos: Vec<SlowFifo>,
    hardware: Vec<Hardware>,
    /// Of the unit that is telling: its name.
    place: String,
}

/// One figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its name in the report.
    pub name: String,
    /// How many, or how much.
    pub value: FigureValue,
    /// Unit of measure, in the plural; empty for a ratio.
    pub unit: &'static str,
    /// What it is, in a sentence without its full stop.
    pub about: &'static str,
    /// What it is a part of.
    pub part: FigureGroup,
}

/// How many, or how much.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FigureValue {
    /// How many.
    Count(u64),
    /// How much.
    Real(f64),
    /// How many, one after the other.
    Counts(Vec<u64>),
    /// How much, one after the other.
    Reals(Vec<f64>),
}

/// What a figure is a part of: what is to be told side by side.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum FigureGroup {
    /// Of nothing.
    #[default]
    Alone,
    /// It is the work of the machine: cycles and bytes are divided by it.
    Work,
    /// Of what is counted on the route of this name through the machine, in this and other units of measure.
    Route(String),
    /// Of the cycles of the circuit of this name: those in which it was started.
    Started(String),
    /// Of the cycles of the circuit of this name: those whose results were needed.
    Needed(String),
    /// Of what is counted of the process of this name: runs, or cycles.
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

/// How fast a unit fills an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rate {
    output: usize,
    latency: u64,
    interval: u64,
}

/// A FIFO that has not the slots for the rate of the unit that fills it (law 2). Memory latency comes on top and is not looked
/// at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SlowFifo {
    /// Its name.
    pub name: String,
    /// Its slots.
    pub depth: u64,
    /// The slots that full rate needs.
    pub needed: u64,
    /// Cycles from the start of the unit's step to delivery.
    pub unit_latency: u64,
    /// Cycles from delivery to visibility.
    pub fifo_latency: u64,
}

impl SlowFifo {
    /// Cycles for which a token holds its slot.
    pub fn held(&self) -> u64 {
        self.unit_latency + self.fifo_latency + 1
    }

    fn of(link: &FifoInfo, rate: Rate) -> Option<Self> {
        let (depth, unit_latency, fifo_latency) = (link.depth() as u64, rate.latency, link.latency());
        let mut slow = Self { name: link.name().into(), depth, needed: 0, unit_latency, fifo_latency };
        slow.needed = slow.held().div_ceil(rate.interval.max(1));
        (depth < slow.needed).then_some(slow)
    }
}

impl UnitStats {
    /// Tells a figure. Counts of one name add up, as those of two units that share the work.
    ///
    /// # Panics
    /// If two units tell a figure of this name, and one of them no count.
    pub fn figure(&mut self, name: &str, value: impl Into<FigureValue>, unit: &'static str, about: &'static str) -> &mut Figure {
        let value = value.into();
        if let Some(at) = self.figures.iter().position(|f| f.name == name) {
            match (&mut self.figures[at].value, value) {
                (FigureValue::Count(sum), FigureValue::Count(more)) => *sum += more,
                _ => panic!("figure {name} is told twice, and is no count"),
            }
            return &mut self.figures[at];
        }
        let at = self.figures.len();
        self.figures.push(Figure { name: name.into(), value, unit, about, part: FigureGroup::Alone });
        &mut self.figures[at]
    }

    /// Tells how fast the unit fills its output `output`, numbered from 0 in the wiring: `latency` cycles from the start of a
    /// step to its delivery, and a token every `interval` cycles at most.
    pub fn rate(&mut self, output: usize, latency: impl Into<u64>, interval: impl Into<u64>) {
        self.rates.push(Rate { output, latency: latency.into(), interval: interval.into() });
    }

    /// Tells what the unit is built of: `count` pieces of a kind, or words, each of `width` bits. What there is none of is not told.
    pub fn hardware(&mut self, kind: HardwareKind, about: &'static str, count: impl Into<u64>, width: u32) {
        let (place, count) = (self.place.clone(), count.into());
        if count > 0 && width > 0 {
            self.hardware.push(Hardware { place, kind, about, count, width });
        }
    }

    /// Tells operators of a unit, all kinds, `width` bits each.
    pub fn operators(&mut self, about: &'static str, have: OperatorCounts, width: u32) {
        let OperatorCounts { multiply, add, divide, square_root, power } = have;
        let kinds =
            [HardwareKind::Multiplier, HardwareKind::Adder, HardwareKind::Divider, HardwareKind::SquareRoot, HardwareKind::Power];
        for (kind, count) in kinds.into_iter().zip([multiply, add, divide, square_root, power]) {
            self.hardware(kind, about, count, width);
        }
    }

    /// All hardware: of units in the order of the wiring, each before the FIFOs that it fills; then caches.
    pub fn all_hardware(&self) -> &[Hardware] {
        &self.hardware
    }

    /// Hardware of units: what they do follows from it, and from nothing that FIFOs and caches have.
    pub fn hardware_of_units(&self) -> impl Iterator<Item = &Hardware> {
        self.hardware.iter().filter(|h| !matches!(h.kind, HardwareKind::Fifo | HardwareKind::CacheData | HardwareKind::CacheTags))
    }

    /// All figures, in order.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.figures.iter()
    }

    /// The figure of this name.
    pub fn get(&self, name: &str) -> Option<&FigureValue> {
        self.figures.iter().find(|f| f.name == name).map(|f| &f.value)
    }

    /// Puts values in the place of those of the same names; the others stay.
    pub fn put(&mut self, values: &[(String, FigureValue)]) {
        for figure in &mut self.figures {
            if let Some((_, value)) = values.iter().find(|(name, _)| *name == figure.name) {
                figure.value = value.clone();
            }
        }
    }

    /// A count; 0 where there is none of this name.
    pub fn count(&self, name: &str) -> u64 {
        if let Some(FigureValue::Count(count)) = self.get(name) { *count } else { 0 }
    }

    /// FIFOs that cannot hold the rate of the unit that fills them, in the order of the wiring.
    pub fn slow_fifos(&self) -> &[SlowFifo] {
        &self.slow_fifos
    }
}

impl Figure {
    /// Makes it a part.
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
        let mut facts = UnitStats::default();
        facts.figure("items", 2, "items", "taken early");
        facts.figure("items", 3, "items", "taken late");
        assert_eq!((facts.count("items"), facts.figures().count()), (5, 1));
    }

    #[test]
    #[should_panic(expected = "told twice")]
    fn other_figures_of_one_name_do_not() {
        let mut facts = UnitStats::default();
        facts.figure("mean", 0.5, "", "of one unit");
        facts.figure("mean", 0.5, "", "of another");
    }

    #[test]
    fn a_fifo_is_slow_below_latencies_and_one_per_interval() {
        let slow = |depth, interval| SlowFifo::of(&FifoInfo::new("f", depth, 2), Rate { output: 0, latency: 5, interval });
        assert_eq!(slow(7, 1).map(|s| (s.needed, s.held())), Some((8, 8)));
        assert!(slow(8, 1).is_none() && slow(3, 3).is_none());
        assert_eq!(slow(2, 3).map(|s| s.needed), Some(3));
    }
}
