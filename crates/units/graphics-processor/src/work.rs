//! What arithmetic a pixel takes, and how long it is under way.

use crate::GraphicsConfig;
use basrelief_kernel::{Operators, Work};
use basrelief_signals::{Polygon, TexelFilter};

/// Attributes of a fragment from two weights: two products and two sums for each number.
const fn interpolated(numbers: u32) -> Work {
    Work { multiply: 2 * numbers, add: 2 * numbers, ..Work::NONE }
}

/// Times base colour and brightness, three components each; the highlight is added, and they are limited to 8 bits.
const BLENDED: Work = Work { multiply: 3 + 3, add: 3 + 3, ..Work::NONE };
/// Colours of the vertices, and times them.
const COLOURED: Work = interpolated(3).and(Work { multiply: 3, ..Work::NONE });
/// The two terms of the brightness, where it comes from the vertices.
const LIT: Work = interpolated(2);
/// Coordinates, in texels; addresses; times the texel.
const TEXTURED: Work = interpolated(2).and(Work { multiply: 2 + 3, add: 4, ..Work::NONE });
/// Fractions, four weights of which one is a product, three components from four texels.
const FILTERED: Work = Work { multiply: 1 + 12, add: 2 + 3 + 9, ..Work::NONE };

/// What waits for each other: coordinates, address, weights, filter, three factors, highlight, limit.
const CHAIN: Work = Work { multiply: 1 + 1 + 1 + 1 + 4, add: 2 + 1 + 1 + 2 + 2, ..Work::NONE };

/// A pixel of this polygon.
fn pixel(polygon: &Polygon, filter: TexelFilter) -> Work {
    let of = |there: bool, work: Work| if there { work } else { Work::NONE };
    let is_textured = polygon.material.color_texture.is_some();
    BLENDED
        .and(of(polygon.vertices.iter().any(|v| v.color != [1.0; 4]), COLOURED))
        .and(of(!polygon.bump, LIT))
        .and(of(is_textured, TEXTURED))
        .and(of(is_textured && filter == TexelFilter::Bilinear, FILTERED))
}

/// When, as far as parameters say it: they do not change during a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Timing {
    /// From a fragment to its pixel, texels there \[cycles\].
    pub(crate) latency: u64,
    operators: Operators,
}

impl Timing {
    pub(crate) fn new(operators: Operators) -> Self {
        Self { latency: operators.latency(CHAIN), operators }
    }

    /// Cycles from one pixel of this polygon to the next.
    pub(crate) fn pace(&self, polygon: &Polygon, config: &GraphicsConfig) -> u64 {
        self.operators.pace(pixel(polygon, config.filter), config.operators())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operators_by_default_blend_a_pixel_per_cycle_whatever_it_is() {
        let all = [BLENDED, COLOURED, LIT, TEXTURED, FILTERED].into_iter().fold(Work::NONE, Work::and);
        assert_eq!(all, GraphicsConfig::default().operators());
    }
}
