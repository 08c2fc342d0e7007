//! How wide the generator's signals are.

use crate::signals::{GradientPacket, IlluminancePacket, LevelPacket, LitSpan, Segment, Span, TexelPacket, TexturePacket};
use basrelief_signals::width::{COORDINATE, NUMBER};
use basrelief_signals::{PACKET_PIXELS, Packet, Signal, Widths};

/// Pixels of a packet.
const PIXELS: u32 = PACKET_PIXELS as u32;
/// Component of a colour with a fraction.
const COMPONENT: u32 = 16;
/// U, V, W of a point.
const POINT: u32 = 3 * NUMBER;

/// Row, first column, pixels, triangle and two flags; U, V, W at both ends and per pixel; depth and its change; two weights at
/// both ends.
impl Signal for Span {
    fn bits(widths: &Widths) -> u32 {
        4 * COORDINATE + 2 + 3 * POINT + 2 * widths.depth + 4 * NUMBER
    }
}

/// Row, first column, pixels, triangle and a flag; two weights at both ends.
impl Signal for LitSpan {
    fn bits(_: &Widths) -> u32 {
        4 * COORDINATE + 1 + 4 * NUMBER
    }
}

/// Its span, both division points, pixels, two flags.
impl Signal for Segment {
    fn bits(widths: &Widths) -> u32 {
        Span::bits(widths) + 3 * COORDINATE + 2
    }
}

/// Place, division points, and u, v and depth by pixel.
impl Signal for TexelPacket {
    fn bits(widths: &Widths) -> u32 {
        Packet::bits(widths) + PIXELS * (1 + 2 * widths.texture + widths.depth)
    }
}

/// Place, and du and dv by pixel.
impl Signal for GradientPacket {
    fn bits(widths: &Widths) -> u32 {
        Packet::bits(widths) + PIXELS * 2 * widths.texture
    }
}

/// Level by pixel: 4 bits, and 8 of a fraction.
impl Signal for LevelPacket {
    fn bits(_: &Widths) -> u32 {
        PIXELS * 12
    }
}

/// Place, division points, and RGBA by pixel.
impl Signal for TexturePacket {
    fn bits(widths: &Widths) -> u32 {
        Packet::bits(widths) + PIXELS * (1 + 4 * COMPONENT)
    }
}

/// Place, and RGBA by pixel.
impl Signal for IlluminancePacket {
    fn bits(widths: &Widths) -> u32 {
        Packet::bits(widths) + PIXELS * 4 * COMPONENT
    }
}
