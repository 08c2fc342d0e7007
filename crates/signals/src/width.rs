//! How wide signals are in hardware: what a FIFO takes whose slots hold them.
//!
//! A signal states its bits; what depends on the configuration it finds in [`Widths`].

use crate::fragment::{Indexes, PictureFlow, PseudoNormals, Shaded};
use crate::packet::{PACKET_PIXELS, Packet, PixelPacket};
use crate::{Control, Draw, Flow, Fragment, Pixel, Stamp};
use smallvec::{Array, SmallVec};
use std::sync::Arc;

/// Widths that a machine's configuration decides \[bits\], and how many items travel side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Widths {
    /// Depth value.
    pub depth: u32,
    /// Fragments of a [`Stamp`].
    pub stamp: u32,
    /// Samples of a fragment.
    pub samples: u32,
    /// Component of a pseudo-normal N'.
    pub normal: u32,
    /// Index of a reference normal.
    pub index: u32,
    /// Brightness of a fragment, all its values.
    pub brightness: u32,
    /// Texture coordinate.
    pub texture: u32,
}

impl Default for Widths {
    fn default() -> Self {
        Self { depth: 24, stamp: 4, samples: 1, normal: 16, index: 8, brightness: 8, texture: NUMBER }
    }
}

/// A number in single precision.
pub const NUMBER: u32 = 32;
/// Column or row of a picture.
pub const COORDINATE: u32 = 16;
/// Colour, 8 bits each.
pub const COLOR: u32 = 24;
/// MIP level.
pub const LEVEL: u32 = 3;
/// Share of a MIP level, in steps of the LOD, and finer where several texels have a share in it.
pub const SHARE: u32 = 8;
/// Control: kind, and the number of what it is about. Polygons, objects and frames themselves stand in set-up registers of the
/// units that use them.
pub const CONTROL: u32 = 32;

/// What travels on a wire.
pub trait Signal {
    /// Its bits.
    fn bits(widths: &Widths) -> u32;
}

/// Nothing but that it comes.
impl Signal for () {
    fn bits(_: &Widths) -> u32 {
        1
    }
}

impl<T: Signal> Signal for Arc<T> {
    fn bits(widths: &Widths) -> u32 {
        T::bits(widths)
    }
}

impl Signal for f32 {
    fn bits(_: &Widths) -> u32 {
        NUMBER
    }
}

/// Double precision is the host's: it stands for numbers whose width nobody has fixed.
impl Signal for f64 {
    fn bits(_: &Widths) -> u32 {
        NUMBER
    }
}

impl<T: Signal, const N: usize> Signal for [T; N] {
    fn bits(widths: &Widths) -> u32 {
        N as u32 * T::bits(widths)
    }
}

/// As many as lie side by side, and how many of them there are.
impl<A: Array<Item: Signal>> Signal for SmallVec<A> {
    fn bits(widths: &Widths) -> u32 {
        let most = A::size() as u32;
        most * A::Item::bits(widths) + count(most)
    }
}

/// A bit tells control from items.
impl<T: Signal> Signal for Flow<T> {
    fn bits(widths: &Widths) -> u32 {
        1 + T::bits(widths).max(CONTROL)
    }
}

impl Signal for Control {
    fn bits(_: &Widths) -> u32 {
        CONTROL
    }
}

impl Signal for Draw {
    fn bits(_: &Widths) -> u32 {
        CONTROL
    }
}

/// Items, and how many there are.
impl<T: Signal> Signal for Stamp<T> {
    fn bits(widths: &Widths) -> u32 {
        widths.stamp * T::bits(widths) + count(widths.stamp)
    }
}

/// Bits that count from 0 up to `most`.
pub fn count(most: u32) -> u32 {
    u32::BITS - most.leading_zeros()
}

/// Place, depth, two weights, triangle.
impl Signal for Fragment {
    fn bits(widths: &Widths) -> u32 {
        2 * COORDINATE + widths.depth + 2 * NUMBER + COORDINATE
    }
}

/// Samples of the fragments of a stamp: level and share of each, and what was sampled.
fn samples(widths: &Widths, value: u32) -> u32 {
    widths.samples * (LEVEL + widths.stamp * (SHARE + value)) + count(widths.samples)
}

impl Signal for PseudoNormals {
    fn bits(widths: &Widths) -> u32 {
        Stamp::<Fragment>::bits(widths) + samples(widths, 3 * widths.normal)
    }
}

impl Signal for Indexes {
    fn bits(widths: &Widths) -> u32 {
        Stamp::<Fragment>::bits(widths) + samples(widths, widths.index)
    }
}

impl Signal for Shaded {
    fn bits(widths: &Widths) -> u32 {
        Fragment::bits(widths) + widths.brightness
    }
}

impl Signal for Pixel {
    fn bits(widths: &Widths) -> u32 {
        2 * COORDINATE + widths.depth + COLOR
    }
}

/// Block of 4 x 4 pixels and a mask of them, or control.
impl Signal for PictureFlow {
    fn bits(_: &Widths) -> u32 {
        1 + (2 * COORDINATE + 16 * (1 + COLOR)).max(CONTROL)
    }
}

/// First column, row, mask.
impl Signal for Packet {
    fn bits(_: &Widths) -> u32 {
        2 * COORDINATE + PACKET_PIXELS as u32
    }
}

impl Signal for PixelPacket {
    fn bits(widths: &Widths) -> u32 {
        Packet::bits(widths) + PACKET_PIXELS as u32 * COLOR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stamp_is_as_wide_as_it_has_lanes() {
        let one = Widths { stamp: 1, ..Widths::default() };
        assert_eq!(Fragment::bits(&one), 32 + 24 + 64 + 16);
        assert_eq!(Stamp::<Fragment>::bits(&one), Fragment::bits(&one) + 1);
        assert_eq!(Stamp::<Fragment>::bits(&Widths::default()), 4 * Fragment::bits(&one) + 3);
    }

    #[test]
    fn a_finer_table_widens_indexes_and_nothing_else() {
        let (coarse, fine) = (Widths { index: 4, ..Widths::default() }, Widths { index: 10, ..Widths::default() });
        assert_eq!(Indexes::bits(&fine) - Indexes::bits(&coarse), 4 * 6);
        assert_eq!(PseudoNormals::bits(&fine), PseudoNormals::bits(&coarse));
    }

    #[test]
    fn control_sets_the_least_width_of_a_flow() {
        assert_eq!(Flow::<()>::bits(&Widths::default()), 33);
    }
}
