//! The unit and its step.

use super::{ApproximateCalculatorState, displacement};
use crate::config::{ApproximationConfig, MipPer};
use crate::signals::{GradientPacket, Quotients, Segment, TexelPacket};
use crate::twins::{Pair, pair};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_signals::{Control, Flow, PACKET_PIXELS, Packet, Wrap};

/// Approximate calculator (310a): takes segments and the exact u, v at their ends, interpolates between them, one pixel after
/// the other, and sends u, v to the texture look-up table (330) and du, dv to the MIP-map selector (320).
///
/// A step walks one segment as far as a cell of the picture reaches; a packet goes out with the last pixel of its cell or of its
/// span. While it walks, the dividers work ahead: what it then still has to wait for is charged as starved of `quotients`.
#[derive(Clone, Debug, Default)]
pub struct ApproximateCalculator {
    /// Parameters.
    pub config: ApproximationConfig,
    /// What gradients are for.
    pub per: MipPer,
    /// Gradients are asked for.
    pub gradients: bool,
    /// Largest depth value.
    pub z_max: u32,
    /// Displacements go with the packets.
    pub log: bool,
    /// Everything it remembers.
    pub state: ApproximateCalculatorState,
}

/// Gradients of the segment take a reciprocal for each pixel.
#[inline]
fn divides(per: MipPer, segment: &Segment) -> bool {
    per == MipPer::Pixel || segment.exact
}

type Out = Step<(Option<Flow<TexelPacket>>, Option<Flow<GradientPacket>>)>;

impl ApproximateCalculator {
    /// An approximate calculator at power-on, for depth values of `z_bits` bits; `gradients`: per segment, per pixel or not.
    pub fn new(config: ApproximationConfig, z_bits: u32, gradients: Option<MipPer>) -> Self {
        let z_max = u32::MAX >> (32 - z_bits.clamp(1, 32));
        let (per, gradients) = (gradients.unwrap_or_default(), gradients.is_some());
        Self { config, per, gradients, z_max, log: false, state: ApproximateCalculatorState::default() }
    }

    fn take(&mut self, control: &Control) {
        let Control::Polygon(polygon) = control else { return };
        if let Some(texture) = &polygon.material.color_texture {
            self.state.repeats = texture.sampler.wrap.map(|wrap| wrap != Wrap::Clamp);
        }
    }

    /// The next segment.
    fn begin(&mut self, segment: Segment, quotients: Quotients) {
        let state = &mut self.state;
        if segment.span.textured {
            let from = if segment.fresh { quotients.first() } else { Some(&state.end) };
            state.start = from.copied().unwrap_or_default();
            state.end = quotients.last().copied().unwrap_or_default();
            // Lengths are whole: their reciprocals stand in a table.
            let length = segment.to - segment.from;
            let per_pixel = if length > 0 { 1.0 / f64::from(length) } else { 0.0 };
            state.slope = std::array::from_fn(|i| (state.end[i] - state.start[i]) * per_pixel);
            state.axis = usize::from(state.slope[1].abs() > state.slope[0].abs());
            state.counters.multiplications += if segment.exact || length == 0 { 0 } else { 2 };
        }
        state.quotients = quotients;
        state.segment = segment;
        state.done = 0;
    }

    /// Walks on in the segment, to its end or that of the cell; the pixels walked.
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

    /// u and v of pixel `k`.
    #[inline(always)]
    fn texel(&mut self, segment: &Segment, k: u16, position: usize) {
        let state = &mut self.state;
        let (span, along) = (&segment.span, k - segment.from);
        let is_point = segment.exact || k == segment.from || k == segment.to;
        let uv = match segment.exact {
            true => state.quotients.get(usize::from(along)).copied().unwrap_or_default(),
            false if k == segment.to => state.end,
            false => std::array::from_fn(|i| state.start[i] + f64::from(along) * state.slope[i]),
        };
        if state.fresh_packet {
            state.fresh_packet = false;
            state.tiles = std::array::from_fn(|i| if state.repeats[i] { 2.0 * (0.5 * uv[i]).floor() } else { 0.0 });
        }
        state.packet.uv[position] = std::array::from_fn(|i| (uv[i] - state.tiles[i]) as f32);
        state.packet.points |= u16::from(is_point) << position;
        let exact = std::array::from_fn(|i| span.ends[0][i] + f64::from(k) * span.step[i]);
        let away = displacement(uv[state.axis], &exact, &span.step, state.axis);
        state.counters.displacements.add(away);
        if let Some(displacements) = &mut state.packet.displacement {
            displacements[position] = away as f32;
        }
        if self.gradients {
            let slope = if divides(self.per, segment) {
                state.counters.gradient_reciprocals += 1;
                std::array::from_fn(|i| (span.step[i] - uv[i] * span.step[2]) / exact[2])
            } else {
                state.slope
            };
            state.gradient.gradient[position] = slope.map(|c| c as f32);
        }
    }

    fn advance(&mut self) -> Out {
        let pixels = self.walk();
        let segment = self.state.segment;
        let Segment { span, from, walk, .. } = segment;
        let next = from + self.state.done;
        self.state.is_walking = self.state.done < walk;
        // Past the span, or in another cell.
        let whole =
            next >= span.count || span.column(next) / PACKET_PIXELS as u16 != self.state.packet.packet.x / PACKET_PIXELS as u16;
        let out = if whole { self.state.close() } else { (None, None) };
        let ApproximationConfig { initiation_interval, latency, reciprocal_cycles } = self.config;
        let divides = self.gradients && span.textured && divides(self.per, &segment);
        let interval = if divides { initiation_interval.max(reciprocal_cycles) } else { initiation_interval };
        Step::over(usize::from(pixels), interval.into(), latency.into(), out)
    }
}

impl Unit for ApproximateCalculator {
    basrelief_kernel::role!("interpolates u, v between division points");
    type In = (Option<Flow<Segment>>, Option<Flow<Quotients>>);
    type Out = (Option<Flow<TexelPacket>>, Option<Flow<GradientPacket>>);

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.is_walking { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        if !self.state.is_walking {
            match pair("approximate calculator", input, traffic) {
                Pair::Items(segment, quotients) => self.begin(segment, quotients),
                Pair::Control(control) => {
                    self.take(&control);
                    let twin = Some(Flow::Control(control.clone()));
                    return Step::after(u64::from(self.config.latency), (Some(Flow::Control(control)), twin));
                }
                Pair::Nothing => return Step::after(0, (None, None)),
            }
        }
        self.advance()
    }

    fn is_empty(&self) -> bool {
        !self.state.is_walking && self.state.packet.packet.mask == 0
    }

    fn tell(&self, facts: &mut Facts) {
        for output in 0..2 {
            facts.rate(output, self.config.latency, 1_u64);
        }
        let c = &self.state.counters;
        facts.figure(
            "multiplications",
            c.multiplications,
            "multiplications",
            "Multiplications of dividers and approximate calculator",
        );
        facts.figure("gradient_reciprocals", c.gradient_reciprocals, "reciprocals", "Reciprocals for du, dv");
        facts.figure(
            "displacement_largest",
            c.displacements.largest,
            "pixels",
            "Largest displacement measured, of all pixels with a texture",
        );
        facts.figure("displacement_mean", c.displacements.mean(), "pixels", "Their mean displacement");
    }
}
