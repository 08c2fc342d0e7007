//! Illuminance value generator (340).

use crate::config::{IlluminanceConfig, IlluminanceMode};
use crate::pixel_pace::PixelPace;
use crate::signals::{IlluminancePacket, LitSpan, to_16_bits};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, OperatorCounts, Operators, Step, Unit};
use basrelief_shading::{LightVector, brightness, fan_triangle, light_vectors};
use basrelief_signals::width::NUMBER;
use basrelief_signals::{Control, Flow, Frame, PACKET_PIXELS, Packet, Polygon, Vertex};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Value 1 in the format of [`IlluminancePacket::rgba`].
pub const ONE: f32 = (1 << 14) as f32;

/// Arithmetic of RGBA at the corners of a triangle: base colour by vertex colour, RGB by brightness.
const CORNERS: OperatorCounts = OperatorCounts { multiply: 3 * (4 + 3), ..OperatorCounts::NONE };
/// Arithmetic of the differences of the corners, once per triangle.
const DIFFERENCES: OperatorCounts = OperatorCounts { add: 2 * 4, ..OperatorCounts::NONE };
/// Arithmetic of RGBA at the ends of a span by two weights, and of the change per pixel, which is that of the triangle.
const SPAN: OperatorCounts = OperatorCounts { multiply: 2 * 4 * 2 + 4, add: 2 * 4 * 2 + 4, ..OperatorCounts::NONE };
/// Arithmetic of the brightness of a corner under one light: N.L, N.H, a power, intensity and sums.
const LIGHT: OperatorCounts = OperatorCounts { multiply: 2 * 3 + 2, add: 2 * 2 + 2, power: 1, ..OperatorCounts::NONE };
/// Arithmetic of a pixel: a step of each component.
const PIXEL: OperatorCounts = OperatorCounts { add: 4, ..OperatorCounts::NONE };
/// Width of the interpolation \[bits\]: 2 bits and 14 of a fraction, and guard bits for the pixels of a line.
const SUM_BITS: u32 = 16 + 14;

/// Counters of the illuminance value generator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct IlluminanceValueGeneratorCounters {
    /// Pixels generated.
    pub pixels: u64,
}

/// State of the illuminance value generator between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IlluminanceValueGeneratorState {
    /// Frame, with its lights.
    pub frame: Option<Arc<Frame>>,
    /// Lights as seen from the object.
    pub lights: Vec<LightVector>,
    /// Current polygon.
    pub polygon: Option<Arc<Polygon>>,
    /// RGBA at the vertices of a triangle, and the number of the triangle.
    pub corners: ([[f32; 4]; 3], Option<u16>),
    /// Span being walked.
    pub span: Option<LitSpan>,
    /// RGBA of the span's first pixel, and its change per pixel.
    pub line: [[f32; 4]; 2],
    /// Pixels of the span that are done.
    pub done: u16,
    /// Counters.
    pub counters: IlluminanceValueGeneratorCounters,
}

/// Illuminance value generator (340): takes spans, and emits for each packet of their pixels the factor of the texture:
/// brightness times base colour times vertex colour, and alpha. It interpolates from the vertices, linear on the screen
/// (Gouraud).
///
/// The geometry processor computed the brightness of a vertex. Bump targets have none and are lit here, by the same formula.
#[derive(Clone, Debug, Default)]
pub struct IlluminanceValueGenerator {
    /// Parameters.
    pub config: IlluminanceConfig,
    /// Latencies of the operators.
    pub operators: Operators,
    /// State between steps.
    pub state: IlluminanceValueGeneratorState,
}

impl IlluminanceValueGenerator {
    /// Creates an illuminance value generator in its power-on state.
    pub fn new(config: IlluminanceConfig, operators: Operators) -> Self {
        Self { config, operators, state: IlluminanceValueGeneratorState::default() }
    }

    /// Returns multipliers and adders for set-up, and the single power unit that lights vertices of bump targets.
    fn have(&self) -> OperatorCounts {
        OperatorCounts { multiply: self.config.multipliers, add: self.config.adders, power: 1, ..OperatorCounts::NONE }
    }

    /// Returns the arithmetic of the corners of a triangle.
    fn corners(&self) -> OperatorCounts {
        let lit = self.config.mode == IlluminanceMode::Gouraud && self.state.polygon.as_deref().is_some_and(|p| p.bump);
        let lights = if lit { 3 * self.state.lights.len() as u32 } else { 0 };
        CORNERS.and(DIFFERENCES).and(LIGHT.times(lights))
    }

    fn take(&mut self, control: &Control) {
        let state = &mut self.state;
        match control {
            Control::Frame(frame) => {
                state.lights = light_vectors(frame, [0.0; 3]);
                state.frame = Some(Arc::clone(frame));
            }
            Control::Object(object) => {
                state.lights = state.frame.as_ref().map_or_else(Vec::new, |frame| light_vectors(frame, object.centre));
            }
            Control::Polygon(polygon) => {
                state.polygon = Some(Arc::clone(polygon));
                state.corners.1 = None;
            }
            Control::CodeBook(_) | Control::Criterion(_) | Control::FrameEnd => {}
        }
    }

    /// Returns RGBA of a vertex.
    fn vertex(&self, vertex: &Vertex, polygon: &Polygon) -> [f32; 4] {
        let material = &polygon.material;
        let light = match self.config.mode {
            IlluminanceMode::Off => 1.0,
            IlluminanceMode::Gouraud => {
                let [rest, specular] = if polygon.bump {
                    brightness(Vec3::from(vertex.normal), &material.lighting, &self.state.lights)
                } else {
                    vertex.brightness
                };
                rest + specular
            }
        };
        let [r, g, b, a] = std::array::from_fn(|i| material.base_color[i] * vertex.color[i]);
        [r * light, g * light, b * light, a]
    }

    /// Sets up a span. Returns its cycles, which overlap with walking the previous span.
    fn begin(&mut self, span: LitSpan) -> u64 {
        let LitSpan { triangle, weights, count, .. } = span;
        let mut work = SPAN;
        if self.state.corners.1 != Some(triangle) {
            work = work.and(self.corners());
            let polygon = self.state.polygon.clone();
            let corners = polygon.as_deref().and_then(|p| Some(fan_triangle(p, triangle)?.map(|v| self.vertex(v, p))));
            self.state.corners = (corners.unwrap_or([[0.0; 4]; 3]), Some(triangle));
        }
        let [a, b, c] = self.state.corners.0;
        let end = |[s, t]: [f32; 2]| -> [f32; 4] { std::array::from_fn(|i| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i])) };
        let [first, last] = weights.map(end);
        let per_pixel = if count > 1 { 1.0 / f32::from(count - 1) } else { 0.0 };
        self.state.line = [first, std::array::from_fn(|i| (last[i] - first[i]) * per_pixel)];
        self.state.span = Some(span);
        self.state.done = 0;
        self.operators.interval(work, self.have())
    }

    /// Returns the next packet of the span.
    #[inline(always)]
    fn packet(&mut self) -> Option<IlluminancePacket> {
        let state = &mut self.state;
        let LitSpan { x, y, count, backwards, .. } = state.span?;
        let column = |k: u16| if backwards { x - k } else { x + k };
        let cell = column(state.done) & !(PACKET_PIXELS as u16 - 1);
        let mut out = IlluminancePacket { packet: Packet { x: cell, y, mask: 0 }, rgba: [[0; 4]; PACKET_PIXELS] };
        while state.done < count && column(state.done) & !(PACKET_PIXELS as u16 - 1) == cell {
            let position = usize::from(column(state.done) - cell);
            out.packet.mask |= 1 << position;
            let [first, change] = &state.line;
            let at = |i: usize| (first[i] + f32::from(state.done) * change[i]) * ONE;
            out.rgba[position] = to_16_bits([at(0), at(1), at(2), at(3)]);
            state.done += 1;
            state.counters.pixels += 1;
        }
        if state.done >= count {
            state.span = None;
        }
        Some(out)
    }
}

impl Unit for IlluminanceValueGenerator {
    basrelief_kernel::unit_info!("interpolates brightness and colour");
    type In = Option<Flow<LitSpan>>;
    type Out = Option<Flow<IlluminancePacket>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.span.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        let setup = match input {
            Some(Flow::Control(control)) => {
                self.take(&control);
                return Step::after(latency, Some(Flow::Control(control)));
            }
            Some(Flow::Item(span)) => self.begin(span),
            None => 1,
        };
        let packet = self.packet();
        let pixels = packet.map_or(0, |s| s.packet.pixels());
        let step = Step::over(pixels, u64::from(self.config.initiation_interval), latency, packet.map(Flow::Item));
        let kept = step.occupancy.max(setup);
        Step { latency: step.latency + kept - step.occupancy, ..step }.busy(kept)
    }

    fn is_empty(&self) -> bool {
        self.state.span.is_none()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.config.latency, 1_u64);
        let lit = self.config.mode == IlluminanceMode::Gouraud;
        let work = CORNERS.and(DIFFERENCES).and(SPAN).and(if lit { LIGHT } else { OperatorCounts::NONE });
        let have = OperatorCounts { power: 0, ..self.have() };
        stats.shared_operators("set-up of triangles and spans", have, work, OperandWidth::SINGLE);
        let power = u32::from(lit);
        stats.hardware(HardwareKind::Power, "highlights of bump targets", power, OperandWidth::SINGLE);
        let pace = PixelPace { operators: &self.operators, interval: self.config.initiation_interval };
        pace.tell("interpolation of RGBA", PIXEL, SUM_BITS, stats);
        stats.hardware(HardwareKind::Registers, "RGBA: sum and change", 2 * 4_u32, SUM_BITS);
        stats.hardware(HardwareKind::Registers, "corners: RGBA and its differences", 3 * 4_u32, NUMBER);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slower_pixels_share_operators() {
        let adders = |initiation_interval| {
            let config = IlluminanceConfig { initiation_interval, ..IlluminanceConfig::default() };
            let mut stats = UnitStats::default();
            IlluminanceValueGenerator::new(config, Operators::default()).report_stats(&mut stats);
            let piece = stats.all_hardware().iter().find(|piece| piece.about == "interpolation of RGBA").unwrap();
            (piece.count, piece.turns)
        };
        assert_eq!([1, 2, 3, 16].map(adders), [(4, 1), (2, 2), (2, 2), (1, 4)]);
    }

    #[test]
    fn set_up_takes_turns_in_its_operators() {
        let turns = |multipliers| {
            let config = IlluminanceConfig { multipliers, mode: IlluminanceMode::Off, ..IlluminanceConfig::default() };
            let mut stats = UnitStats::default();
            IlluminanceValueGenerator::new(config, Operators::default()).report_stats(&mut stats);
            stats.all_hardware().iter().find(|piece| piece.kind == HardwareKind::Multiplier).unwrap().turns
        };
        // 21 products of three corners, and 20 of a span.
        assert_eq!([1, 8, 41].map(turns), [41, 6, 1]);
    }
}
