//! Scan converter: converts polygons to spans with exact ends.

use crate::config::{March, ScanConverterConfig, Snap};
use crate::signals::{LitSpan, ScanSpan, Uvw, scale_of};
use basrelief_kernel::stats::{FigureGroup, UnitStats};
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, OperatorCounts, Operators, Step, Unit};
use basrelief_shading::{PolygonSpans, RasterGrid, fan_triangle, fan_triangles};
use basrelief_signals::width::NUMBER;
use basrelief_signals::{Control, Flow, Polygon, Vertex};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Values that are linear on the screen: U, V, W, depth, two weights.
const VALUES: u32 = 6;
/// Divisions in the set-up of a triangle: slopes of its three edges, and reciprocal of its area.
const SETUP_DIVISIONS: u32 = 4;

/// Arithmetic of the set-up of a triangle:
/// - differences of its corners (6), its area (2 products, a sum), slopes of three edges and a reciprocal (4 divisions);
/// - U and V of its corners (6 products), subtraction of tiles and the largest of each (12 sums and comparisons);
/// - edges times the reciprocal (4 products), which are the changes of the weights; changes of each of the other four values per
///   pixel and per line (2 differences, 4 products, 2 sums);
/// - change of each value per line along three edges (a product and a sum each).
const SETUP: OperatorCounts = OperatorCounts {
    multiply: 2 + 6 + 4 + 4 * 4 + 3 * VALUES,
    add: 6 + 1 + 12 + 4 * 4 + 3 * VALUES,
    divide: SETUP_DIVISIONS,
    ..OperatorCounts::NONE
};
/// Arithmetic of a span: two edges advance, with U, V, W and the weights at both ends, and depth at the first.
const SPAN: OperatorCounts = OperatorCounts { add: 2 + 2 * (VALUES - 1) + 1, ..OperatorCounts::NONE };
/// Words of a triangle's set-up: position and slope of three edges; for each value both ends, its change per pixel, and along
/// three edges.
const SETUP_WORDS: u32 = 2 * 3 + VALUES * (2 + 1 + 3);

/// Counters of the scan converter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScanConverterCounters {
    /// Polygons scanned.
    pub polygons: u64,
    /// Triangles of their fans, each of which is set up.
    pub triangles: u64,
    /// Polygons without a span (step 420: no pixel between the snapped ends).
    pub empty: u64,
    /// Spans emitted.
    pub scanned: u64,
    /// Pixels of the spans.
    pub fragments: u64,
}

/// State of the scan converter between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ScanConverterState {
    /// Width and height of the frame \[pixels\].
    pub screen: [u32; 2],
    /// Snapped polygon that is being scanned.
    pub polygon: Option<Arc<Polygon>>,
    /// Position of its traversal.
    pub spans: PolygonSpans,
    /// Next span: row, first and last column.
    pub next: Option<[i32; 3]>,
    /// U, V, W at the vertices of a triangle, and the number of the triangle.
    pub corners: ([Uvw; 3], Option<u16>),
    /// Scales of u and v of that triangle. See [`ScanSpan::scale`].
    pub scale: [i16; 2],
    /// Counters.
    pub counters: ScanConverterCounters,
}

/// Scan converter: computes the ends of each scan line of a triangle, with exact U, V, W (Figure 2C) and step 410. It sends spans
/// to the step calculator and to the illuminance value generator (340), behind the control token of their polygon.
///
/// Scan lines are those of the triangles of the polygon's fan: pixels with centres inside, by the top-left rule. Other snapping
/// than up moves an end with all its values: the pixel at the snapped end gets the value of the exact end. A span that becomes
/// empty is dropped (step 420).
#[derive(Clone, Debug, Default)]
pub struct ScanConverter {
    /// Parameters.
    pub config: ScanConverterConfig,
    /// Rounding in step 410.
    pub snap: Snap,
    /// Direction of marching.
    pub march: March,
    /// Latencies of the operators.
    pub operators: Operators,
    /// State between steps.
    pub state: ScanConverterState,
}

impl Snap {
    /// Returns the distance by which vertices move left, so that rounding up performs the selected rounding \[pixels\].
    fn shift(self, subpixel_bits: u32) -> f32 {
        let step = 1.0 / (1u32 << subpixel_bits) as f32;
        match self {
            Self::Ceil => 0.0,
            Self::Round => 0.5 - step,
            Self::Floor | Self::Truncate => 1.0 - step,
        }
    }
}

impl ScanConverter {
    /// Creates a scan converter in its power-on state.
    pub fn new(config: ScanConverterConfig, snap: Snap, march: March, operators: Operators) -> Self {
        Self { config, snap, march, operators, state: ScanConverterState::default() }
    }

    /// Returns the operators that work in parallel.
    fn have(&self) -> OperatorCounts {
        let ScanConverterConfig { dividers, multipliers, adders, .. } = self.config;
        OperatorCounts { multiply: multipliers, add: adders, divide: dividers, ..OperatorCounts::NONE }
    }

    /// Takes a control token. Returns its occupancy in cycles.
    fn take(&mut self, control: &Control, traffic: &mut MemoryPorts) -> u64 {
        match control {
            Control::Frame(frame) => self.state.screen = [frame.width, frame.height],
            Control::Polygon(polygon) => return self.begin(polygon, traffic),
            Control::Object(_) | Control::CodeBook(_) | Control::Criterion(_) | Control::FrameEnd => {}
        }
        1
    }

    fn begin(&mut self, polygon: &Arc<Polygon>, traffic: &mut MemoryPorts) -> u64 {
        if let Some(vertex) = polygon.vertices.iter().find(|v| !(v.position[3] > 0.0 && v.position[3].is_finite())) {
            traffic.fault(format!(
                "scan converter: a polygon of object {} has 1 / w = {} at a vertex, expected a positive number: clip it at the near plane",
                polygon.object, vertex.position[3]
            ));
            return 1;
        }
        let (state, triangles) = (&mut self.state, fan_triangles(polygon));
        state.counters.polygons += 1;
        state.counters.triangles += u64::from(triangles);
        let snapped = snapped(polygon, self.snap.shift(self.config.subpixel_bits));
        let raster = RasterGrid::new(state.screen, self.config.subpixel_bits, self.config.z_bits, 1);
        state.spans = PolygonSpans::new(&snapped, raster);
        state.next = state.spans.next(&snapped);
        state.counters.empty += u64::from(state.next.is_none());
        state.corners.1 = None;
        state.polygon = state.next.is_some().then_some(snapped);
        (self.operators.interval(SETUP, self.have()) * u64::from(triangles)).max(1)
    }

    /// Returns the next span, and advances to the one after it.
    fn emit(&mut self) -> Option<ScanSpan> {
        let state = &mut self.state;
        let polygon = state.polygon.as_ref()?;
        let [y, left, right] = state.next?;
        let triangle = state.spans.triangle;
        if state.corners.1 != Some(triangle.number()) {
            let (corners, scale) = scaled(corners(polygon, triangle.number()));
            state.corners = (corners, Some(triangle.number()));
            state.scale = scale;
        }
        let backwards = self.march == March::RightToLeft;
        let ends = if backwards { [right, left] } else { [left, right] };
        let count = (right - left + 1) as u16;
        let shares = ends.map(|x| triangle.shares(x, y));
        let depths = shares.map(|share| triangle.exact_depth(share));
        let uvw = shares.map(|share| mixed(&state.corners.0, share, triangle.inverse_area()));
        // The change is the same all over the triangle, as computed in set-up.
        let per_pixel = if count > 1 { 1.0 / f64::from(count - 1) } else { 0.0 };
        let weights = shares.map(|[_, b, c]| [b, c].map(|share| (share * triangle.inverse_area()) as f32));
        let span = ScanSpan {
            y: y as u16,
            x: ends[0] as u16,
            count,
            backwards,
            textured: polygon.material.color_texture.is_some(),
            triangle: triangle.number(),
            scale: state.scale,
            ends: uvw,
            step: std::array::from_fn(|i| (uvw[1][i] - uvw[0][i]) * per_pixel),
            depth: [depths[0], (depths[1] - depths[0]) * per_pixel],
            weights,
        };
        state.counters.scanned += 1;
        state.counters.fragments += u64::from(count);
        state.next = state.spans.next(polygon);
        if state.next.is_none() {
            state.polygon = None;
        }
        Some(span)
    }
}

/// Returns the polygon moved left by `shift` pixels.
fn snapped(polygon: &Arc<Polygon>, shift: f32) -> Arc<Polygon> {
    if shift == 0.0 {
        return Arc::clone(polygon);
    }
    let mut polygon = Polygon::clone(polygon);
    polygon.vertices.iter_mut().for_each(|v| v.position[0] -= shift);
    Arc::new(polygon)
}

/// Returns U, V, W at the vertices of a triangle. Whole tiles common to its polygon are subtracted from u and v, an even number
/// of them, so that a mirrored texture is unchanged. A clamped texture keeps them.
fn corners(polygon: &Polygon, triangle: u16) -> [Uvw; 3] {
    use basrelief_signals::WrapMode::Clamp;
    let Some(vertices) = fan_triangle(polygon, triangle) else { return [[0.0, 0.0, 1.0]; 3] };
    let wrap = polygon.material.color_texture.as_ref().map_or([Clamp; 2], |texture| texture.sampler.wrap);
    let coordinate = |v: &Vertex, i: usize| f64::from(v.uv[i]);
    let off: [f64; 2] = std::array::from_fn(|i| {
        let least = vertices.iter().map(|v| coordinate(v, i)).fold(f64::INFINITY, f64::min);
        if wrap[i] == Clamp || !least.is_finite() { 0.0 } else { 2.0 * (0.5 * least).floor() }
    });
    vertices.map(|v| {
        let w = f64::from(v.position[3]);
        [(coordinate(v, 0) - off[0]) * w, (coordinate(v, 1) - off[1]) * w, w]
    })
}

/// Returns U and V divided by the least 2^n above the u and v of the triangle, and these n.
fn scaled(corners: [Uvw; 3]) -> ([Uvw; 3], [i16; 2]) {
    let scale = [0, 1].map(|i| scale_of(corners.iter().map(|c| (c[i] / c[2]).abs()).fold(0.0, f64::max)));
    let over = |c: f64, n: i16| libm::ldexp(c, -i32::from(n));
    (corners.map(|[u, v, w]| [over(u, scale[0]), over(v, scale[1]), w]), scale)
}

/// Returns the values at the vertices, weighted with their shares.
fn mixed(corners: &[Uvw; 3], share: [f64; 3], inverse_area: f64) -> Uvw {
    std::array::from_fn(|i| (share[0] * corners[0][i] + share[1] * corners[1][i] + share[2] * corners[2][i]) * inverse_area)
}

impl Unit for ScanConverter {
    basrelief_kernel::unit_info!("finds spans with exact U, V, W at both ends");
    type In = Option<Control>;
    type Out = (Option<Flow<ScanSpan>>, Option<Flow<LitSpan>>);

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.next.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        if let Some(control) = input {
            let occupancy = self.take(&control, traffic);
            return Step::after(latency, (Some(Flow::Control(control.clone())), Some(Flow::Control(control)))).busy(occupancy);
        }
        let span = self.emit();
        let lit = span.map(|ScanSpan { y, x, count, backwards, triangle, weights, .. }| {
            Flow::Item(LitSpan { y, x, count, backwards, triangle, weights })
        });
        Step::after(latency, (span.map(Flow::Item), lit)).busy(self.operators.interval(SPAN, self.have()))
    }

    fn is_empty(&self) -> bool {
        self.state.next.is_none()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.config.latency, self.operators.interval(SPAN, self.have()));
        let c = &self.state.counters;
        stats.figure("triangles_scanned", c.triangles, "triangles", "Triangles scanned");
        stats.figure("polygons_empty", c.empty, "polygons", "Polygons without a pixel");
        stats.figure("fragments", c.fragments, "fragments", "Pixels of spans").part(FigureGroup::Work);
        let divisions = u64::from(SETUP_DIVISIONS) * c.triangles;
        stats.figure(
            "setup_divisions",
            divisions,
            "divisions",
            "Divisions at set-up of triangles: slopes of edges, reciprocals of areas",
        );
        stats.shared_operators("set-up of triangles, ends of spans", self.have(), SETUP.and(SPAN), OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "a triangle that is set up", SETUP_WORDS, NUMBER);
    }
}
