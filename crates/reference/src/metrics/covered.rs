//! Pixels covered in either of two pictures, and the mean of a map over them.

use super::filter::{FilterWindow, RowStrip, STRIP_PIXELS, STRIP_ROWS};
use crate::RgbPicture;
use basrelief_threads as threads;
use std::ops::Range;

/// Size mismatch of two pictures to be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "reference image {}x{} against picture {}x{}: both must have the same size, and as many pixels as it says; draw \
     them from the same frame",
    .exact[0], .exact[1], .other[0], .other[1]
)]
pub struct SizeMismatch {
    /// Width and height of the reference image \[pixels\].
    pub exact: [u32; 2],
    /// Width and height of the picture compared with it \[pixels\].
    pub other: [u32; 2],
}

pub(super) fn same_size(exact: &RgbPicture, other: &RgbPicture) -> Result<(), SizeMismatch> {
    let size = |picture: &RgbPicture| [picture.width, picture.height];
    let whole = |picture: &RgbPicture| {
        let pixels = picture.width as usize * picture.height as usize;
        picture.rgb.len() == pixels && picture.covered.len() == pixels
    };
    if size(exact) == size(other) && whole(exact) && whole(other) {
        return Ok(());
    }
    Err(SizeMismatch { exact: size(exact), other: size(other) })
}

/// Returns the numbers of the pixels covered in either picture, ascending.
pub(super) fn covered<'a>(exact: &'a RgbPicture, other: &'a RgbPicture) -> impl Iterator<Item = usize> + 'a {
    covered_in(exact, other, 0..exact.height as usize)
}

/// Returns the numbers of the covered pixels in these rows.
pub(super) fn covered_in<'a>(
    exact: &'a RgbPicture,
    other: &'a RgbPicture,
    rows: Range<usize>,
) -> impl Iterator<Item = usize> + 'a {
    let pixels = rows.start * exact.width as usize..rows.end * exact.width as usize;
    let both = exact.covered[pixels.clone()].iter().zip(&other.covered[pixels.clone()]);
    pixels.zip(both).filter(|(_, (a, b))| **a || **b).map(|(i, _)| i)
}

/// Returns the pixels covered in either picture, and those in reach of their filters; `None` if no pixel is covered. For covered pixels, a
/// filter of this radius has the same result in this part as in the whole picture: the rim of the part is the picture's, or lies beyond
/// the reach of the filter.
pub(super) fn reach(exact: &RgbPicture, other: &RgbPicture, radius: usize) -> Option<FilterWindow> {
    let (width, height) = (exact.width as usize, exact.height as usize);
    let mut pixels = covered(exact, other).map(|i| (i % width, i / width));
    let (x, y) = pixels.next()?;
    let grow = |(low, high): (usize, usize), at: usize| (low.min(at), high.max(at));
    let (columns, rows) = pixels.fold(((x, x), (y, y)), |(columns, rows), (x, y)| (grow(columns, x), grow(rows, y)));
    let reached = |(low, high): (usize, usize), size: usize| low.saturating_sub(radius)..(high + radius + 1).min(size);
    Some(FilterWindow { columns: reached(columns, width), rows: reached(rows, height) })
}

/// Returns the mean of a map over the pixels covered in either picture, or `empty` if no pixel is. `values` returns the covered
/// pixels of the map in a strip. Strips are computed in parallel and added in order: the sum is identical to the bit to a
/// sequential one.
pub(super) fn mean(strips: &[RowStrip], empty: f64, values: impl Fn(&RowStrip) -> Vec<f64> + Sync) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    // One strip per worker at a time, so that the planes of other strips are not in memory.
    for together in strips.chunks(threads::workers()) {
        for value in threads::par_map(together.iter().collect(), &values).into_iter().flatten() {
            sum += value;
            count += 1;
        }
    }
    if count == 0 { empty } else { rounded(sum / f64::from(count)) }
}

/// Returns the pixels of a strip. All strips computed in parallel have about [`STRIP_PIXELS`] together, at most. A small picture
/// has one strip per worker, of at least [`STRIP_ROWS`] rows.
pub(super) fn strip_pixels(window: &FilterWindow) -> usize {
    let shared = window.pixels().min(STRIP_PIXELS).div_ceil(threads::workers());
    shared.max(STRIP_ROWS * window.width())
}

pub(super) fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
