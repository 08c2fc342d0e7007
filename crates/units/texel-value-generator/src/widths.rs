//! Bit widths of the generator's tokens.

use crate::signals::{
    DivisionPoint, FixedCoordinates, GradientPacket, IlluminancePacket, LevelPacket, LineSegment, LitSpan, ScanSpan, TexelPacket,
    TexturePacket, Uvw,
};
use basrelief_signals::width::{COORDINATE, NUMBER, position};
use basrelief_signals::{Attribution, BitWidth, PACKET_PIXELS, PixelSet, SignalWidths, WireFields};

/// Pixels of a packet.
const PIXELS: u32 = PACKET_PIXELS as u32;
/// Component of a colour with a fraction \[bits\].
const COMPONENT: u32 = 16;
/// Exponent of a floating-point number, and the scale of u and v \[bits\], as in single precision.
const EXPONENT: u32 = 8;

/// Lists row, first column, pixels, triangle and direction of a span.
fn row_fields(wire: &mut WireFields, span: Option<([u16; 4], bool)>) {
    position(wire, span.map(|([x, y, ..], _)| [x, y]));
    wire.number("pixels", COORDINATE, span.map(|([.., pixels, _], _)| pixels));
    wire.number("triangle", COORDINATE, span.map(|([.., triangle], _)| triangle));
    wire.flag("backwards", span.map(|(_, backwards)| backwards));
}

/// Lists two weights at both ends.
fn weights(wire: &mut WireFields, weights: Option<[[f32; 2]; 2]>) {
    for i in 0..4 {
        wire.real(&format!("weight_{i}"), NUMBER, weights.map(|weights| weights[i / 2][i % 2]));
    }
}

/// Lists RGBA of the pixels of a packet.
fn components(wire: &mut WireFields, rgba: Option<&[[u16; 4]; PACKET_PIXELS]>) {
    for i in 0..PACKET_PIXELS {
        for (c, name) in ["red", "green", "blue", "alpha"].into_iter().enumerate() {
            wire.number(&format!("{i}_{name}"), COMPONENT, rgba.map(|rgba| rgba[i][c]));
        }
    }
}

/// U, V, W, with as many significant bits as their quotients.
impl BitWidth for DivisionPoint {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        for (i, name) in ["u", "v", "w"].into_iter().enumerate() {
            wire.double(name, widths.texture + EXPONENT, token.map(|point| point.0[i]));
        }
    }
}

/// u and v.
impl BitWidth for FixedCoordinates {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        for (i, name) in ["u", "v"].into_iter().enumerate() {
            wire.number(name, widths.texture, token.map(|quotient| quotient.0[i] as u64));
        }
    }
}

/// Row, first column, pixels, triangle and two flags; two scales; U, V, W at both ends and per pixel; depth and its change; two
/// weights at both ends.
impl BitWidth for ScanSpan {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let of = |wire: &mut WireFields, name: &str, value: fn(&Self) -> Uvw| {
            wire.token(name, token.map(|span| DivisionPoint(value(span))).as_ref(), widths);
        };
        of(wire, "first", |span| span.ends[0]);
        of(wire, "last", |span| span.ends[1]);
        of(wire, "step", |span| span.step);
        row_fields(wire, token.map(|s| ([s.x, s.y, s.count, s.triangle], s.backwards)));
        wire.flag("textured", token.map(|span| span.textured));
        for i in 0..2 {
            wire.number(&format!("scale_{i}"), EXPONENT, token.map(|span| span.scale[i] as u64));
        }
        for i in 0..2 {
            wire.double(&format!("depth_{i}"), widths.depth, token.map(|span| span.depth[i]));
        }
        weights(wire, token.map(|span| span.weights));
    }

    fn attribution(&self) -> Attribution {
        row([self.x, self.y], self.count, self.backwards)
    }
}

/// Row, first column, pixels, triangle and a flag; two weights at both ends.
impl BitWidth for LitSpan {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        row_fields(wire, token.map(|s| ([s.x, s.y, s.count, s.triangle], s.backwards)));
        weights(wire, token.map(|span| span.weights));
    }

    fn attribution(&self) -> Attribution {
        row([self.x, self.y], self.count, self.backwards)
    }
}

/// Its span, both division points, pixels, two flags.
impl BitWidth for LineSegment {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.token("span", token.map(|segment| &segment.span), widths);
        wire.number("from", COORDINATE, token.map(|segment| segment.from));
        wire.number("to", COORDINATE, token.map(|segment| segment.to));
        wire.number("walk", COORDINATE, token.map(|segment| segment.walk));
        wire.flag("exact", token.map(|segment| segment.exact));
        wire.flag("fresh", token.map(|segment| segment.fresh));
    }

    fn attribution(&self) -> Attribution {
        row([self.span.column(self.from), self.span.y], self.walk, self.span.backwards)
    }
}

/// Position, division points, and u, v and depth by pixel.
impl BitWidth for TexelPacket {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.token("packet", token.map(|token| &token.packet), widths);
        wire.number("points", PIXELS, token.map(|token| token.points));
        for i in 0..PACKET_PIXELS {
            wire.part(&i.to_string(), |wire| {
                wire.real("u", widths.texture, token.map(|token| token.uv[i][0]));
                wire.real("v", widths.texture, token.map(|token| token.uv[i][1]));
                wire.number("z", widths.depth, token.map(|token| token.z[i]));
            });
        }
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

/// Position, and du and dv by pixel.
impl BitWidth for GradientPacket {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.token("packet", token.map(|token| &token.packet), widths);
        for i in 0..PACKET_PIXELS {
            wire.part(&i.to_string(), |wire| {
                wire.real("du", widths.texture, token.map(|token| token.gradient[i][0]));
                wire.real("dv", widths.texture, token.map(|token| token.gradient[i][1]));
            });
        }
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

/// Level by pixel: 4 bits, and 8 of a fraction.
impl BitWidth for LevelPacket {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        for i in 0..PACKET_PIXELS {
            wire.real(&format!("{i}_level"), 12, token.map(|token| token.level[i]));
        }
    }

    /// Returns the nearest whole levels.
    fn attribution(&self) -> Attribution {
        let bits = |level: f32| u64::from((level + 0.5).clamp(0.0, 15.0) as u8);
        Attribution::Levels((0..).zip(self.level).map(|(i, level)| bits(level) << (4 * i)).sum())
    }
}

/// Position, division points, and RGBA by pixel.
impl BitWidth for TexturePacket {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.token("packet", token.map(|token| &token.packet), widths);
        wire.number("points", PIXELS, token.map(|token| token.points));
        components(wire, token.map(|token| &token.rgba));
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

/// Position, and RGBA by pixel.
impl BitWidth for IlluminancePacket {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.token("packet", token.map(|token| &token.packet), widths);
        components(wire, token.map(|token| &token.rgba));
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

/// Returns the attribution of `count` pixels from this column on, or up to it.
fn row([x, y]: [u16; 2], count: u16, backwards: bool) -> Attribution {
    let first = if backwards { x.saturating_sub(count.saturating_sub(1)) } else { x };
    Attribution::Pixels(PixelSet::row([first, y], count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::{DivisionPoints, Quotients};

    #[test]
    fn coordinate_bits_set_width_of_every_carrier() {
        let [narrow, wide] = [20, 32].map(|texture| SignalWidths { texture, ..SignalWidths::default() });
        let wider = |bits: fn(&SignalWidths) -> u32| bits(&wide) - bits(&narrow);
        assert_eq!(wider(Quotients::bits), 2 * 2 * 12, "two points");
        assert_eq!(wider(DivisionPoints::bits), 2 * 3 * 12);
        assert_eq!(wider(ScanSpan::bits), 3 * 3 * 12);
        assert_eq!(wider(LineSegment::bits), 3 * 3 * 12);
        assert_eq!(wider(TexelPacket::bits), PIXELS * 2 * 12);
        assert_eq!(wider(GradientPacket::bits), PIXELS * 2 * 12);
    }
}
