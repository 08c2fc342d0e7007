//! Parameters of the brightness fetch unit (112).

use basrelief_kernel::{Operators, Work};
use basrelief_parameters::parameters;
use serde::{Deserialize, Serialize};

/// How many values a CLUT entry holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Components {
    /// One brightness: the highlight takes the surface's colour.
    #[default]
    Combined,
    /// Diffuse and specular brightness: the highlight is white.
    Separate,
}

/// Where the brightness of an index comes from.
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
        /// MIP levels whose brightness is interpolated: 1 = the nearest, 2 = the two adjacent, n = the n nearest.
        levels: u8 = 2, unit: "levels", Stated("the brightness is interpolated between the two adjacent levels"), range: 1..=8;
        /// Width of each value of a CLUT entry.
        bits: u32 = 8, unit: "bits", Assumed("one byte, as the colour it multiplies"), range: 4..=16;
        /// Values per entry: combined (one brightness) or separate (diffuse and specular).
        components: Components = Components::Combined, unit: "", Stated("a CLUT holds the brightness of each reference normal");
        /// Where brightness comes from: clut, or direct (computed per index).
        source: BrightnessSource = BrightnessSource::Clut, unit: "", Stated("the CLUT of the level is read at the index; claim 7 leaves it open");
        /// Samples that the interpolator takes per cycle.
        samples_per_cycle: u32 = 2, unit: "samples/cycle", Assumed("the two adjacent levels of a fragment"), range: 1..=8;
        /// Sets of CLUTs that memory (120) holds, one per material and lights; the least recently used is replaced. No more than
        /// fit into 12 MiB.
        sets: u32 = 16, unit: "sets", Assumed("16 times eight levels of 256 bytes are 32 KB"), range: 1..=4096;
        /// Multipliers that entries are calculated with, each with an adder beside it.
        multipliers: u32 = 4, unit: "multipliers", Assumed("four multiply-add units, as in a vector unit of the time"), range: 1..=256;
        /// Units for powers that entries are calculated with.
        powers: u32 = 1, unit: "units", Assumed("one elementary function unit, as beside such a vector unit"), range: 1..=64;
    }
}

impl BrightnessConfig {
    /// Values of an entry.
    pub fn values(&self) -> u32 {
        match self.components {
            Components::Combined => 1,
            Components::Separate => 2,
        }
    }

    /// The operators that entries are calculated with.
    fn arithmetic(&self) -> Work {
        Work { multiply: self.multipliers, add: self.multipliers, power: self.powers, ..Work::NONE }
    }

    /// One entry under this many lights: per light two inner products, a power, and products with coefficients and intensity,
    /// added up; at last it is brought to its steps.
    fn entry(lights: usize) -> Work {
        let lights = u32::try_from(lights).unwrap_or(u32::MAX);
        let of_a_light = Work::INNER_PRODUCT.times(2).and(Work { multiply: 4, add: 2, power: 1, ..Work::NONE });
        of_a_light.times(lights).and(Work { multiply: 1, add: 1, ..Work::NONE })
    }

    /// Cycles for which an entry under this many lights keeps the unit.
    pub(crate) fn entry_cycles(&self, lights: usize, operators: &Operators) -> u64 {
        operators.interval(Self::entry(lights), self.arithmetic())
    }

    /// Cycles from a reference normal to its brightness: inner product, power, coefficient, sum, rounding.
    pub(crate) fn entry_latency(operators: &Operators) -> u64 {
        operators.latency(Work { multiply: 3, add: 4, power: 1, ..Work::NONE })
    }

    /// Cycles from entries to brightness: a product with the share, and the sum of the samples, two by two.
    pub(crate) fn latency(&self, most_samples: u32, operators: &Operators) -> u64 {
        operators.latency(Work { multiply: 1, add: most_samples.max(2).next_power_of_two().ilog2(), ..Work::NONE })
    }

    /// Bytes of a CLUT entry in memory (120): its bits in whole bytes, rounded up to a power of two so that none straddles
    /// two cache lines (assumed).
    pub fn entry_bytes(&self) -> u32 {
        (self.values() * self.bits).div_ceil(8).next_power_of_two()
    }
}
