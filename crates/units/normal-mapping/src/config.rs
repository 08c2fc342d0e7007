//! Parameters of the normal-vector mapping unit (108).

use basrelief_parameters::parameters;
use basrelief_signals::Filter;
use serde::{Deserialize, Serialize};

/// Where the four texels of a bilinear footprint are brought together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FilterAt {
    /// Before the search: one pseudo-normal per level.
    #[default]
    Normal,
    /// After it: four searches per level, the brightness is interpolated.
    Brightness,
}

parameters! {
    /// Normal-vector mapping unit (108).
    pub struct NormalMappingConfig {
        /// Filter within a MIP level: nearest or bilinear.
        filter: Filter = Filter::Bilinear, unit: "", Stated("trilinear filtering: linear within a level in both directions and between levels");
        /// What is filtered: the normal before the search, or the brightness after four searches (at most two levels).
        filter_at: FilterAt = FilterAt::Normal, unit: "", Assumed("a quarter of the searches");
        /// Width of each component of a pseudo-normal.
        normal_bits: u32 = 16, unit: "bits", Assumed("finer than any VQ table"), range: 8..=16;
        /// Bytes of a texel in the normal-map memory (116).
        texel_bytes: u32 = 4, unit: "bytes", Assumed("three components of 8 bits, padded to a word"), range: 1..=8;
        /// Cycles from a fragment to its pseudo-normals when all texels are there.
        latency: u32 = 12, unit: "cycles", Assumed("address 3, filter 4, rotate 3, scale 2"), range: 1..=1024;
        /// Pseudo-normals filtered, rotated and scaled per cycle.
        normals_per_cycle: u32 = 2, unit: "pseudo-normals/cycle", Assumed("two levels at one fragment per cycle"), range: 1..=8;
    }
}

impl NormalMappingConfig {
    /// Texels of one sample of a level.
    pub fn taps(&self) -> u32 {
        match self.filter {
            Filter::Nearest => 1,
            Filter::Bilinear => 4,
        }
    }

    /// Pseudo-normals per fragment, at most, when `levels` MIP levels are interpolated; a token holds
    /// [`MAX_SAMPLES`](basrelief_signals::MAX_SAMPLES).
    pub fn samples(&self, levels: u8) -> u32 {
        match self.filter_at {
            FilterAt::Normal => u32::from(levels),
            FilterAt::Brightness => u32::from(levels) * self.taps(),
        }
    }
}
