//! How wide signals are in hardware: what a FIFO takes whose slots hold them.
//!
//! A signal states its bits; what depends on the configuration it finds in [`Widths`].

use crate::fragment::{Indexes, Lanes, PictureFlow, PseudoNormals, Shaded};
use crate::packet::{PACKET_PIXELS, Packet, PixelPacket};
use crate::{About, Control, Draw, Flow, Fragment, Frame, MAX_STAMP, Pixel, Pixels, Polygon, Sample, Samples, Stamp};
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
    /// What it is about.
    fn about(&self) -> About {
        About::Made
    }
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

    fn about(&self) -> About {
        T::about(self)
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

    fn about(&self) -> About {
        match self {
            Self::Control(control) => control.about(),
            Self::Item(item) => item.about(),
        }
    }
}

impl Signal for Control {
    fn bits(_: &Widths) -> u32 {
        CONTROL
    }

    fn about(&self) -> About {
        match self {
            Self::Frame(frame) => About::frame(frame),
            Self::Object(object) => About::Object(object.id),
            Self::Polygon(polygon) => About::polygon(polygon),
            Self::CodeBook(_) | Self::Criterion(_) => About::Made,
            Self::FrameEnd => About::Whole,
        }
    }
}

impl About {
    /// A frame begins.
    pub fn frame(&Frame { index, width, height, .. }: &Frame) -> Self {
        Self::Frame { index, size: [width, height] }
    }

    /// A polygon begins.
    pub fn polygon(polygon: &Arc<Polygon>) -> Self {
        Self::Polygon(Arc::as_ptr(polygon) as usize as u64)
    }
}

impl Signal for Draw {
    fn bits(_: &Widths) -> u32 {
        CONTROL
    }

    fn about(&self) -> About {
        match self {
            Self::Frame(frame) => About::frame(frame),
            Self::Object(object) => About::Object(object.id),
            Self::Triangle(_) => About::Made,
            Self::FrameEnd => About::Whole,
        }
    }
}

/// Items, and how many there are.
impl<T: Signal> Signal for Stamp<T> {
    fn bits(widths: &Widths) -> u32 {
        widths.stamp * T::bits(widths) + count(widths.stamp)
    }

    /// All pixels of its items.
    fn about(&self) -> About {
        About::Pixels(Pixels::stamp(self.iter().filter_map(|item| match item.about() {
            About::Pixels(pixel) => Some(pixel.first()),
            _ => None,
        })))
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

    fn about(&self) -> About {
        About::Pixels(Pixels::one(self.x, self.y))
    }
}

/// Samples of the fragments of a stamp: level and share of each, and what was sampled.
fn samples(widths: &Widths, value: u32) -> u32 {
    widths.samples * (LEVEL + widths.stamp * (SHARE + value)) + count(widths.samples)
}

/// The sample of each fragment of a stamp that has the largest share in it.
fn heaviest<V>(samples: &Samples<V>) -> [Option<&Sample<V>>; MAX_STAMP] {
    let heavier = |lane: usize| move |a: &&Sample<V>, b: &&Sample<V>| a.weight[lane].total_cmp(&b.weight[lane]);
    std::array::from_fn(|lane| samples.iter().max_by(heavier(lane)))
}

fn sampled<V: Lanes>(stamp: &Stamp<Fragment>, samples: &Samples<V>, entry: Option<fn(V::Value) -> u16>) -> About {
    let heaviest = heaviest(samples);
    let levels = heaviest.map(|sample| sample.map_or(0, |sample| sample.level));
    let lanes = [0, 1, 2, 3];
    let entries = entry.map(|entry| lanes.map(|lane| heaviest[lane].map_or(0, |sample| entry(sample.value.lane(lane)))));
    let mut pixels = Pixels::stamp(stamp.iter().map(|f| [f.x, f.y]));
    (pixels.levels, pixels.entries) = (Some(levels), entries);
    About::Pixels(pixels)
}

impl Signal for PseudoNormals {
    fn bits(widths: &Widths) -> u32 {
        Stamp::<Fragment>::bits(widths) + samples(widths, 3 * widths.normal)
    }

    fn about(&self) -> About {
        sampled(&self.stamp, &self.samples, None)
    }
}

impl Signal for Indexes {
    fn bits(widths: &Widths) -> u32 {
        Stamp::<Fragment>::bits(widths) + samples(widths, widths.index)
    }

    fn about(&self) -> About {
        sampled(&self.stamp, &self.samples, Some(|index| index))
    }
}

impl Signal for Shaded {
    fn bits(widths: &Widths) -> u32 {
        Fragment::bits(widths) + widths.brightness
    }

    fn about(&self) -> About {
        self.fragment.about()
    }
}

impl Signal for Pixel {
    fn bits(widths: &Widths) -> u32 {
        2 * COORDINATE + widths.depth + COLOR
    }

    fn about(&self) -> About {
        About::Pixels(Pixels::one(self.x, self.y))
    }
}

/// Block of 4 x 4 pixels and a mask of them, or control.
impl Signal for PictureFlow {
    fn bits(_: &Widths) -> u32 {
        1 + (2 * COORDINATE + 16 * (1 + COLOR)).max(CONTROL)
    }

    fn about(&self) -> About {
        match self {
            Self::Frame(frame) => About::frame(frame),
            Self::Pixels(block) => About::Pixels(Pixels::block(block.at, block.mask)),
            Self::Show { .. } => About::Whole,
        }
    }
}

/// First column, row, mask.
impl Signal for Packet {
    fn bits(_: &Widths) -> u32 {
        2 * COORDINATE + PACKET_PIXELS as u32
    }

    fn about(&self) -> About {
        About::Pixels(Pixels::packet([self.x, self.y], self.mask))
    }
}

impl Signal for PixelPacket {
    fn bits(widths: &Widths) -> u32 {
        Packet::bits(widths) + PACKET_PIXELS as u32 * COLOR
    }

    fn about(&self) -> About {
        self.packet.about()
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
