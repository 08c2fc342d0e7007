//! Bit widths of the generator's tokens.

use crate::signals::{
    DivisionPoint, FixedCoordinates, GradientPacket, IlluminancePacket, LevelPacket, LineSegment, LitSpan, ScanSpan, TexelPacket,
    TexturePacket,
};
use basrelief_signals::width::{COORDINATE, NUMBER};
use basrelief_signals::{Attribution, BitWidth, PACKET_PIXELS, Packet, PixelSet, SignalWidths};

/// Pixels of a packet.
const PIXELS: u32 = PACKET_PIXELS as u32;
/// Component of a colour with a fraction \[bits\].
const COMPONENT: u32 = 16;
/// Exponent of a floating-point number, and the scale of u and v \[bits\], as in single precision.
const EXPONENT: u32 = 8;

/// U, V, W, with as many significant bits as their quotients.
impl BitWidth for DivisionPoint {
    fn bits(widths: &SignalWidths) -> u32 {
        3 * (widths.texture + EXPONENT)
    }
}

/// u and v.
impl BitWidth for FixedCoordinates {
    fn bits(widths: &SignalWidths) -> u32 {
        2 * widths.texture
    }
}

/// Row, first column, pixels, triangle and two flags; two scales; U, V, W at both ends and per pixel; depth and its change; two
/// weights at both ends.
impl BitWidth for ScanSpan {
    fn bits(widths: &SignalWidths) -> u32 {
        4 * COORDINATE + 2 + 2 * EXPONENT + 3 * DivisionPoint::bits(widths) + 2 * widths.depth + 4 * NUMBER
    }

    fn attribution(&self) -> Attribution {
        row([self.x, self.y], self.count, self.backwards)
    }
}

/// Row, first column, pixels, triangle and a flag; two weights at both ends.
impl BitWidth for LitSpan {
    fn bits(_: &SignalWidths) -> u32 {
        4 * COORDINATE + 1 + 4 * NUMBER
    }

    fn attribution(&self) -> Attribution {
        row([self.x, self.y], self.count, self.backwards)
    }
}

/// Its span, both division points, pixels, two flags.
impl BitWidth for LineSegment {
    fn bits(widths: &SignalWidths) -> u32 {
        ScanSpan::bits(widths) + 3 * COORDINATE + 2
    }

    fn attribution(&self) -> Attribution {
        row([self.span.column(self.from), self.span.y], self.walk, self.span.backwards)
    }
}

/// Position, division points, and u, v and depth by pixel.
impl BitWidth for TexelPacket {
    fn bits(widths: &SignalWidths) -> u32 {
        Packet::bits(widths) + PIXELS * (1 + 2 * widths.texture + widths.depth)
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

/// Position, and du and dv by pixel.
impl BitWidth for GradientPacket {
    fn bits(widths: &SignalWidths) -> u32 {
        Packet::bits(widths) + PIXELS * 2 * widths.texture
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

/// Level by pixel: 4 bits, and 8 of a fraction.
impl BitWidth for LevelPacket {
    fn bits(_: &SignalWidths) -> u32 {
        PIXELS * 12
    }

    /// Returns the nearest whole levels.
    fn attribution(&self) -> Attribution {
        let bits = |level: f32| u64::from((level + 0.5).clamp(0.0, 15.0) as u8);
        Attribution::Levels((0..).zip(self.level).map(|(i, level)| bits(level) << (4 * i)).sum())
    }
}

/// Position, division points, and RGBA by pixel.
impl BitWidth for TexturePacket {
    fn bits(widths: &SignalWidths) -> u32 {
        Packet::bits(widths) + PIXELS * (1 + 4 * COMPONENT)
    }

    fn attribution(&self) -> Attribution {
        self.packet.attribution()
    }
}

/// Position, and RGBA by pixel.
impl BitWidth for IlluminancePacket {
    fn bits(widths: &SignalWidths) -> u32 {
        Packet::bits(widths) + PIXELS * 4 * COMPONENT
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
