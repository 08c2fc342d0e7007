//! Bit widths of tokens in hardware, which give the size of the FIFOs that hold them.
//!
//! Each token type computes its bits. Widths that depend on the configuration are in [`SignalWidths`].

use crate::fragment::{NormalIndexes, PictureFlow, PseudoNormals, ShadedFragment, StampLanes};
use crate::packet::{PACKET_PIXELS, Packet, PixelPacket};
use crate::{
    Attribution, Control, Draw, Flow, Fragment, Frame, MAX_STAMP, Pixel, PixelSet, Polygon, Stamp, StampSample, StampSamples,
};
use smallvec::{Array, SmallVec};
use std::sync::Arc;

/// Bit widths that a machine's configuration decides, and the number of items that travel side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignalWidths {
    /// Depth value \[bits\].
    pub depth: u32,
    /// Fragments per [`Stamp`].
    pub stamp: u32,
    /// Samples per fragment.
    pub samples: u32,
    /// Component of a pseudo-normal N' \[bits\].
    pub normal: u32,
    /// Index of a reference normal \[bits\].
    pub index: u32,
    /// All brightness values of a fragment \[bits\].
    pub brightness: u32,
    /// Texture coordinate \[bits\].
    pub texture: u32,
}

impl Default for SignalWidths {
    fn default() -> Self {
        Self { depth: 24, stamp: 4, samples: 1, normal: 16, index: 8, brightness: 8, texture: NUMBER }
    }
}

/// Single-precision number \[bits\].
pub const NUMBER: u32 = 32;
/// Column or row of a picture \[bits\].
pub const COORDINATE: u32 = 16;
/// Colour of three components, 8 bits each \[bits\].
pub const COLOR: u32 = 24;
/// MIP level \[bits\].
pub const LEVEL: u32 = 3;
/// Share of a MIP level, in steps of the LOD \[bits\]. It has spare bits because several texels may have a share in the level.
pub const SHARE: u32 = 8;
/// Control token \[bits\]: its kind, and the number of its frame, object or polygon. Set-up registers of the units hold the data of
/// frames, objects and polygons.
pub const CONTROL: u32 = 32;

/// A token type with a width on a wire and an attribution.
pub trait BitWidth {
    /// Returns the width of the token \[bits\].
    fn bits(widths: &SignalWidths) -> u32;
    /// Returns the attribution of the token.
    fn attribution(&self) -> Attribution {
        Attribution::Inherited
    }
}

/// A token without data: its arrival is the signal.
impl BitWidth for () {
    fn bits(_: &SignalWidths) -> u32 {
        1
    }
}

impl<T: BitWidth> BitWidth for Arc<T> {
    fn bits(widths: &SignalWidths) -> u32 {
        T::bits(widths)
    }

    fn attribution(&self) -> Attribution {
        T::attribution(self)
    }
}

impl BitWidth for f32 {
    fn bits(_: &SignalWidths) -> u32 {
        NUMBER
    }
}

/// Double precision exists on the host only. It represents numbers whose width is not specified.
impl BitWidth for f64 {
    fn bits(_: &SignalWidths) -> u32 {
        NUMBER
    }
}

impl<T: BitWidth, const N: usize> BitWidth for [T; N] {
    fn bits(widths: &SignalWidths) -> u32 {
        N as u32 * T::bits(widths)
    }
}

/// The width is that of all items side by side, and of their count.
impl<A: Array<Item: BitWidth>> BitWidth for SmallVec<A> {
    fn bits(widths: &SignalWidths) -> u32 {
        let most = A::size() as u32;
        most * A::Item::bits(widths) + count(most)
    }
}

/// One bit distinguishes control from items.
impl<T: BitWidth> BitWidth for Flow<T> {
    fn bits(widths: &SignalWidths) -> u32 {
        1 + T::bits(widths).max(CONTROL)
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Control(control) => control.attribution(),
            Self::Item(item) => item.attribution(),
        }
    }
}

impl BitWidth for Control {
    fn bits(_: &SignalWidths) -> u32 {
        CONTROL
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Object(object) => Attribution::Object(object.id),
            Self::Polygon(polygon) => Attribution::polygon(polygon),
            Self::CodeBook(_) | Self::Criterion(_) => Attribution::Inherited,
            Self::FrameEnd => Attribution::Whole,
        }
    }
}

impl Attribution {
    /// Returns the attribution of a token that begins this frame.
    pub fn frame(&Frame { index, width, height, .. }: &Frame) -> Self {
        Self::Frame { index, size: [width, height] }
    }

    /// Returns the attribution of a token that begins this polygon.
    pub fn polygon(polygon: &Arc<Polygon>) -> Self {
        Self::Polygon(Arc::as_ptr(polygon) as usize as u64)
    }
}

impl BitWidth for Draw {
    fn bits(_: &SignalWidths) -> u32 {
        CONTROL
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Object(object) => Attribution::Object(object.id),
            Self::Triangle(_) => Attribution::Inherited,
            Self::FrameEnd => Attribution::Whole,
        }
    }
}

/// Items and their count.
impl<T: BitWidth> BitWidth for Stamp<T> {
    fn bits(widths: &SignalWidths) -> u32 {
        widths.stamp * T::bits(widths) + count(widths.stamp)
    }

    /// Returns all pixels of the items.
    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::stamp(self.iter().filter_map(|item| match item.attribution() {
            Attribution::Pixels(pixel) => Some(pixel.first()),
            _ => None,
        })))
    }
}

/// Returns the bits of a counter from 0 to `most`.
pub fn count(most: u32) -> u32 {
    u32::BITS - most.leading_zeros()
}

/// Position, depth, two weights, triangle.
impl BitWidth for Fragment {
    fn bits(widths: &SignalWidths) -> u32 {
        2 * COORDINATE + widths.depth + 2 * NUMBER + COORDINATE
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// Returns the bits of the samples of a stamp: level, share and sampled value of each.
fn samples(widths: &SignalWidths, value: u32) -> u32 {
    widths.samples * (LEVEL + widths.stamp * (SHARE + value)) + count(widths.samples)
}

/// Returns, for each fragment of a stamp, the sample with the largest share.
fn heaviest<V>(samples: &StampSamples<V>) -> [Option<&StampSample<V>>; MAX_STAMP] {
    let heavier = |lane: usize| move |a: &&StampSample<V>, b: &&StampSample<V>| a.weight[lane].total_cmp(&b.weight[lane]);
    std::array::from_fn(|lane| samples.iter().max_by(heavier(lane)))
}

fn sampled<V: StampLanes>(stamp: &Stamp<Fragment>, samples: &StampSamples<V>, entry: Option<fn(V::Value) -> u16>) -> Attribution {
    let heaviest = heaviest(samples);
    let levels = heaviest.map(|sample| sample.map_or(0, |sample| sample.level));
    let lanes = [0, 1, 2, 3];
    let entries = entry.map(|entry| lanes.map(|lane| heaviest[lane].map_or(0, |sample| entry(sample.value.lane(lane)))));
    let mut pixels = PixelSet::stamp(stamp.iter().map(|f| [f.x, f.y]));
    (pixels.levels, pixels.entries) = (Some(levels), entries);
    Attribution::Pixels(pixels)
}

impl BitWidth for PseudoNormals {
    fn bits(widths: &SignalWidths) -> u32 {
        Stamp::<Fragment>::bits(widths) + samples(widths, 3 * widths.normal)
    }

    fn attribution(&self) -> Attribution {
        sampled(&self.stamp, &self.samples, None)
    }
}

impl BitWidth for NormalIndexes {
    fn bits(widths: &SignalWidths) -> u32 {
        Stamp::<Fragment>::bits(widths) + samples(widths, widths.index)
    }

    fn attribution(&self) -> Attribution {
        sampled(&self.stamp, &self.samples, Some(|index| index))
    }
}

impl BitWidth for ShadedFragment {
    fn bits(widths: &SignalWidths) -> u32 {
        Fragment::bits(widths) + widths.brightness
    }

    fn attribution(&self) -> Attribution {
        self.fragment.attribution()
    }
}

impl BitWidth for Pixel {
    fn bits(widths: &SignalWidths) -> u32 {
        2 * COORDINATE + widths.depth + COLOR
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// A block of 4 x 4 pixels with its mask, or control.
impl BitWidth for PictureFlow {
    fn bits(_: &SignalWidths) -> u32 {
        1 + (2 * COORDINATE + 16 * (1 + COLOR)).max(CONTROL)
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Pixels(block) => Attribution::Pixels(PixelSet::block(block.at, block.mask)),
            Self::Show { .. } => Attribution::Whole,
        }
    }
}

/// First column, row, mask.
impl BitWidth for Packet {
    fn bits(_: &SignalWidths) -> u32 {
        2 * COORDINATE + PACKET_PIXELS as u32
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::packet([self.x, self.y], self.mask))
    }
}

impl BitWidth for PixelPacket {
    fn bits(widths: &SignalWidths) -> u32 {
        Packet::bits(widths) + PACKET_PIXELS as u32 * COLOR
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamp_width_follows_lanes() {
        let one = SignalWidths { stamp: 1, ..SignalWidths::default() };
        assert_eq!(Fragment::bits(&one), 32 + 24 + 64 + 16);
        assert_eq!(Stamp::<Fragment>::bits(&one), Fragment::bits(&one) + 1);
        assert_eq!(Stamp::<Fragment>::bits(&SignalWidths::default()), 4 * Fragment::bits(&one) + 3);
    }

    #[test]
    fn finer_table_widens_only_indexes() {
        let (coarse, fine) =
            (SignalWidths { index: 4, ..SignalWidths::default() }, SignalWidths { index: 10, ..SignalWidths::default() });
        assert_eq!(NormalIndexes::bits(&fine) - NormalIndexes::bits(&coarse), 4 * 6);
        assert_eq!(PseudoNormals::bits(&fine), PseudoNormals::bits(&coarse));
    }

    #[test]
    fn control_sets_minimum_flow_width() {
        assert_eq!(Flow::<()>::bits(&SignalWidths::default()), 33);
    }
}
