//! Colour of a pixel: from which layers (Figures 7A and 7B), and what it comes to.

use crate::Cell;
use crate::cell::CellFormat;
use crate::identification::layers_of;
use crate::page::{Placed, Tap};
use crate::texels::PageTexels;
use basrelief_shading::saturated;

/// Which layers a pixel is coloured from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The coarser, or the only one.
    pub lower: u8,
    /// The finer, and its share.
    pub upper: Option<(u8, f32)>,
    /// The layer whose tiles would improve it.
    pub improve: Option<u8>,
    /// Words of the tile load list (136) that were read to find it: one for each layer looked at, two where its tiles lie in two.
    pub words: u32,
}

/// Figure 7A: everything is there.
#[inline]
pub fn best(texels: &PageTexels, cell: &Cell) -> Choice {
    let (coarse, fraction, fine) = layers_of(&texels.page, cell);
    Choice { lower: coarse, upper: fine.map(|f| (f, fraction)), improve: None, words: 0 }
}

/// Figure 7B: the finest layer that is there, up to D_G, and what would improve it. (Where D_f = 0 the search starts at D_L:
/// the text would fetch a layer of weight zero.) None where not even the top tile is there. A word of the tile load list (136) has
/// `entries`.
#[inline]
pub fn progressive(texels: &PageTexels, cell: &Cell, placed: Placed, entries: u32) -> Option<Choice> {
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
    let alone = |improve| Some(Choice { lower: found, upper: None, improve, words });
    match fine {
        _ if found < wished => alone(Some(found + 1)),
        None => alone(None),
        Some(fine) if both => Some(Choice { lower: coarse, upper: Some((fine, fraction)), improve: None, words }),
        // With tiles of an earlier view the coarser may be missing while the finer is there.
        Some(_) => alone(Some(coarse)),
    }
}

/// What one or two layers give at a pixel: colour, and what was read of each layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// 0..=255 per channel.
    pub colour: [f32; 4],
    /// Layers read, and where.
    pub read: [Option<(u8, [Tap; 2])>; 2],
}

/// R0 = R1 + (R2 - R1) * D_f, with R1 of the coarser layer, R2 of the finer: the same whatever the mode.
#[inline]
pub fn sample(texels: &PageTexels, choice: &Choice, placed: Placed) -> Sample {
    let taps = texels.page.taps(choice.lower, placed);
    let lower = texels.bilinear(choice.lower, &taps);
    let first = Some((choice.lower, taps));
    match choice.upper {
        None => Sample { colour: lower, read: [first, None] },
        Some((layer, share)) => {
            let taps = texels.page.taps(layer, placed);
            let upper = texels.bilinear(layer, &taps);
            let colour = std::array::from_fn(|c| lower[c] + (upper[c] - lower[c]) * share);
            Sample { colour, read: [first, Some((layer, taps))] }
        }
    }
}

/// Texel times brightness coefficients, in 8 bits.
#[inline]
pub fn shaded(format: &CellFormat, cell: &Cell, colour: [f32; 4]) -> [u8; 3] {
    let brightness = format.brightness(cell);
    saturated([0, 1, 2].map(|c| colour[c] * brightness[c] * (1.0 / 255.0)))
}
