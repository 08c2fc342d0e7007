//! Colour of a pixel: the layers that it is computed from (Figures 7A and 7B), and its value.

use crate::ReferenceCell;
use crate::cell::CellFormat;
use crate::identification::layers_of;
use crate::page::{AxisTap, WrappedCoordinates};
use crate::texels::PageTexels;
use basrelief_shading::saturated;

/// Layers from which a pixel is coloured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerChoice {
    /// The coarser layer, or the only one.
    pub lower: u8,
    /// The finer layer, and its share.
    pub upper: Option<(u8, f32)>,
    /// The layer whose tiles would improve the pixel.
    pub improve: Option<u8>,
    /// Words of the tile load list (136) that the search read: one for each layer tested, or two if its tiles lie in two words.
    pub words: u32,
}

/// Returns the layers by Figure 7A, with all tiles present.
#[inline]
pub fn best(texels: &PageTexels, cell: &ReferenceCell) -> LayerChoice {
    let (coarse, fraction, fine) = layers_of(&texels.page, cell);
    LayerChoice { lower: coarse, upper: fine.map(|f| (f, fraction)), improve: None, words: 0 }
}

/// Returns the layers by Figure 7B: the finest present layer up to D_G, and the layer that would improve it. (If D_f = 0 the
/// search starts at D_L, because the text would fetch a layer of weight zero.) Returns `None` if not even the top tile is
/// present. A word of the tile load list (136) has `entries` entries.
#[inline]
pub fn progressive(texels: &PageTexels, cell: &ReferenceCell, placed: WrappedCoordinates, entries: u32) -> Option<LayerChoice> {
    let (coarse, fraction, fine) = layers_of(&texels.page, cell);
    let wished = fine.unwrap_or(coarse);
    let mut words = 0;
    let mut is_there = |layer: u8| {
        let (is_there, read) = texels.look_up(layer, placed, entries);
        words += read;
        is_there
    };
    let found = (0..=wished).rev().find(|&layer| is_there(layer))?;
    let both = found == wished && fine.is_some() && is_there(coarse);
    let alone = |improve| Some(LayerChoice { lower: found, upper: None, improve, words });
    match fine {
        _ if found < wished => alone(Some(found + 1)),
        None => alone(None),
        Some(fine) if both => Some(LayerChoice { lower: coarse, upper: Some((fine, fraction)), improve: None, words }),
        // With tiles of an earlier view the finer layer may be present without the coarser.
        Some(_) => alone(Some(coarse)),
    }
}

/// Colour of a pixel from one or two layers, and the texels read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelSample {
    /// Colour, 0..=255 per channel.
    pub colour: [f32; 4],
    /// Layers read, with the taps.
    pub read: [Option<(u8, [AxisTap; 2])>; 2],
}

/// Computes R0 = R1 + (R2 - R1) * D_f, with R1 of the coarser layer and R2 of the finer, in every mode.
#[inline]
pub fn sample(texels: &PageTexels, choice: &LayerChoice, placed: WrappedCoordinates) -> PixelSample {
    let taps = texels.page.taps(choice.lower, placed);
    let lower = texels.bilinear(choice.lower, &taps);
    let first = Some((choice.lower, taps));
    match choice.upper {
        None => PixelSample { colour: lower, read: [first, None] },
        Some((layer, share)) => {
            let taps = texels.page.taps(layer, placed);
            let upper = texels.bilinear(layer, &taps);
            let colour = std::array::from_fn(|c| lower[c] + (upper[c] - lower[c]) * share);
            PixelSample { colour, read: [first, Some((layer, taps))] }
        }
    }
}

/// Computes the product of texel and brightness coefficients, in 8 bits.
#[inline]
pub fn shaded(format: &CellFormat, cell: &ReferenceCell, colour: [f32; 4]) -> [u8; 3] {
    let brightness = format.brightness(cell);
    saturated([0, 1, 2].map(|c| colour[c] * brightness[c] * (1.0 / 255.0)))
}
