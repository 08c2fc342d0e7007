//! State of the approximate calculator (310a) between steps.

use super::DisplacementStats;
use crate::signals::{FixedCoordinates, GradientPacket, LineSegment, Quotients, TexelPacket};
use basrelief_signals::{Flow, PACKET_PIXELS, Packet};
use serde::{Deserialize, Serialize};

/// Counters of the approximate calculator (310a).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ApproximateCalculatorCounters {
    /// Products of a difference and the reciprocal of a length, two per segment.
    pub multiplications: u64,
    /// Reciprocals 1 / W for derivatives at pixels, for `mip.per = pixel` or segments of one pixel.
    pub gradient_reciprocals: u64,
    /// Displacements of every pixel with a texture, including hidden ones.
    pub displacements: DisplacementStats,
}

/// State of the approximate calculator (310a) between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ApproximateCalculatorState {
    /// Segment being walked.
    pub segment: LineSegment,
    /// Pixels of the segment that are done.
    pub done: u16,
    /// True if pixels of the segment are left.
    pub is_walking: bool,
    /// u, v at the start of the segment.
    pub start: FixedCoordinates,
    /// u, v at the end of the segment.
    pub end: FixedCoordinates,
    /// Change per pixel, with guard bits below.
    pub slope: [i64; 2],
    /// Coordinate that changes more: u (0) or v (1).
    pub axis: usize,
    /// All quotients that came with the segment.
    pub quotients: Quotients,
    /// Packet being filled.
    pub packet: TexelPacket,
    /// True if the packet has no texel yet.
    pub fresh_packet: bool,
    /// Whole tiles subtracted from the coordinates of the packet, an even number.
    pub tiles: [f64; 2],
    /// True for each of u and v in which the texture repeats. A clamped texture keeps its tiles.
    pub repeats: [bool; 2],
    /// Gradients of the packet.
    pub gradient: GradientPacket,
    /// Counters.
    pub counters: ApproximateCalculatorCounters,
}

impl ApproximateCalculatorState {
    /// Begins a packet unless one is open.
    #[inline]
    pub(super) fn open(&mut self, packet: Packet, log: bool) {
        if self.packet.packet.mask == 0 {
            self.packet.packet = packet;
            self.packet.points = 0;
            self.packet.displacement = log.then(|| Box::new([f32::NAN; PACKET_PIXELS]));
            self.fresh_packet = true;
        }
    }

    /// Sends the packet.
    #[inline]
    pub(super) fn close(&mut self) -> (Option<Flow<TexelPacket>>, Option<Flow<GradientPacket>>) {
        self.gradient.packet = self.packet.packet;
        let packet = self.packet.clone();
        self.packet.packet.mask = 0;
        (Some(Flow::Item(packet)), Some(Flow::Item(self.gradient)))
    }
}
