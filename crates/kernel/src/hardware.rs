//! Hardware counts of a machine. [`AreaModel`](crate::AreaModel) gives their area.

use crate::CacheConfig;
use std::fmt;

/// Bits of an address in memory, as tags hold it.
const ADDRESS_BITS: u32 = 32;
/// Bits that a look-up takes from a line.
pub(crate) const WORD_BITS: u32 = 128;
/// Bits of a request in flight: its address, and 8 bits for its length and its place in the step.
const REQUEST_BITS: u32 = ADDRESS_BITS + 8;

/// A kind of hardware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "config", derive(schemars::JsonSchema))]
pub enum HardwareKind {
    /// Dot-product unit for vectors of three: three multipliers and two adders, which are not counted separately.
    InnerProduct,
    /// Multiplier.
    Multiplier,
    /// Adder, subtracter or comparator.
    Adder,
    /// Comparator that passes the larger of two values on, with its index.
    Comparator,
    /// Divider.
    Divider,
    /// Square-root unit.
    SquareRoot,
    /// Power unit, with any exponent.
    Power,
    /// Comparator of a tag with those of all ways of a set, with the order of use.
    TagComparator,
    /// Table or buffer in memory cells: look-up tables, gathered lines, flags.
    Table,
    /// Registers for set-up values or values kept from step to step.
    Registers,
    /// Data of a cache.
    CacheData,
    /// Tags of a cache, including the order of use.
    CacheTags,
    /// FIFO.
    Fifo,
    /// Data of requests in flight: a line or burst for each credit. Also data that wait behind the tokens of a FIFO.
    LineBuffer,
    /// Addresses of requests in flight, one for each credit.
    RequestTable,
}

impl HardwareKind {
    /// All kinds, arithmetic first.
    pub const ALL: [Self; 15] = [
        Self::InnerProduct,
        Self::Multiplier,
        Self::Adder,
        Self::Comparator,
        Self::Divider,
        Self::SquareRoot,
        Self::Power,
        Self::TagComparator,
        Self::Table,
        Self::Registers,
        Self::CacheData,
        Self::CacheTags,
        Self::Fifo,
        Self::LineBuffer,
        Self::RequestTable,
    ];

    /// Returns true for operators and false for storage.
    pub fn computes(self) -> bool {
        self < Self::Table
    }

    /// Returns true for FIFOs, caches and ports, on which the work of the units does not depend.
    pub fn is_outside_units(self) -> bool {
        matches!(
            self,
            Self::TagComparator | Self::CacheData | Self::CacheTags | Self::Fifo | Self::LineBuffer | Self::RequestTable
        )
    }

    /// Name, in the plural for countable kinds.
    pub fn name(self) -> &'static str {
        match self {
            Self::InnerProduct => "dot-product units",
            Self::Multiplier => "multipliers",
            Self::Adder => "adders",
            Self::Comparator => "comparators",
            Self::Divider => "dividers",
            Self::SquareRoot => "square-root units",
            Self::Power => "power units",
            Self::TagComparator => "tag comparators",
            Self::Table => "tables",
            Self::Registers => "registers",
            Self::CacheData => "cache data",
            Self::CacheTags => "cache tags",
            Self::Fifo => "FIFOs",
            Self::LineBuffer => "line buffers",
            Self::RequestTable => "request tables",
        }
    }
}

impl fmt::Display for HardwareKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Number format of an operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "config", derive(schemars::JsonSchema))]
pub enum OperandFormat {
    /// Fixed point, or integer.
    #[default]
    Fixed,
    /// Floating point, single precision.
    Single,
}

impl OperandFormat {
    /// Bits of the mantissa of a floating-point number, with its hidden one.
    pub(crate) const MANTISSA: u32 = 24;
}

/// Width of a word, or widths and number format of the operands of an operator. A number is the width of both fixed-point
/// operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OperandWidth {
    width: u32,
    by: u32,
    format: OperandFormat,
    integer: bool,
}

impl OperandWidth {
    /// Two floating-point operands of single precision.
    pub const SINGLE: Self = Self { width: 32, by: 32, format: OperandFormat::Single, integer: false };

    /// A fixed-point operand of `width` bits and one of `by` bits.
    pub const fn fixed(width: u32, by: u32) -> Self {
        Self { width, by, format: OperandFormat::Fixed, integer: false }
    }

    /// The same operands of operators with the latencies of [integers](crate::Operators::integer_add).
    #[must_use]
    pub const fn of_integers(self) -> Self {
        Self { integer: true, ..self }
    }
}

impl From<u32> for OperandWidth {
    fn from(width: u32) -> Self {
        Self::fixed(width, width)
    }
}

/// Identical pieces of hardware.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hardware {
    /// Name of the unit, FIFO, cache or port.
    pub place: String,
    /// Its kind.
    pub kind: HardwareKind,
    /// Purpose, in a few words.
    pub about: &'static str,
    /// Number of operators or words.
    pub count: u64,
    /// Width of each word, or of the first operand \[bits\].
    pub width: u32,
    /// Width of the second operand \[bits\]; the number of ways for tag comparators.
    pub by: u32,
    /// Number format of operators.
    pub format: OperandFormat,
    /// True if the operator has the latency and the interval of integers.
    pub integer: bool,
    /// Operations of a piece of work that take turns in each operator; 1 if it has its operands to itself.
    pub turns: u32,
    /// Bits of the result that an iterative operator computes per cycle; 0 if the operator table decides.
    pub digits_per_cycle: u32,
    /// Banks that are accessed at the same time, with equal shares of the words.
    pub banks: u32,
    /// Ports of each bank.
    pub ports: u32,
    /// Registers of the width that a token passes besides its slot.
    pub stages: u32,
    /// Entries of a word, such as flags. The word is read as a whole, and each port chooses an entry. 0 if words have no entries.
    pub entries: u32,
    /// True if a circuit finds the first entry of a word that is set.
    pub finds_first: bool,
}

impl Hardware {
    /// Pieces with one port and one bank.
    pub fn new(place: &str, kind: HardwareKind, about: &'static str, count: u64, width: impl Into<OperandWidth>) -> Self {
        let OperandWidth { width, by, format, integer } = width.into();
        let place = place.into();
        Self {
            place,
            kind,
            about,
            count,
            width,
            by,
            format,
            integer,
            turns: 1,
            digits_per_cycle: 0,
            banks: 1,
            ports: 1,
            stages: 0,
            entries: 0,
            finds_first: false,
        }
    }

    /// Bits of storage; 0 for operators.
    pub fn bits(&self) -> u64 {
        if self.kind.computes() { 0 } else { self.count.saturating_mul(u64::from(self.width)) }
    }

    /// Bits that all banks read in one cycle through one port of each; 0 for operators.
    pub fn port_bits(&self) -> u64 {
        if self.kind.computes() { 0 } else { u64::from(self.banks) * u64::from(self.width) }
    }

    /// FIFO of `depth` slots. A token passes one register for each cycle of latency after the first.
    pub(crate) fn of_fifo(name: &str, depth: u64, width: u32, latency: u64) -> Self {
        let stages = u32::try_from(latency.saturating_sub(1)).unwrap_or(u32::MAX);
        Self { ports: 2, stages, ..Self::new(name, HardwareKind::Fifo, "slots", depth, width) }
    }

    /// Data and tags of a cache, with a port per look-up. A tag has the remaining bits of a 32-bit address, a valid bit, and the
    /// place of the line in the order of use.
    pub(crate) fn of_cache(name: &str, config: &CacheConfig) -> [Self; 3] {
        let CacheConfig { line_bytes, sets, ways, lookups_per_cycle: ports, .. } = *config;
        let lines = u64::from(sets) * u64::from(ways);
        let log2 = |n: u32| n.max(1).next_power_of_two().trailing_zeros();
        let tag = ADDRESS_BITS.saturating_sub(log2(line_bytes) + sets.max(1).ilog2());
        let store = |kind, about, width: u32| Self { ports, ..Self::new(name, kind, about, lines, width) };
        let compared = OperandWidth::fixed(tag, ways);
        [
            store(HardwareKind::CacheData, "lines", 8 * line_bytes),
            store(HardwareKind::CacheTags, "tag, valid, order of use", tag + 1 + log2(ways)),
            Self::new(name, HardwareKind::TagComparator, "ways of a look-up", ports.into(), compared),
        ]
    }

    /// Requests in flight of a port, each with `data_bytes` of data. Answers come in order, and a request starts only if its data
    /// have room.
    pub(crate) fn of_port(name: &str, outstanding: u64, data_bytes: u32) -> [Self; 2] {
        let of = |kind, about, width: u32| Self { ports: 2, ..Self::new(name, kind, about, outstanding, width) };
        [
            of(HardwareKind::LineBuffer, "data of requests in flight", data_bytes.saturating_mul(8)),
            of(HardwareKind::RequestTable, "requests in flight", REQUEST_BITS),
        ]
    }

    /// Data of a periodic client, in bursts: it uses those of one read while those of the next arrive.
    pub(crate) fn of_periodic_client(name: &str, read_bytes: u32, burst_bytes: u32) -> Self {
        let bursts = 2 * u64::from(read_bytes.div_ceil(burst_bytes.max(1)));
        let bits = burst_bytes.saturating_mul(8);
        Self { ports: 2, ..Self::new(name, HardwareKind::LineBuffer, "data in use and of the next read", bursts, bits) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cache_hardware_is_lines_and_tags() {
        let config = CacheConfig { line_bytes: 64, sets: 64, ways: 4, ..CacheConfig::default() };
        let [data, tags, compared] = Hardware::of_cache("c", &config);
        assert_eq!((data.bits(), data.count), (16 * 1024 * 8, 256));
        assert_eq!(tags.width, (32 - 6 - 6) + 1 + 2);
        assert_eq!((compared.count, compared.by, data.ports), (4, 4, 4), "a port and a comparator per look-up");
        let one = CacheConfig { line_bytes: 4, sets: 1, ways: 1, ..config };
        assert_eq!(Hardware::of_cache("c", &one)[1].width, 31);
    }

    #[test]
    fn operators_have_no_storage() {
        let all = HardwareKind::ALL.map(|kind| Hardware::new("", kind, "", 3, 5).bits());
        assert_eq!((&all[..8], &all[8..]), ([0; 8].as_slice(), [15; 7].as_slice()));
        assert!(HardwareKind::ALL.is_sorted());
    }
}
