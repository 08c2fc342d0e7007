//! The unit and its step.

use super::{ApproximateCalculatorState, displacement};
use crate::config::{ApproximationConfig, Method, MipPer, TexelConfig};
use crate::fixed::{down, nearest};
use crate::join_streams::{PairedInput, pair};
use crate::signals::{FixedCoordinates, GradientPacket, LineSegment, Quotients, TexelPacket};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Operators, Step, Unit};
use basrelief_signals::{Control, Flow, PACKET_PIXELS, Packet, WrapMode};

/// Approximate calculator (310a): takes segments and the exact u, v at their ends, and interpolates between them, one pixel after
/// the other. It sends u, v to the texture look-up table (330) and du, dv to the MIP-map selector (320).
///
/// A step walks one segment up to the end of a cell of the picture. A packet leaves with the last pixel of its cell or of its
/// span. Meanwhile the dividers work ahead. Cycles in which it still waits for them count as starved of `quotients`.
///
/// u and v are in fixed point. Their change per pixel has more bits, as many as the longest segment needs, and is rounded towards
/// 0. At the segment's end it is short by less than a step, and never beyond the end.
#[derive(Clone, Debug, Default)]
pub struct ApproximateCalculator {
    /// Parameters.
    pub config: ApproximationConfig,
    /// Width of u and v \[bits\].
    pub bits: u32,
    /// Longest segment \[pixels\].
    pub longest: u32,
    /// Bits of a reciprocal computed per cycle.
    pub bits_per_cycle: u32,
    /// Latencies of the operators.
    pub operators: Operators,
    /// Requested gradients: per segment or per pixel.
    pub gradients: Option<MipPer>,
    /// Largest depth value.
    pub z_max: u32,
    /// True if displacements travel with the packets.
    pub log: bool,
    /// State between steps.
    pub state: ApproximateCalculatorState,
}

/// Computes 2^n. `ldexp` is also exact, but several times slower.
#[inline]
fn power_of_2(n: i16) -> f64 {
    f64::from_bits(((1023 + i64::from(n)).clamp(1, 2046) as u64) << 52)
}

/// Returns a step of signed fixed point with this many bits.
#[inline]
fn unit(bits: u32) -> f64 {
    power_of_2(1 - bits as i16)
}

type Out = Step<(Option<Flow<TexelPacket>>, Option<Flow<GradientPacket>>)>;

impl ApproximateCalculator {
    /// Creates an approximate calculator in its power-on state, for u and v as in `texel`, quotients of `bits_per_cycle` and
    /// depth values of `z_bits` bits. `gradients` is per segment, per pixel or `None`.
    pub fn new(
        config: ApproximationConfig,
        texel: &TexelConfig,
        [bits_per_cycle, z_bits]: [u32; 2],
        gradients: Option<MipPer>,
        operators: Operators,
    ) -> Self {
        let z_max = u32::MAX >> (32 - z_bits.clamp(1, 32));
        // If every pixel is divided, no segment has a change.
        let gradients = gradients.map(|per| if texel.method == Method::Exact { MipPer::Pixel } else { per });
        let (bits, longest, state) = (texel.coordinate_bits, texel.longest_segment, ApproximateCalculatorState::default());
        Self { config, bits, longest, bits_per_cycle, operators, gradients, z_max, log: false, state }
    }

    /// Returns the bits of a change per pixel below those of u and v: those of the longest segment's length, and one for rounding
    /// towards 0.
    pub(super) fn guard(&self) -> u32 {
        u32::BITS - self.longest.leading_zeros() + 1
    }

    fn take(&mut self, control: &Control) {
        let Control::Polygon(polygon) = control else { return };
        if let Some(texture) = &polygon.material.color_texture {
            self.state.repeats = texture.sampler.wrap.map(|wrap| wrap != WrapMode::Clamp);
        }
    }

    /// Begins the next segment.
    fn begin(&mut self, segment: LineSegment, quotients: Quotients) {
        let (bits, guard, state) = (self.bits, self.guard(), &mut self.state);
        if segment.span.textured {
            let from = if segment.fresh { quotients.first() } else { Some(&state.end) };
            state.start = from.copied().unwrap_or_default();
            state.end = quotients.last().copied().unwrap_or_default();
            // Lengths are whole, so their reciprocals lie in a table.
            let length = segment.to - segment.from;
            let per_pixel = if length > 0 { down(1.0 / f64::from(length), bits) } else { 0.0 };
            let (FixedCoordinates(from), FixedCoordinates(to)) = (state.start, state.end);
            // The conversion rounds towards 0.
            state.slope = std::array::from_fn(|i| (((to[i] - from[i]) << guard) as f64 * per_pixel) as i64);
            let change = [0, 1].map(|i| libm::ldexp(state.slope[i].abs() as f64, segment.span.scale[i].into()));
            state.axis = usize::from(change[1] > change[0]);
            state.counters.multiplications += if segment.exact || length == 0 { 0 } else { 2 };
        }
        state.quotients = quotients;
        state.segment = segment;
        state.done = 0;
    }

    /// Walks the segment to its end or to the end of the cell. Returns the pixels walked.
    #[inline(always)]
    fn walk(&mut self) -> u16 {
        let segment = self.state.segment;
        let span = &segment.span;
        let first = segment.from + self.state.done;
        let pixels = span.in_cell(first).min(segment.walk - self.state.done);
        let column = span.column(first);
        self.state.open(Packet { x: column & !(PACKET_PIXELS as u16 - 1), y: span.y, mask: 0 }, self.log && span.textured);
        for k in first..first + pixels {
            let position = usize::from(span.column(k)) % PACKET_PIXELS;
            let depth = span.depth[0] + f64::from(k) * span.depth[1] + 0.5;
            self.state.packet.z[position] = (depth as u32).min(self.z_max);
            self.state.packet.packet.mask |= 1 << position;
            if span.textured {
                self.texel(&segment, k, position);
            }
        }
        self.state.done += pixels;
        pixels
    }

    /// Computes u and v of pixel `k`.
    #[inline(always)]
    fn texel(&mut self, segment: &LineSegment, k: u16, position: usize) {
        let (unit, guard, state) = (unit(self.bits), self.guard(), &mut self.state);
        let (span, along) = (&segment.span, k - segment.from);
        let is_point = segment.exact || k == segment.from || k == segment.to;
        let FixedCoordinates(uv) = match segment.exact {
            true => state.quotients.get(usize::from(along)).copied().unwrap_or_default(),
            false if k == segment.to => state.end,
            false => FixedCoordinates(std::array::from_fn(|i| {
                state.start.0[i] + ((i64::from(along) * state.slope[i] + (1 << (guard - 1))) >> guard)
            })),
        };
        let uv = uv.map(|c| c as f64 * unit);
        let tiled: [f64; 2] = std::array::from_fn(|i| uv[i] * power_of_2(span.scale[i]));
        if state.fresh_packet {
            state.fresh_packet = false;
            state.tiles = std::array::from_fn(|i| if state.repeats[i] { 2.0 * (0.5 * tiled[i]).floor() } else { 0.0 });
        }
        state.packet.uv[position] = std::array::from_fn(|i| (tiled[i] - state.tiles[i]) as f32);
        state.packet.points |= u16::from(is_point) << position;
        let exact = std::array::from_fn(|i| span.ends[0][i] + f64::from(k) * span.step[i]);
        let away = displacement(uv[state.axis], &exact, &span.step, state.axis);
        state.counters.displacements.add(away);
        if let Some(displacements) = &mut state.packet.displacement {
            displacements[position] = away as f32;
        }
        if self.gradients.is_some() {
            self.gradient(segment, position, uv, exact[2]);
        }
    }

    /// Computes the change of u and v per pixel, at a pixel with these values.
    fn gradient(&mut self, segment: &LineSegment, position: usize, uv: [f64; 2], w: f64) {
        let (bits, state, span) = (self.bits + self.guard(), &mut self.state, &segment.span);
        let change: [f64; 2] = if self.gradients == Some(MipPer::Pixel) {
            state.counters.gradient_reciprocals += 1;
            let reciprocal = nearest(1.0 / w, self.config.reciprocal_bits);
            std::array::from_fn(|i| (span.step[i] - uv[i] * span.step[2]) * reciprocal)
        } else {
            let unit = unit(bits);
            state.slope.map(|c| c as f64 * unit)
        };
        state.gradient.gradient[position] = std::array::from_fn(|i| (change[i] * power_of_2(span.scale[i])) as f32);
    }

    fn advance(&mut self) -> Out {
        let pixels = self.walk();
        let segment = self.state.segment;
        let LineSegment { span, from, walk, .. } = segment;
        let next = from + self.state.done;
        self.state.is_walking = self.state.done < walk;
        // Past the span, or in another cell.
        let whole =
            next >= span.count || span.column(next) / PACKET_PIXELS as u16 != self.state.packet.packet.x / PACKET_PIXELS as u16;
        let out = if whole { self.state.close() } else { (None, None) };
        let divides = span.textured && self.gradients == Some(MipPer::Pixel);
        let interval = self.config.initiation_interval.max(if divides { self.reciprocal() } else { 1 });
        Step::over(usize::from(pixels), interval.into(), self.latency(divides), out)
    }
}

impl Unit for ApproximateCalculator {
    basrelief_kernel::unit_info!("interpolates u, v between division points");
    type In = (Option<Flow<LineSegment>>, Option<Flow<Quotients>>);
    type Out = (Option<Flow<TexelPacket>>, Option<Flow<GradientPacket>>);

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.is_walking { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        if !self.state.is_walking {
            match pair("approximate calculator", input, traffic) {
                PairedInput::Items(segment, quotients) => self.begin(segment, quotients),
                PairedInput::Control(control) => {
                    self.take(&control);
                    let twin = Some(Flow::Control(control.clone()));
                    return Step::after(self.latency(false), (Some(Flow::Control(control)), twin));
                }
                PairedInput::Nothing => return Step::after(0, (None, None)),
            }
        }
        self.advance()
    }

    fn is_empty(&self) -> bool {
        !self.state.is_walking && self.state.packet.packet.mask == 0
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        for output in 0..2 {
            stats.rate(output, self.latency(false), 1_u64);
        }
        self.tell_hardware(stats);
        let c = &self.state.counters;
        stats.figure(
            "multiplications",
            c.multiplications,
            "multiplications",
            "Multiplications of dividers and approximate calculator",
        );
        stats.figure("gradient_reciprocals", c.gradient_reciprocals, "reciprocals", "Reciprocals 1 / W for du, dv");
        stats.figure(
            "displacement_largest",
            c.displacements.largest,
            "pixels",
            "Largest displacement measured, of all pixels with a texture",
        );
        stats.figure("displacement_mean", c.displacements.mean(), "pixels", "Their mean displacement");
    }
}
