//! Hardware counts of a machine: numbers that can be multiplied, without area and energy.

use crate::CacheConfig;
use std::fmt;

/// Bits of an address in memory, as tags hold it.
const ADDRESS_BITS: u32 = 32;

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
    /// Divider.
    Divider,
    /// Square root.
    SquareRoot,
    /// Power with any exponent.
    Power,
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
}

impl HardwareKind {
    /// All kinds, arithmetic first.
    pub const ALL: [Self; 11] = [
        Self::InnerProduct,
        Self::Multiplier,
        Self::Adder,
        Self::Divider,
        Self::SquareRoot,
        Self::Power,
        Self::Table,
        Self::Registers,
        Self::CacheData,
        Self::CacheTags,
        Self::Fifo,
    ];

    /// Returns true for operators and false for storage.
    pub fn computes(self) -> bool {
        self < Self::Table
    }

    /// Name, in the plural for countable kinds.
    pub fn name(self) -> &'static str {
        match self {
            Self::InnerProduct => "inner products",
            Self::Multiplier => "multipliers",
            Self::Adder => "adders",
            Self::Divider => "dividers",
            Self::SquareRoot => "square roots",
            Self::Power => "powers",
            Self::Table => "tables",
            Self::Registers => "registers",
            Self::CacheData => "cache data",
            Self::CacheTags => "cache tags",
            Self::Fifo => "FIFOs",
        }
    }
}

impl fmt::Display for HardwareKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Identical pieces of hardware.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hardware {
    /// Name of the unit, FIFO or cache.
    pub place: String,
    /// Its kind.
    pub kind: HardwareKind,
    /// Purpose, in a few words.
    pub about: &'static str,
    /// Number of operators or words.
    pub count: u64,
    /// Width of each \[bits\].
    pub width: u32,
}

impl Hardware {
    /// Bits of storage; 0 for operators.
    pub fn bits(&self) -> u64 {
        if self.kind.computes() { 0 } else { self.count * u64::from(self.width) }
    }

    /// Data and tags of a cache. A tag has the remaining bits of a 32-bit address, a valid bit, and the place of the line in the
    /// order of use.
    pub(crate) fn of_cache(name: &str, config: &CacheConfig) -> [Self; 2] {
        let CacheConfig { line_bytes, sets, ways, .. } = *config;
        let lines = u64::from(sets) * u64::from(ways);
        let log2 = |n: u32| n.max(1).next_power_of_two().trailing_zeros();
        let tag = ADDRESS_BITS.saturating_sub(log2(line_bytes) + sets.max(1).ilog2()) + 1 + log2(ways);
        let of = |kind, about, width| Self { place: name.into(), kind, about, count: lines, width };
        [of(HardwareKind::CacheData, "lines", 8 * line_bytes), of(HardwareKind::CacheTags, "tag, valid, order of use", tag)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cache_hardware_is_lines_and_tags() {
        let config = CacheConfig { line_bytes: 64, sets: 64, ways: 4, ..CacheConfig::default() };
        let [data, tags] = Hardware::of_cache("c", &config);
        assert_eq!((data.bits(), data.count), (16 * 1024 * 8, 256));
        assert_eq!(tags.width, (32 - 6 - 6) + 1 + 2);
        let one = CacheConfig { line_bytes: 4, sets: 1, ways: 1, ..config };
        assert_eq!(Hardware::of_cache("c", &one)[1].width, 31);
    }

    #[test]
    fn operators_have_no_storage() {
        let all = HardwareKind::ALL.map(|kind| Hardware { place: String::new(), kind, about: "", count: 3, width: 5 }.bits());
        assert_eq!(all, [0, 0, 0, 0, 0, 0, 15, 15, 15, 15, 15]);
        assert!(HardwareKind::ALL.is_sorted());
    }
}
