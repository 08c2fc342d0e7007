//! Bit widths of tokens in hardware, which give the size of the FIFOs that hold them.
//!
//! Each token type lists its [fields](WireFields). Widths that depend on the configuration are in [`SignalWidths`].

use crate::fragment::{NormalIndexes, PictureFlow, PseudoNormals, ShadedFragment, StampLanes};
use crate::packet::{PACKET_PIXELS, Packet, PixelPacket};
pub use crate::wire_fields::NUMBER;
use crate::wire_fields::{BitWidth, SignalWidths, WireFields};
use crate::{
    Attribution, Control, Draw, Flow, Fragment, Frame, MAX_STAMP, Pixel, PixelSet, Polygon, Stamp, StampSample, StampSamples,
};
use smallvec::{Array, SmallVec};
use std::sync::Arc;

/// Column or row of a picture \[bits\].
pub const COORDINATE: u32 = 16;
/// Colour of three components, 8 bits each \[bits\].
pub const COLOR: u32 = 24;
/// Level of detail of a polygon \[bits\].
const LOD: u32 = 6;
/// MIP level \[bits\].
pub const LEVEL: u32 = 3;
/// Share of a MIP level, in steps of the LOD \[bits\]. It has spare bits because several texels may have a share in the level.
pub const SHARE: u32 = 8;
/// Control token \[bits\]: its kind, and the number of its frame, object or polygon. Set-up registers of the units hold the data of
/// frames, objects and polygons. A FIFO of control tokens alone holds the data of polygons, too.
pub const CONTROL: u32 = 32;

/// A token without data: its arrival is the signal.
impl BitWidth for () {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.flag("signal", token.map(|()| true));
    }
}

impl<T: BitWidth> BitWidth for Arc<T> {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        T::fields(token.map(|token| &**token), widths, wire);
    }

    fn attribution(&self) -> Attribution {
        T::attribution(self)
    }
}

impl BitWidth for f32 {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.real("value", NUMBER, token.copied());
    }
}

/// Double precision exists on the host only. It represents numbers whose width is not specified.
impl BitWidth for f64 {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.double("value", NUMBER, token.copied());
    }
}

/// Lists `count` parts by number, with the items that exist.
fn parts<'a, T: BitWidth + 'a>(count: u32, items: Option<&'a [T]>, widths: &SignalWidths, wire: &mut WireFields) {
    for i in 0..count as usize {
        wire.token(&i.to_string(), items.and_then(|items| items.get(i)), widths);
    }
}

impl<T: BitWidth, const N: usize> BitWidth for [T; N] {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        parts(N as u32, token.map(<[T; N]>::as_slice), widths, wire);
    }
}

/// All items side by side, and their count. A token with more items takes several cycles in the hardware; its wires show the first.
impl<A: Array<Item: BitWidth>> BitWidth for SmallVec<A> {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let most = A::size() as u32;
        wire.number("count", count(most), token.map(|items| items.len().min(A::size()) as u64));
        parts(most, token.map(SmallVec::as_slice), widths, wire);
    }
}

/// One bit distinguishes control from items.
impl<T: BitWidth> BitWidth for Flow<T> {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let (mut item, mut control) = (None, None);
        match token {
            Some(Self::Item(token)) => item = Some(token),
            Some(Self::Control(token)) => control = Some(token),
            None => {}
        }
        wire.flag("item", token.map(|_| item.is_some()));
        wire.one_of(&mut [&mut |wire| Control::fields(control, widths, wire), &mut |wire| T::fields(item, widths, wire)]);
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Control(control) => control.attribution(),
            Self::Item(item) => item.attribution(),
        }
    }
}

/// Kind of a control token \[bits\].
const KIND: u32 = 3;

/// Lists kind and number of a control token.
fn kind_and_number(wire: &mut WireFields, values: Option<(u64, u64)>) {
    wire.number("kind", KIND, values.map(|(kind, _)| kind));
    wire.number("number", CONTROL - KIND, values.map(|(_, number)| number));
}

impl BitWidth for Control {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        kind_and_number(
            wire,
            token.map(|control| match control {
                Self::Frame(frame) => (0, frame.index.into()),
                Self::Object(object) => (1, object.id.into()),
                Self::Polygon(polygon) => (2, polygon.object.into()),
                Self::CodeBook(_) => (3, 0),
                Self::FrameEnd => (4, 0),
                Self::Criterion(_) => (5, 0),
            }),
        );
        let frame = |of: fn(&Frame) -> u32| match token {
            Some(Self::Frame(frame)) => Some(of(frame)),
            _ => None,
        };
        wire.setup("width", COORDINATE, frame(|frame| frame.width));
        wire.setup("height", COORDINATE, frame(|frame| frame.height));
        let polygon = match token {
            Some(Self::Polygon(polygon)) => Some(polygon),
            _ => None,
        };
        wire.setup("bump", 1, polygon.map(|polygon| polygon.bump));
        wire.setup("lod", LOD, polygon.map(|polygon| polygon.lod));
        wire.setup("mapped", 1, polygon.map(|polygon| polygon.material.normal_map.is_some()));
        wire.setup("textured", 1, polygon.map(|polygon| polygon.material.color_texture.is_some()));
        wire.setup("triangles", COORDINATE, polygon.map(|polygon| triangles(polygon)));
        let criterion = match token {
            Some(Self::Criterion(error_bound)) => Some(error_bound.to_bits()),
            _ => None,
        };
        wire.setup("criterion", u64::BITS, criterion);
    }

    fn bits(widths: &SignalWidths) -> u32 {
        CONTROL + widths.polygon
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

/// Returns the number of triangles of a polygon's fan.
pub fn triangles(polygon: &Polygon) -> u64 {
    polygon.vertices.len().saturating_sub(2) as u64
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
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        kind_and_number(
            wire,
            token.map(|draw| match draw {
                Self::Frame(frame) => (0, frame.index.into()),
                Self::Object(object) => (1, object.id.into()),
                Self::Triangle(_) => (2, 0),
                Self::FrameEnd => (4, 0),
            }),
        );
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
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.number("count", count(widths.stamp), token.map(|stamp| stamp.len() as u64));
        parts(widths.stamp, token.map(Stamp::as_slice), widths, wire);
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

/// Lists a position.
pub fn position(wire: &mut WireFields, at: Option<[u16; 2]>) {
    wire.number("x", COORDINATE, at.map(|[x, _]| x));
    wire.number("y", COORDINATE, at.map(|[_, y]| y));
}

/// Lists a colour.
fn color(wire: &mut WireFields, rgb: Option<[u8; 3]>) {
    wire.number("rgb", COLOR, rgb.map(|[r, g, b]| u32::from_le_bytes([r, g, b, 0])));
}

/// Position, depth, two weights, triangle.
impl BitWidth for Fragment {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        position(wire, token.map(|f| [f.x, f.y]));
        wire.number("z", widths.depth, token.map(|f| f.z));
        wire.real("weight_0", NUMBER, token.map(|f| f.weights[0]));
        wire.real("weight_1", NUMBER, token.map(|f| f.weights[1]));
        wire.number("triangle", COORDINATE, token.map(|f| f.triangle));
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// Lists the samples of a stamp: level, share and sampled value of each. A share is a number of steps of 2^-(SHARE - 1).
fn samples<V: StampLanes>(
    samples: Option<&StampSamples<V>>,
    widths: &SignalWidths,
    wire: &mut WireFields,
    value: impl Fn(&mut WireFields, Option<V::Value>),
) {
    wire.number("samples", count(widths.samples), samples.map(|samples| samples.len() as u64));
    for i in 0..widths.samples as usize {
        let sample = samples.and_then(|samples| samples.get(i));
        wire.part(&format!("sample_{i}"), |wire| {
            wire.number("level", LEVEL, sample.map(|sample| sample.level));
            for lane in 0..widths.stamp as usize {
                wire.part(&lane.to_string(), |wire| {
                    let steps = f32::from(1_u16 << (SHARE - 1));
                    wire.number("share", SHARE, sample.map(|sample| (sample.weight[lane] * steps).round() as u64));
                    value(wire, sample.map(|sample| sample.value.lane(lane)));
                });
            }
        });
    }
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
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.token("stamp", token.map(|token| &token.stamp), widths);
        samples(token.map(|token| &token.samples), widths, wire, |wire, normal| {
            for (axis, name) in ["nx", "ny", "nz"].into_iter().enumerate() {
                wire.number(name, widths.normal, normal.map(|normal| normal[axis] as u16));
            }
        });
    }

    fn attribution(&self) -> Attribution {
        sampled(&self.stamp, &self.samples, None)
    }
}

impl BitWidth for NormalIndexes {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.token("stamp", token.map(|token| &token.stamp), widths);
        samples(token.map(|token| &token.samples), widths, wire, |wire, index| wire.number("index", widths.index, index));
    }

    fn attribution(&self) -> Attribution {
        sampled(&self.stamp, &self.samples, Some(|index| index))
    }
}

/// The model keeps brightness in single precision.
impl BitWidth for ShadedFragment {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        Fragment::fields(token.map(|token| &token.fragment), widths, wire);
        wire.real("brightness", widths.brightness, token.map(|token| token.brightness));
        wire.real("highlight", 0, token.map(|token| token.highlight));
    }

    fn attribution(&self) -> Attribution {
        self.fragment.attribution()
    }
}

impl BitWidth for Pixel {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        position(wire, token.map(|pixel| [pixel.x, pixel.y]));
        wire.number("z", widths.depth, token.map(|pixel| pixel.z));
        color(wire, token.map(|pixel| pixel.rgb));
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// A block of 4 x 4 pixels with its mask, or control.
impl BitWidth for PictureFlow {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        let block = match token {
            Some(Self::Pixels(block)) => Some(block),
            _ => None,
        };
        wire.flag("item", token.map(|_| block.is_some()));
        let control = match token {
            Some(Self::Frame(frame)) => Some((0, frame.index.into())),
            Some(Self::Show { last }) => Some((4, u64::from(*last))),
            _ => None,
        };
        wire.one_of(&mut [&mut |wire| kind_and_number(wire, control), &mut |wire| {
            position(wire, block.map(|block| block.at));
            wire.number("mask", 16, block.map(|block| block.mask));
            for i in 0..16 {
                wire.part(&i.to_string(), |wire| color(wire, block.map(|block| block.rgb[i])));
            }
        }]);
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
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        position(wire, token.map(|packet| [packet.x, packet.y]));
        wire.number("mask", PACKET_PIXELS as u32, token.map(|packet| packet.mask));
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::packet([self.x, self.y], self.mask))
    }
}

impl BitWidth for PixelPacket {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        Packet::fields(token.map(|token| &token.packet), widths, wire);
        for i in 0..PACKET_PIXELS {
            wire.part(&i.to_string(), |wire| color(wire, token.map(|token| token.rgb[i])));
        }
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
