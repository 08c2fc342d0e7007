//! Arithmetic and latency of the pseudo-normals of a fragment.

use crate::NormalMappingConfig;
use basrelief_kernel::{OperatorCounts, Operators};
use basrelief_signals::{MAX_SAMPLES, TexelFilter};

/// Returns the arithmetic of interpolated attributes of a fragment: two products and two sums per number.
const fn interpolated(numbers: u32) -> OperatorCounts {
    OperatorCounts { multiply: 2 * numbers, add: 2 * numbers, ..OperatorCounts::NONE }
}

/// Arithmetic of the interpolated normal alone, for a polygon without a map.
const BARE: OperatorCounts = interpolated(3);

/// Arithmetic of normal, tangent and coordinates. The bitangent is a cross product. Its sign, the handedness, costs nothing.
const FRAME: OperatorCounts = interpolated(8).and(OperatorCounts { multiply: 6, add: 3, ..OperatorCounts::NONE });

/// Arithmetic of a footprint in a level: coordinates in texels, their fractions, four weights of which one is a product, and
/// addresses.
const FOOTPRINT: OperatorCounts = OperatorCounts { multiply: 2 + 1, add: 2 + 3 + 4, ..OperatorCounts::NONE };

/// Arithmetic of three components filtered from four texels.
const FILTERED: OperatorCounts = OperatorCounts { multiply: 12, add: 9, ..OperatorCounts::NONE };

/// Arithmetic from a stored normal to world space: x and y times the scale of the map, then a matrix of 3 x 3. Decoding is a
/// shift.
const ROTATED: OperatorCounts = OperatorCounts { multiply: 2 + 9, add: 6, ..OperatorCounts::NONE };

/// Arithmetic of scaling: the largest component, its reciprocal, three products.
const SCALED: OperatorCounts = OperatorCounts { multiply: 3, add: 2, divide: 1, ..OperatorCounts::NONE };

/// Returns the arithmetic of `samples` pseudo-normals of a fragment. Each comes from a filtered footprint of its level, or four
/// come from the texels of one footprint.
fn mapped(config: &NormalMappingConfig, samples: u32) -> OperatorCounts {
    let of_a_footprint = config.samples(1);
    let footprints = samples.div_ceil(of_a_footprint);
    let is_filtered = config.filter == TexelFilter::Bilinear && of_a_footprint == 1;
    let footprint = if is_filtered { FOOTPRINT.and(FILTERED) } else { FOOTPRINT };
    FRAME.and(footprint.times(footprints)).and(ROTATED.and(SCALED).times(samples))
}

impl NormalMappingConfig {
    /// Returns the arithmetic of a fragment, if `levels` MIP levels are interpolated.
    pub(crate) fn work(&self, levels: u8) -> OperatorCounts {
        mapped(self, self.samples(levels))
    }
}

/// Longest dependent chain up to the addresses of the texels: attribute, footprint.
const ADDRESSES: OperatorCounts = OperatorCounts { multiply: 1 + 1, add: 2 + 2, ..OperatorCounts::NONE };
/// Longest dependent chain from the texels on: filter, rotation, scale.
const FROM_TEXELS: OperatorCounts = OperatorCounts { multiply: 1 + 1 + 1, add: 2 + 2 + 2, divide: 1, ..OperatorCounts::NONE };

/// Timing computed once from the parameters, because they do not change during a run and every step needs it.
#[derive(Clone, Debug)]
pub(crate) struct MappingTiming {
    /// Cycles from a fragment to its pseudo-normals, without texel fetches.
    pub(crate) latency: u64,
    /// The part of the latency that needs the texels.
    pub(crate) after_texels: u32,
    /// Cycles from one fragment to the next without a map. N' is the same at all levels.
    bare: u64,
    /// Cycles from one fragment to the next with a map, by the number of pseudo-normals.
    mapped: [u64; MAX_SAMPLES + 1],
}

impl MappingTiming {
    pub(crate) fn new(config: &NormalMappingConfig, operators: &Operators) -> Self {
        let pace = |work| operators.stream_interval(work, config.operators());
        let mapped = std::array::from_fn(|samples| pace(mapped(config, samples as u32)));
        let (latency, after_texels) = (operators.latency(ADDRESSES.and(FROM_TEXELS)), operators.latency(FROM_TEXELS) as u32);
        Self { latency, after_texels, bare: pace(BARE.and(SCALED)), mapped }
    }

    /// Returns the cycles from one fragment to the next, with this many pseudo-normals each.
    #[inline]
    pub(crate) fn pace(&self, is_mapped: bool, samples: usize) -> u64 {
        if is_mapped { self.mapped[samples.min(MAX_SAMPLES)] } else { self.bare }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_kernel::OperatorConfig;

    #[test]
    fn default_operators_make_two_pseudo_normals_per_cycle() {
        let operators = Operators { divide: OperatorConfig::new(7, 7), ..Operators::default() };
        let config = NormalMappingConfig::default();
        let (have, two) = (config.operators(), mapped(&config, 2));
        assert_eq!((two.multiply, two.add, two.divide), (have.multiply, have.add, 2));
        assert_eq!(operators.stream_interval(two, have), 1);
        let fewer = [OperatorCounts { multiply: have.multiply - 1, ..have }, OperatorCounts { divide: have.divide - 1, ..have }];
        assert_eq!(fewer.map(|have| operators.stream_interval(two, have)), [2, 2], "and none of them is too many");
        assert_eq!(operators.stream_interval(mapped(&config, 3), have), 2);
    }
}
