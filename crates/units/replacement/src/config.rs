//! Parameters of the normal-vector replacement unit (110).

use basrelief_kernel::{OperatorCounts, Operators};
use basrelief_parameters::parameters;
use basrelief_shading::{LEVELS, MAX_ENTRIES, ReferenceNormals, TableSet};
use serde::{Deserialize, Serialize};

/// Rule that changes the number of reference normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TablePolicy {
    /// The number does not change.
    #[default]
    Fixed,
    /// The number halves per MIP level at which the object was drawn in the last frame, on average over its fragments.
    ByLod,
    /// The number is proportional to the fragments that the object drew in the last frame.
    ByFragments,
}

/// One number for all MIP levels, or one per level. A list shorter than 8 continues with its last number.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(untagged, expecting = "expected a whole number, or a list of them")]
pub enum PerLevel {
    /// The same number at every level.
    One(#[schemars(range(min = 1, max = MAX_ENTRIES))] u32),
    /// Numbers from level 0 (finest) on.
    Levels(#[schemars(length(min = 1, max = LEVELS), inner(range(min = 1, max = MAX_ENTRIES)))] Vec<u32>),
}

impl PerLevel {
    /// Returns the number of each level.
    pub fn levels(&self) -> [u32; LEVELS] {
        match self {
            Self::One(n) => [*n; LEVELS],
            Self::Levels(list) => {
                let last = list.last().copied().unwrap_or(0);
                std::array::from_fn(|k| list.get(k).copied().unwrap_or(last))
            }
        }
    }
}

/// Range of a [`PerLevel`]: each number lies in the range, and a list has 1 to 8 numbers.
#[derive(Clone)]
struct EachWithin(std::ops::RangeInclusive<u32>);

impl EachWithin {
    fn contains(&self, value: &PerLevel) -> bool {
        match value {
            PerLevel::One(n) => self.0.contains(n),
            PerLevel::Levels(list) => (1..=LEVELS).contains(&list.len()) && list.iter().all(|n| self.0.contains(n)),
        }
    }
}

impl std::fmt::Debug for EachWithin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}, or a list of 1 to {LEVELS} of these", self.0)
    }
}

/// Selects whether the tables of two levels differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TableSource {
    /// Each level has reference normals of its own, so that quantization errors differ and interpolation averages them.
    #[default]
    Different,
    /// Every level has the reference normals of level 0, for the ablation.
    Identical,
}

/// Source of the reference normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CodeBookMode {
    /// Tables fixed in advance.
    #[default]
    Fixed,
    /// Code books computed from each polygon's own N'.
    PerPolygon,
    /// Code books computed from all N' of an object.
    PerObject,
}

parameters! {
    /// Normal-vector replacement unit (110).
    pub struct ReplacementConfig {
        /// Reference normals per VQ table (121): one number, or one per MIP level.
        entries: PerLevel = PerLevel::One(256), unit: "reference normals", Stated("256 by default at level 0; the count may fall per level"), range: EachWithin(1..=MAX_ENTRIES as u32);
        /// Distribution of the reference normals: fibonacci or tetrahedron (4 k^2 entries).
        table: ReferenceNormals = ReferenceNormals::Fibonacci, unit: "", Assumed("even for every number of entries; the stated tetrahedron divided 8 x 8 is not");
        /// Reference normals of the levels: different (each level has its own) or identical (all levels have those of level 0).
        tables: TableSource = TableSource::Different, unit: "", Stated("each level has a different set of vectors, even where counts are equal");
        /// Width of each component of a table entry.
        entry_bits: u32 = 16, unit: "bits", Assumed("no coarser than N'"), range: 8..=16;
        /// Dot-product units that work in parallel on one search, which takes ceil(entries / lanes) cycles.
        lanes: u32 = 64, unit: "dot-product units", Assumed("a search of 256 in 4 cycles"), range: 1..=65536;
        /// True if a new search can start every cycle: the lanes exist ceil(entries / lanes) times.
        pipelined: bool = false, unit: "", Assumed("off: 64 inner-product units are 192 multipliers already");
        /// Offset of the MIP level that selects table and CLUT: a less important object uses coarser ones.
        vq_bias: u8 = 0, unit: "levels", Stated("a far or unimportant object may take a coarser table"), range: 0..=7;
        /// Source of the reference normals: fixed, per_polygon or per_object.
        codebook: CodeBookMode = CodeBookMode::Fixed, unit: "", Stated("tables fixed in advance; dynamic ones are the variants");
        /// VQ tables that the unit holds. The least recently used one is replaced.
        resident_tables: u32 = 2, unit: "tables", Assumed("the two adjacent levels of a polygon"), range: 1..=64;
        /// Size of one read while a VQ table is loaded.
        load_bytes: u32 = 64, unit: "bytes", Assumed("one burst"), range: 1..=4096;
        /// Most k-means passes of a code book.
        kmeans_iterations: u32 = 8, unit: "passes", Assumed("the error hardly falls after that"), range: 1..=64;
        /// Memory (120) for gathered pseudo-normals and for the fragments and control held beside them.
        gather_bytes: u64 = 64 << 20, unit: "bytes", Assumed("2.2 M fragments of two levels"), range: 1..=1_u64 << 32;
        /// Rule that changes the number of reference normals per frame, unless an object fixes it: fixed, by_lod or by_fragments.
        policy: TablePolicy = TablePolicy::Fixed, unit: "", Stated("the number may be changed dynamically; by which rule is ours");
        /// Fewest reference normals that a policy selects.
        least_entries: u32 = 16, unit: "reference normals", Assumed("below that the steps of brightness are seen on any surface"), range: 1..=MAX_ENTRIES as u32;
        /// For by_fragments: fragments of an object in the last frame per reference normal.
        fragments_per_entry: u32 = 64, unit: "fragments", Assumed("an object of 128 x 128 pixels gets 256"), range: 1..=1048576;
    }
}

impl ReplacementConfig {
    /// Returns the VQ tables (121) defined by entries, distribution and width.
    pub fn table_set(&self) -> TableSet {
        TableSet {
            entries: self.entries.levels(),
            table: self.table,
            distinct: self.tables == TableSource::Different,
            entry_bits: self.entry_bits,
        }
    }

    /// Returns the number of inner-product units: the lanes, or if a search can start every cycle enough for the largest table.
    pub fn inner_products(&self) -> u32 {
        let most = self.entries.levels().into_iter().max().unwrap_or(1);
        let times = if self.pipelined { most.div_ceil(self.lanes.max(1)) } else { 1 };
        self.lanes.saturating_mul(times)
    }

    /// Returns the operators that bring directions of code books to unit length: those of the inner products, one divider and one
    /// square-root unit.
    pub(crate) fn arithmetic(&self) -> OperatorCounts {
        OperatorCounts { divide: 1, square_root: 1, ..OperatorCounts::INNER_PRODUCT.times(self.lanes) }
    }

    /// Returns the cycles from the last row of a search of `entries` reference normals to its index, all in whole numbers: a
    /// product, two sums, a tree of comparisons over the lanes of a row, and another over the rows. No comparison waits for
    /// one of the row before, so a row enters in each cycle.
    pub fn latency(&self, entries: u32, operators: &Operators) -> u64 {
        let comparisons = levels_of(self.lanes.min(entries)) + levels_of(self.search_cycles(entries) as u32);
        operators.latency(OperatorCounts { integer_multiply: 1, integer_add: 2 + comparisons, ..OperatorCounts::NONE })
    }

    /// Returns the rows of one search of `entries` reference normals. Each row takes a cycle.
    pub fn search_cycles(&self, entries: u32) -> u64 {
        u64::from(entries.div_ceil(self.lanes.max(1)).max(1))
    }
}

/// Returns the levels of a binary tree over so many leaves, rounded up.
fn levels_of(leaves: u32) -> u32 {
    leaves.max(1).next_power_of_two().ilog2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_kernel::OperatorConfig;

    #[test]
    fn search_latency_is_that_of_integer_trees() {
        let config = ReplacementConfig { lanes: 64, ..ReplacementConfig::default() };
        let float = OperatorConfig::new(100, 100);
        let whole = Operators {
            multiply: float.clone(),
            add: float,
            integer_multiply: OperatorConfig::new(10, 1),
            ..Operators::default()
        };
        // A product, two sums, six levels over 64 lanes, and two over four rows.
        assert_eq!(config.latency(256, &whole), 10 + 2 + 6 + 2);
        assert_eq!([1, 2, 64, 65].map(|entries| config.latency(entries, &whole)), [12, 13, 18, 19]);
    }

    #[test]
    fn schema_of_entries_has_the_accepted_range() {
        let schema = schemars::schema_for!(PerLevel).to_value();
        let [one, levels] = [0, 1].map(|n| &schema["anyOf"][n]);
        for number in [one, &levels["items"]] {
            assert_eq!((number["minimum"].as_u64(), number["maximum"].as_u64()), (Some(1), Some(65_536)), "{schema}");
        }
        assert_eq!((levels["minItems"].as_u64(), levels["maxItems"].as_u64()), (Some(1), Some(8)), "{schema}");
    }

    #[test]
    fn entries_accept_one_number_or_one_per_level() {
        let load = |set: &[(&str, &str)]| basrelief_parameters::load::<ReplacementConfig>("", set);
        assert_eq!(load(&[("entries", "64")]).unwrap().entries.levels(), [64; 8]);
        let falling = load(&[("entries", "[256, 128, 64]")]).unwrap();
        assert_eq!(falling.entries.levels(), [256, 128, 64, 64, 64, 64, 64, 64]);
        for wrong in ["0", "65537", "[]", "[256, 0]", "[1,1,1,1,1,1,1,1,1]"] {
            let error = load(&[("entries", wrong)]).unwrap_err().to_string();
            assert!(
                error.contains("`entries`") && error.contains("1..=65536 reference normals, or a list of 1 to 8 of these"),
                "{error}"
            );
        }
    }

    #[test]
    fn search_takes_entries_over_lanes() {
        let config = ReplacementConfig { lanes: 64, ..ReplacementConfig::default() };
        assert_eq!([1, 64, 65, 256].map(|n| config.search_cycles(n)), [1, 1, 2, 4]);
    }
}
