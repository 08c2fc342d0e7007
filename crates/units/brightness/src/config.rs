//! Parameters of the brightness fetch unit (112).

use basrelief_kernel::{OperatorCounts, Operators};
use basrelief_parameters::parameters;
use serde::{Deserialize, Serialize};

/// Number of values per CLUT entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Components {
    /// One brightness: the highlight has the surface's colour.
    #[default]
    Combined,
    /// Diffuse and specular brightness: the highlight is white.
    Separate,
}

/// Source of the brightness of an index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BrightnessSource {
    /// Read from the CLUT (122).
    #[default]
    Clut,
    /// Computed from the reference normal, unquantized.
    Direct,
}

parameters! {
    /// Brightness fetch unit (112).
    pub struct BrightnessConfig {
        /// MIP levels between which the brightness is interpolated: 1 = the nearest, 2 = the two adjacent, n = the n nearest.
        levels: u8 = 2, unit: "levels", Stated("the brightness is interpolated between the two adjacent levels"), range: 1..=8;
        /// Width of each value of a CLUT entry.
        bits: u32 = 8, unit: "bits", Assumed("one byte, as the colour it multiplies"), range: 4..=16;
        /// Values per entry: combined (one brightness) or separate (diffuse and specular).
        components: Components = Components::Combined, unit: "", Stated("a CLUT holds the brightness of each reference normal");
        /// Source of the brightness: clut, or direct (computed per index).
        source: BrightnessSource = BrightnessSource::Clut, unit: "", Stated("the CLUT of the level is read at the index; claim 7 leaves it open");
        /// Samples that the interpolator accepts per cycle.
        samples_per_cycle: u32 = 2, unit: "samples/cycle", Assumed("the two adjacent levels of a fragment"), range: 1..=8;
        /// Sets of CLUTs in memory (120), one per material and lights, limited to 12 MiB. The least recently used set is
        /// replaced.
        sets: u32 = 16, unit: "sets", Assumed("16 times eight levels of 256 bytes are 32 KB"), range: 1..=4096;
        /// Multipliers for the calculation of entries, each with an adder beside it.
        multipliers: u32 = 4, unit: "multipliers", Assumed("four multiply-add units, as in a vector unit of the time"), range: 1..=256;
        /// Power units for the calculation of entries.
        powers: u32 = 1, unit: "units", Assumed("one elementary function unit, as beside such a vector unit"), range: 1..=64;
    }
}

impl BrightnessConfig {
    /// Returns the number of values of an entry.
    pub fn values(&self) -> u32 {
        match self.components {
            Components::Combined => 1,
            Components::Separate => 2,
        }
    }

    /// Returns the operators for the calculation of entries.
    fn arithmetic(&self) -> OperatorCounts {
        OperatorCounts { multiply: self.multipliers, add: self.multipliers, power: self.powers, ..OperatorCounts::NONE }
    }

    /// Returns the arithmetic of one entry under this many lights. Per light it has two inner products, a power, and products
    /// with coefficients and intensity, all added up. Finally the entry is quantized.
    fn entry(lights: usize) -> OperatorCounts {
        let lights = u32::try_from(lights).unwrap_or(u32::MAX);
        let of_a_light =
            OperatorCounts::INNER_PRODUCT.times(2).and(OperatorCounts { multiply: 4, add: 2, power: 1, ..OperatorCounts::NONE });
        of_a_light.times(lights).and(OperatorCounts { multiply: 1, add: 1, ..OperatorCounts::NONE })
    }

    /// Returns the occupancy of an entry under this many lights \[cycles\].
    pub(crate) fn entry_cycles(&self, lights: usize, operators: &Operators) -> u64 {
        operators.interval(Self::entry(lights), self.arithmetic())
    }

    /// Returns the cycles from a reference normal to its brightness: inner product, power, coefficient, sum, rounding.
    pub(crate) fn entry_latency(operators: &Operators) -> u64 {
        operators.latency(OperatorCounts { multiply: 3, add: 4, power: 1, ..OperatorCounts::NONE })
    }

    /// Returns the cycles from entries to brightness, all fixed-point: a product with the share, and a binary tree of sums over the
    /// samples.
    pub(crate) fn latency(&self, most_samples: u32, operators: &Operators) -> u64 {
        operators.latency(OperatorCounts {
            integer_multiply: 1,
            integer_add: most_samples.max(2).next_power_of_two().ilog2(),
            ..OperatorCounts::NONE
        })
    }

    /// Returns the bytes of a CLUT entry in memory (120). They are rounded up to a power of two so that no entry straddles two
    /// cache lines (assumed).
    pub fn entry_bytes(&self) -> u32 {
        (self.values() * self.bits).div_ceil(8).next_power_of_two()
    }
}
