//! Arithmetic and latency of a pixel.

use crate::GraphicsConfig;
use basrelief_kernel::{OperatorCounts, Operators};
use basrelief_signals::{Polygon, TexelFilter};

/// Returns the arithmetic of interpolated attributes of a fragment: two products and two sums per number.
const fn interpolated(numbers: u32) -> OperatorCounts {
    OperatorCounts { multiply: 2 * numbers, add: 2 * numbers, ..OperatorCounts::NONE }
}

/// Arithmetic of the product with base colour and brightness, three components each. The highlight is added, and the result is
/// limited to 8 bits.
const BLENDED: OperatorCounts = OperatorCounts { multiply: 3 + 3, add: 3 + 3, ..OperatorCounts::NONE };
/// Arithmetic of the vertex colours and the product with them.
const COLOURED: OperatorCounts = interpolated(3).and(OperatorCounts { multiply: 3, ..OperatorCounts::NONE });
/// Arithmetic of the two terms of the brightness at the vertices.
const LIT: OperatorCounts = interpolated(2);
/// Arithmetic of coordinates in texels, addresses, and the product with the texel.
const TEXTURED: OperatorCounts = interpolated(2).and(OperatorCounts { multiply: 2 + 3, add: 4, ..OperatorCounts::NONE });
/// Arithmetic of fractions, four weights of which one is a product, and three components from four texels.
const FILTERED: OperatorCounts = OperatorCounts { multiply: 1 + 12, add: 2 + 3 + 9, ..OperatorCounts::NONE };

/// Arithmetic of a pixel that needs all of these.
pub(crate) const ANY_PIXEL: OperatorCounts = BLENDED.and(COLOURED).and(LIT).and(TEXTURED).and(FILTERED);

/// Longest dependent chain up to the texels: coordinates, address, weights.
const ADDRESSES: OperatorCounts = OperatorCounts { multiply: 1 + 1 + 1, add: 2 + 1 + 1, ..OperatorCounts::NONE };
/// Longest dependent chain from the texels on: filter, three factors, highlight, limit.
const FROM_TEXELS: OperatorCounts = OperatorCounts { multiply: 1 + 4, add: 2 + 2, ..OperatorCounts::NONE };

/// Returns the arithmetic of a pixel of this polygon.
fn pixel(polygon: &Polygon, filter: TexelFilter) -> OperatorCounts {
    let of = |there: bool, work: OperatorCounts| if there { work } else { OperatorCounts::NONE };
    let is_textured = polygon.material.color_texture.is_some();
    BLENDED
        .and(of(polygon.vertices.iter().any(|v| v.color != [1.0; 4]), COLOURED))
        .and(of(!polygon.bump, LIT))
        .and(of(is_textured, TEXTURED))
        .and(of(is_textured && filter == TexelFilter::Bilinear, FILTERED))
}

/// Timing computed once from the parameters, because they do not change during a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct PixelTiming {
    /// Cycles from a fragment to its pixel, without texel fetches.
    pub(crate) latency: u64,
    /// The part of the latency that needs the texels.
    pub(crate) after_texels: u32,
    operators: Operators,
}

impl PixelTiming {
    pub(crate) fn new(operators: Operators) -> Self {
        let latency = operators.latency(ADDRESSES.and(FROM_TEXELS));
        Self { latency, after_texels: operators.latency(FROM_TEXELS) as u32, operators }
    }

    /// Returns the cycles from one pixel of this polygon to the next.
    pub(crate) fn pace(&self, polygon: &Polygon, config: &GraphicsConfig) -> u64 {
        self.operators.stream_interval(pixel(polygon, config.filter), config.operators())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_operators_blend_any_pixel_per_cycle() {
        assert_eq!(ANY_PIXEL, GraphicsConfig::default().operators());
    }
}
