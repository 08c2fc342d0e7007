//! Widths of fragments, their samples, and pixels.

use super::control::kind_and_number;
use super::{COORDINATE, LEVEL, NUMBER, SHARE, color, count, position};
use crate::fragment::{NormalIndexes, PictureFlow, PseudoNormals, ShadedFragment, StampLanes};
use crate::packet::{PACKET_PIXELS, Packet, PixelPacket};
use crate::wire_fields::{BitWidth, SignalWidths, WireFields};
use crate::{Attribution, Fragment, MAX_STAMP, Pixel, PixelSet, Stamp, StampSample, StampSamples};

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
