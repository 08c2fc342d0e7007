//! Everything the approximate calculator (310a) remembers.

use super::Displacements;
use crate::signals::{Coordinates, GradientPacket, Quotients, Segment, TexelPacket};
use basrelief_signals::{Flow, PACKET_PIXELS, Packet};
use serde::{Deserialize, Serialize};

/// What the approximate calculator (310a) has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ApproximateCalculatorCounters {
    /// Products of a difference and the reciprocal of a length, two per segment.
    pub multiplications: u64,
    /// Reciprocals 1 / W for derivatives at pixels: `mip.per = pixel`, or segments of one pixel.
    pub gradient_reciprocals: u64,
    /// How far texels are from their place, of every pixel with a texture, hidden ones too.
    pub displacements: Displacements,
}

/// Everything the approximate calculator (310a) remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ApproximateCalculatorState {
    /// The segment that is walked.
    pub segment: Segment,
    /// Pixels of it that are done.
    pub done: u16,
    /// Some are not.
    pub is_walking: bool,
    /// u, v at its start.
    pub start: Coordinates,
    /// u, v at its end.
    pub end: Coordinates,
    /// Change per pixel, with guard bits behind.
    pub slope: [i64; 2],
    /// Of u (0) and v (1) the one that changes more.
    pub axis: usize,
    /// All quotients that came with it.
    pub quotients: Quotients,
    /// The packet that is filled.
    pub packet: TexelPacket,
    /// No texel is in it yet.
    pub fresh_packet: bool,
    /// Whole tiles that are taken off the coordinates of the packet: an even number of them.
    pub tiles: [f64; 2],
    /// Whether the texture repeats in u and in v; one that is clamped keeps its tiles.
    pub repeats: [bool; 2],
    /// Its gradients.
    pub gradient: GradientPacket,
    /// What it has counted.
    pub counters: ApproximateCalculatorCounters,
}

impl ApproximateCalculatorState {
    /// Begins a packet here, unless one is open.
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
