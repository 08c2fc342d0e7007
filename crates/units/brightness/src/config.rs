//! Parameters of the brightness fetch unit (112).

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
        /// Cycles from indexes to brightness when all entries are there.
        latency: u32 = 4, unit: "cycles", Assumed("address 1, multiply 1, add 2"), range: 1..=1024;
        /// Cycles to compute one sample where the source is direct.
        direct_cycles: u32 = 16, unit: "cycles", Assumed("two inner products and a power, one multiplier"), range: 1..=4096;
        /// Cycles to recalculate one CLUT entry.
        rebuild_cycles_per_entry: u32 = 16, unit: "cycles", Assumed("the same arithmetic as direct_cycles"), range: 1..=4096;
    }
}

impl BrightnessConfig {
    /// Bytes of a CLUT entry in memory (120): its bits in whole bytes, rounded up to a power of two so that none straddles
    /// two cache lines (assumed).
    pub fn entry_bytes(&self) -> u32 {
        let values = match self.components {
            Components::Combined => 1,
            Components::Separate => 2,
        };
        (values * self.bits).div_ceil(8).next_power_of_two()
    }
}
