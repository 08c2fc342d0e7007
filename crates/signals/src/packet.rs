//! Pixels that travel together, whatever their shape: what a depth test and a frame buffer ask of a token.

use crate::{Fragment, MAX_STAMP, Pixel, Stamp};
use serde::{Deserialize, Serialize};

/// Has a place on the screen and a depth.
pub trait PixelPlace {
    /// Column, row, depth.
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

/// A token of pixels that lie in one line of a picture's memory: a rectangle of [`LINE_PIXELS`], the same for all tokens of
/// a type, so that a picture that they draw is stored line by line.
pub trait PixelToken {
    /// Width and height of a line \[pixels\]; their product is [`LINE_PIXELS`].
    const LINE: [u32; 2];
    /// Most pixels of a token.
    const MOST_PIXELS: u32;
    /// Pixels in it.
    fn pixels(&self) -> usize;
}

/// Pixels of a line of a picture's memory.
pub const LINE_PIXELS: u32 = 16;

/// Number of a line in the largest picture, [`MAX_PIXELS`](crate::layout::MAX_PIXELS) \[bits\].
pub const LINE_NUMBER: u32 = (crate::layout::MAX_PIXELS / LINE_PIXELS as u64).ilog2();

/// Number of the line that holds pixel `(x, y)` of a picture of this width, lines row by row.
#[inline]
pub fn line_of<T: PixelToken>(width: u32, [x, y]: [u32; 2]) -> u64 {
    let [columns, rows] = T::LINE;
    u64::from(y / rows) * u64::from(width.div_ceil(columns)) + u64::from(x / columns)
}

/// Lines of a picture of this size.
pub fn lines<T: PixelToken>(width: u32, height: u32) -> u64 {
    let [columns, rows] = T::LINE;
    u64::from(width.div_ceil(columns)) * u64::from(height.div_ceil(rows))
}

/// A token whose pixels a depth test looks at.
pub trait DepthToken: PixelToken {
    /// The token goes on though none of its pixels is left: what follows counts tokens.
    const KEPT_WHEN_EMPTY: bool;
    /// Drops the pixels of which `passes` says no, in order, and tells whether any is left.
    fn retain(&mut self, passes: impl FnMut(u16, u16, u32) -> bool) -> bool;
}

/// A token of finished pixels.
pub trait ColorToken: PixelToken {
    /// Shows each pixel: column, row, colour.
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

    /// (Not by `ArrayVec::retain` alone, which asks in two places and guards against a panic in either: 30 instructions more for a
    /// stamp of one pixel.)
    #[inline(always)]
    fn retain(&mut self, mut passes: impl FnMut(u16, u16, u32) -> bool) -> bool {
        let mut left = 0_u32;
        for (i, item) in self.iter().enumerate() {
            let (x, y, z) = item.place();
            left |= u32::from(passes(x, y, z)) << i;
        }
        // Mostly all or none are.
        if left == 0 {
            self.clear();
        } else if left + 1 < 1 << self.len() {
            keep(self, left);
        }
        left != 0
    }
}

/// Drops the items of a stamp whose bit in `left` is not set.
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

/// Most pixels of a [`Packet`].
pub const PACKET_PIXELS: usize = 16;

/// Where the pixels of a packet are: neighbours on a scan line, in one aligned cell of [`PACKET_PIXELS`] columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Packet {
    /// First column of the cell, a multiple of [`PACKET_PIXELS`].
    pub x: u16,
    /// Row.
    pub y: u16,
    /// Columns of the cell that have a pixel, one bit each, the first in the lowest.
    pub mask: u16,
}

impl Packet {
    /// Pixels in it.
    #[inline]
    pub fn pixels(&self) -> usize {
        self.mask.count_ones() as usize
    }

    /// Positions of its pixels in the cell, from the left.
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

/// Colours of a packet's pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelPacket {
    /// Where.
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
    fn a_stamp_is_asked_in_order_and_keeps_the_order_of_what_is_left() {
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
    fn a_packet_shows_its_pixels_from_the_left() {
        let packet = Packet { x: 32, y: 7, mask: 0b1000_0000_0001_0010 };
        assert_eq!(packet.positions().collect::<Vec<_>>(), [1, 4, 15]);
        assert_eq!(packet.pixels(), 3);
        let mut shown = Vec::new();
        PixelPacket { packet, rgb: std::array::from_fn(|i| [i as u8; 3]) }.each(|x, y, rgb| shown.push((x, y, rgb[0])));
        assert_eq!(shown, [(33, 7, 1), (36, 7, 4), (47, 7, 15)]);
    }
}
