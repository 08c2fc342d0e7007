//! Traits of tokens of pixels, whatever their shape, for depth tests and frame buffers.

use crate::{Fragment, MAX_STAMP, Pixel, Stamp};
use serde::{Deserialize, Serialize};

/// A pixel with a position on the screen and a depth.
pub trait PixelPlace {
    /// Returns column, row and depth.
    fn place(&self) -> (u16, u16, u32);
}

impl PixelPlace for Fragment {
    #[inline]
    fn place(&self) -> (u16, u16, u32) {
        (self.x, self.y, self.z)
    }
}

impl PixelPlace for Pixel {
    #[inline]
    fn place(&self) -> (u16, u16, u32) {
        (self.x, self.y, self.z)
    }
}

/// A token of pixels in one line of a picture's memory. A line is a rectangle of [`LINE_PIXELS`], the same for all tokens of a
/// type. A picture drawn by such tokens is stored line by line.
pub trait PixelToken {
    /// Width and height of a line \[pixels\]. Their product is [`LINE_PIXELS`].
    const LINE: [u32; 2];
    /// Maximum number of pixels of a token.
    const MOST_PIXELS: u32;
    /// Returns the number of pixels.
    fn pixels(&self) -> usize;
}

/// Pixels per memory line of a picture.
pub const LINE_PIXELS: u32 = 16;

/// Width of a line number in the largest picture, [`MAX_PIXELS`](crate::layout::MAX_PIXELS) \[bits\].
pub const LINE_NUMBER: u32 = (crate::layout::MAX_PIXELS / LINE_PIXELS as u64).ilog2();

/// Returns the number of the line that holds pixel `(x, y)` of a picture of this width. Lines are numbered row by row.
#[inline]
pub fn line_of<T: PixelToken>(width: u32, [x, y]: [u32; 2]) -> u64 {
    let [columns, rows] = T::LINE;
    u64::from(y / rows) * u64::from(width.div_ceil(columns)) + u64::from(x / columns)
}

/// Returns the number of lines of a picture of this size.
pub fn lines<T: PixelToken>(width: u32, height: u32) -> u64 {
    let [columns, rows] = T::LINE;
    u64::from(width.div_ceil(columns)) * u64::from(height.div_ceil(rows))
}

/// A token whose pixels undergo a depth test.
pub trait DepthToken: PixelToken {
    /// True if a token travels on with no pixel left, because the following units count tokens.
    const KEPT_WHEN_EMPTY: bool;
    /// Keeps the pixels for which `passes` returns true, in order. Returns true if any is left.
    fn retain(&mut self, passes: impl FnMut(u16, u16, u32) -> bool) -> bool;
}

/// A token of finished pixels.
pub trait ColorToken: PixelToken {
    /// Calls `show` with column, row and colour of each pixel.
    fn each(&self, show: impl FnMut(u16, u16, [u8; 3]));
}

impl<T: PixelPlace> PixelToken for Stamp<T> {
    const LINE: [u32; 2] = [4, 4];
    const MOST_PIXELS: u32 = MAX_STAMP as u32;

    #[inline]
    fn pixels(&self) -> usize {
        self.len()
    }
}

impl<T: PixelPlace> DepthToken for Stamp<T> {
    const KEPT_WHEN_EMPTY: bool = false;

    /// (`ArrayVec::retain` alone calls the predicate in two places and guards against a panic in either: 30 instructions more for
    /// a stamp of one pixel.)
    #[inline(always)]
    fn retain(&mut self, mut passes: impl FnMut(u16, u16, u32) -> bool) -> bool {
        let mut left = 0_u32;
        for (i, item) in self.iter().enumerate() {
            let (x, y, z) = item.place();
            left |= u32::from(passes(x, y, z)) << i;
        }
        // In most cases all or none are.
        if left == 0 {
            self.clear();
        } else if left + 1 < 1 << self.len() {
            keep(self, left);
        }
        left != 0
    }
}

/// Drops the items of a stamp whose bit in `left` is clear.
#[inline(never)]
fn keep<T>(stamp: &mut Stamp<T>, mut left: u32) {
    stamp.retain(|_| {
        let is_left = left & 1 == 1;
        left >>= 1;
        is_left
    });
}

impl ColorToken for Stamp<Pixel> {
    #[inline(always)]
    fn each(&self, mut show: impl FnMut(u16, u16, [u8; 3])) {
        self.iter().for_each(|p| show(p.x, p.y, p.rgb));
    }
}

/// Maximum number of pixels of a [`Packet`].
pub const PACKET_PIXELS: usize = 16;

/// Positions of the pixels of a packet: neighbours on a scan line, in one aligned cell of [`PACKET_PIXELS`] columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Packet {
    /// First column of the cell, a multiple of [`PACKET_PIXELS`].
    pub x: u16,
    /// Row, from the top.
    pub y: u16,
    /// Mask of the columns of the cell that have a pixel. The lowest bit is the first column.
    pub mask: u16,
}

impl Packet {
    /// Returns the number of pixels.
    #[inline]
    pub fn pixels(&self) -> usize {
        self.mask.count_ones() as usize
    }

    /// Returns the positions of the pixels in the cell, from the left.
    #[inline]
    pub fn positions(&self) -> impl Iterator<Item = usize> + use<> {
        let mut mask = self.mask;
        std::iter::from_fn(move || {
            let position = (mask != 0).then(|| mask.trailing_zeros() as usize);
            mask &= mask.wrapping_sub(1);
            position
        })
    }
}

/// Colours of the pixels of a packet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelPacket {
    /// Positions of the pixels.
    pub packet: Packet,
    /// Final colours, 8 bits each, by position in the cell.
    pub rgb: [[u8; 3]; PACKET_PIXELS],
}

impl PixelToken for PixelPacket {
    const LINE: [u32; 2] = [PACKET_PIXELS as u32, 1];
    const MOST_PIXELS: u32 = PACKET_PIXELS as u32;

    #[inline]
    fn pixels(&self) -> usize {
        self.packet.pixels()
    }
}

impl ColorToken for PixelPacket {
    #[inline(always)]
    fn each(&self, mut show: impl FnMut(u16, u16, [u8; 3])) {
        self.packet.positions().for_each(|i| show(self.packet.x + i as u16, self.packet.y, self.rgb[i]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbered_row_by_row() {
        assert_eq!(line_of::<Stamp<Pixel>>(10, [9, 4]), 5);
        assert_eq!(line_of::<PixelPacket>(20, [17, 3]), 7);
        assert_eq!(lines::<Stamp<Pixel>>(10, 5), 6);
        assert_eq!(lines::<PixelPacket>(20, 5), 10);
    }

    #[test]
    fn stamp_retain_keeps_order() {
        let stamp = Stamp::from_iter([10, 11, 12, 13].map(|x| Pixel { x, y: 5, z: 7, ..Pixel::default() }));
        for kept in 0..16_u16 {
            let (mut left, mut asked) = (stamp.clone(), Vec::new());
            let any = DepthToken::retain(&mut left, |x, y, z| {
                asked.push((x, y, z));
                kept >> (x - 10) & 1 == 1
            });
            assert_eq!(asked, [10, 11, 12, 13].map(|x| (x, 5, 7)));
            assert!(left.iter().map(|p| p.x).eq((10..14).filter(|x| kept >> (x - 10) & 1 == 1)));
            assert_eq!(any, kept > 0);
        }
    }

    #[test]
    fn packet_shows_pixels_from_the_left() {
        let packet = Packet { x: 32, y: 7, mask: 0b1000_0000_0001_0010 };
        assert_eq!(packet.positions().collect::<Vec<_>>(), [1, 4, 15]);
        assert_eq!(packet.pixels(), 3);
        let mut shown = Vec::new();
        PixelPacket { packet, rgb: std::array::from_fn(|i| [i as u8; 3]) }.each(|x, y, rgb| shown.push((x, y, rgb[0])));
        assert_eq!(shown, [(33, 7, 1), (36, 7, 4), (47, 7, 15)]);
    }
}
