//! Parameters that every machine has.

use basrelief_parameters::parameters;
use serde::{Deserialize, Serialize};

parameters! {
    /// The machine's clock. Its units count cycles; what counts seconds - memory parts, the path, the display, and times in the
    /// report - goes by it.
    pub struct ClockConfig {
        /// Cycles per second.
        hz: u64 = 200_000_000, unit: "Hz", Assumed("each machine has its own"), range: 1_u64..=100_000_000_000;
    }
}

parameters! {
    /// What costs nothing: to find what something costs.
    pub struct IdealConfig {
        /// Names of units, with commas between, whose steps keep them for one cycle and deliver as much earlier as they keep them
        /// shorter; what they ask of memories stays.
        units: String = String::new(), unit: "", Assumed("no unit is"), effect: Timing;
    }
}

parameters! {
    /// The exact picture: float64, no quantization.
    pub struct ReferenceConfig {
        /// Texture filter of the exact picture: nearest, bilinear (both on level 0) or trilinear.
        filter: ReferenceFilter = ReferenceFilter::Trilinear, unit: "", Assumed("what two-level interpolation approximates");
    }
}

/// Texture filter of the exact picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceFilter {
    /// The texel of level 0 that holds the sample point.
    Nearest,
    /// Four texels of level 0, weighted.
    Bilinear,
    /// Four texels each of two levels, by the level of detail of the pixel.
    #[default]
    Trilinear,
}
