//! Parameters of the normal-vector mapping unit (108).

use basrelief_kernel::OperatorCounts;
use basrelief_parameters::parameters;
use basrelief_signals::TexelFilter;
use serde::{Deserialize, Serialize};

/// Stage at which the four texels of a bilinear footprint are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FilterAt {
    /// Before the search: one pseudo-normal per level.
    #[default]
    Normal,
    /// After four searches per level: the brightness is interpolated.
    Brightness,
}

parameters! {
    /// Normal-vector mapping unit (108).
    pub struct NormalMappingConfig {
        /// Filter within a MIP level: nearest or bilinear.
        filter: TexelFilter = TexelFilter::Bilinear, unit: "", Stated("trilinear filtering: linear within a level in both directions and between levels");
        /// Filtered quantity: the normal before the search, or the brightness after four searches (at most two levels).
        filter_at: FilterAt = FilterAt::Normal, unit: "", Assumed("a quarter of the searches");
        /// Width of each component of a pseudo-normal.
        normal_bits: u32 = 16, unit: "bits", Assumed("finer than any VQ table"), range: 8..=16;
        /// Size of a texel in the normal-map memory (116).
        texel_bytes: u32 = 4, unit: "bytes", Assumed("three components of 8 bits, padded to a word"), range: 3..=8;
        /// Multipliers of the unit.
        multipliers: u32 = 80, unit: "operators", Assumed("two pseudo-normals of a fragment per cycle, two levels at one fragment per cycle: 22 for the tangent frame, 29 for each; pixel shaders of 2005 had as many and more (24 pipelines with 8 each in the class of the RSX)"), range: 1..=1024;
        /// Adders of the unit.
        adders: u32 = 71, unit: "operators", Assumed("the same two pseudo-normals: 19 for the tangent frame, 26 for each"), range: 1..=1024;
        /// Dividers of the unit. Each pseudo-normal needs a reciprocal.
        dividers: u32 = 14, unit: "operators", Assumed("the same two pseudo-normals, with divisions of 7 cycles that are not pipelined: they take turns"), range: 1..=256;
    }
}

impl NormalMappingConfig {
    /// Returns the unit's operators.
    pub fn operators(&self) -> OperatorCounts {
        OperatorCounts { multiply: self.multipliers, add: self.adders, divide: self.dividers, ..OperatorCounts::NONE }
    }

    /// Returns the texels of one sample of a level.
    pub fn taps(&self) -> u32 {
        match self.filter {
            TexelFilter::Nearest => 1,
            TexelFilter::Bilinear => 4,
        }
    }

    /// Returns the largest number of pseudo-normals per fragment if `levels` MIP levels are interpolated. A token holds
    /// [`MAX_SAMPLES`](basrelief_signals::MAX_SAMPLES).
    pub fn samples(&self, levels: u8) -> u32 {
        match self.filter_at {
            FilterAt::Normal => u32::from(levels),
            FilterAt::Brightness => u32::from(levels) * self.taps(),
        }
    }
}
