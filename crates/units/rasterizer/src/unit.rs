//! The rasterizer.

use crate::config::RasterizerConfig;
use crate::state::RasterizerState;
use crate::work::{CHAIN, FRAGMENT, SET_UP, SET_UP_NUMBERS};
use basrelief_kernel::stats::{FigureGroup, UnitStats};
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Operators, Step, Unit, UnitTable};
use basrelief_shading::{BLOCK, PolygonScan, fan_triangles};
use basrelief_signals::{Control, Flow, Fragment, Polygon, Stamp};
use std::sync::Arc;

/// Rasterizer: emits a stamp per step, in order, behind the control token of the polygon. A polygon occupies the unit for the
/// set-up of the triangles of its fan, before its fragments. The operators limit the rate of fragments.
///
/// [`PolygonScan`] defines the pixels of a polygon. A polygon without pixels passes as its control token only.
#[derive(Clone, Debug)]
pub struct Rasterizer {
    /// Parameters.
    pub config: RasterizerConfig,
    /// Latencies of the operators.
    pub operators: Operators,
    /// Cycles from one fragment to the next. Computed once, because parameters do not change during a run and every step needs
    /// it.
    pace: u64,
    /// Cycles from a polygon to its first fragment, and latency of every fragment.
    latency: u64,
    /// State between steps.
    pub state: RasterizerState,
}

impl Rasterizer {
    /// Creates a rasterizer in its power-on state.
    pub fn new(config: RasterizerConfig, operators: Operators) -> Self {
        let (pace, latency) = (operators.stream_interval(FRAGMENT, config.operators()), operators.latency(CHAIN));
        Self { config, operators, pace, latency, state: RasterizerState::default() }
    }

    /// Takes a control token. Returns its occupancy in cycles.
    fn take(&mut self, control: &Control) -> u64 {
        match control {
            Control::Frame(frame) => {
                self.state.screen = [frame.width, frame.height];
                1
            }
            Control::Polygon(polygon) => self.begin(polygon),
            Control::Object(_) | Control::CodeBook(_) | Control::Criterion(_) | Control::FrameEnd => 1,
        }
    }

    fn begin(&mut self, polygon: &Arc<Polygon>) -> u64 {
        let triangles = fan_triangles(polygon);
        self.state.counters.polygons += 1;
        self.state.counters.triangles += u64::from(triangles);
        self.state.scan = PolygonScan::new(polygon, self.config.raster(self.state.screen));
        self.state.polygon = Some(Arc::clone(polygon));
        self.advance();
        self.operators.stream_interval(SET_UP.times(triangles.into()), self.config.operators())
    }

    /// Advances to the next fragment of the polygon. Past the last, the unit is ready for the next control token.
    #[inline]
    fn advance(&mut self) {
        let RasterizerState { polygon, scan, .. } = &mut self.state;
        if !polygon.as_ref().is_some_and(|polygon| scan.advance(polygon)) {
            *polygon = None;
        }
    }

    /// Returns the next fragment and those after it in the same block.
    #[inline(always)]
    fn emit(&mut self) -> Stamp<Fragment> {
        let mut stamp = Stamp::new();
        let mut block = None;
        while let Some(polygon) = self.state.polygon.as_ref() {
            let walk = &self.state.scan.walk;
            let [x, y] = walk.pixel();
            let here = Some((y >> BLOCK.ilog2(), x >> BLOCK.ilog2(), walk.triangle.number()));
            if stamp.len() >= self.config.stamp as usize || (block.is_some() && block != here) {
                break;
            }
            block = here;
            self.state.counters.fragments += 1;
            self.state.counters.bump_fragments += u64::from(polygon.bump);
            stamp.push(walk.fragment());
            self.advance();
        }
        stamp
    }
}

impl Unit for Rasterizer {
    basrelief_kernel::unit_info!("polygons to fragments: exact coverage, top-left rule");
    type In = Option<Control>;
    type Out = Option<Flow<Stamp<Fragment>>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.polygon.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = self.latency;
        match input {
            Some(control) => {
                let occupancy = self.take(&control);
                Step::after(latency, Some(Flow::Control(control))).busy(occupancy)
            }
            None => {
                let stamp = self.emit();
                Step::over(stamp.len(), self.pace, latency, Some(Flow::Item(stamp)))
            }
        }
    }

    fn is_empty(&self) -> bool {
        self.state.polygon.is_none()
    }

    /// Returns the latency, the cycles of a fragment, and those of a polygon by its number of triangles.
    fn twin_tables(&self) -> Vec<UnitTable> {
        let cycles = |triangles: u32| self.operators.stream_interval(SET_UP.times(triangles), self.config.operators());
        let set_up = (0..16).map(|triangles| vec![cycles(triangles)]).collect();
        let set_up = UnitTable { name: "set_up".into(), bits: 64, entries: set_up };
        vec![UnitTable::number("latency", self.latency), UnitTable::number("pace", self.pace), set_up]
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.latency, self.pace);
        // Floating point, as the latencies of these operators are.
        stats.shared_operators("set-up and perspective", self.config.operators(), SET_UP.and(FRAGMENT), OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "triangle", SET_UP_NUMBERS, NUMBER);
        let fragments = self.state.counters.fragments;
        stats.figure("fragments", fragments, "fragments", "Fragments found in polygons").part(FigureGroup::Work);
    }
}

/// Number of the set-up \[bits\].
const NUMBER: u32 = 32;

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_kernel::{OperandFormat, OperatorConfig};
    use basrelief_signals::{Frame, Vertex};

    fn frame(width: u32, height: u32) -> Control {
        Control::Frame(Arc::new(Frame { width, height, ..Frame::default() }))
    }

    fn polygon(corners: &[[f32; 4]]) -> Control {
        let vertices = corners.iter().map(|&position| Vertex { position, ..Vertex::default() }).collect();
        let polygon = Polygon { vertices, material: Arc::default(), object: 0, lod: 0, bump: true, arrival: 0 };
        Control::Polygon(Arc::new(polygon))
    }

    fn step(unit: &mut Rasterizer, input: Option<Control>) -> Step<Option<Flow<Stamp<Fragment>>>> {
        assert_eq!(unit.demand() == Demand::All, input.is_some());
        unit.step(input, &mut MemoryPorts::default())
    }

    fn fragments(unit: &mut Rasterizer) -> Vec<Fragment> {
        let mut all = Vec::new();
        while unit.demand() == Demand::Nothing {
            assert!(!unit.is_empty());
            match step(unit, None).out {
                Some(Flow::Item(stamp)) => all.extend(stamp),
                other => panic!("{other:?}"),
            }
        }
        all
    }

    fn drawn(config: RasterizerConfig, corners: &[[f32; 4]]) -> Vec<Fragment> {
        let mut unit = Rasterizer::new(config, Operators::default());
        step(&mut unit, Some(frame(64, 48)));
        step(&mut unit, Some(polygon(corners)));
        fragments(&mut unit)
    }

    /// Creates a rasterizer with divisions of seven cycles, not pipelined, and an abundance of all other operators.
    fn dividing(dividers: u32) -> Rasterizer {
        let config = RasterizerConfig { multipliers: 256, adders: 256, dividers, ..RasterizerConfig::default() };
        Rasterizer::new(config, Operators { divide: OperatorConfig::new(7, 7), ..Operators::default() })
    }

    #[test]
    fn dividers_limit_fragment_rate() {
        let occupancy = |dividers| {
            let mut unit = dividing(dividers);
            step(&mut unit, Some(frame(64, 48)));
            step(&mut unit, Some(polygon(&[[0.0, 0.0, 0.0, 1.0], [9.0, 0.0, 0.0, 1.0], [0.0, 9.0, 0.0, 1.0]])));
            let first = step(&mut unit, None);
            assert!(matches!(&first.out, Some(Flow::Item(stamp)) if stamp.len() == 4));
            first.occupancy
        };
        assert_eq!([1, 2, 4, 7, 14].map(occupancy), [4 * 7, 4 * 4, 4 * 2, 4, 4]);
    }

    #[test]
    fn unit_reports_operators_and_triangle_registers() {
        let mut stats = UnitStats::default();
        dividing(3).report_stats(&mut stats);
        let count = |kind| stats.all_hardware().iter().filter(|h| h.kind == kind).map(|h| h.count).sum::<u64>();
        assert_eq!([HardwareKind::Divider, HardwareKind::Registers].map(count), [3, 19]);
        // The unit takes the latencies of floating-point operators.
        let computing = stats.all_hardware().iter().filter(|piece| piece.kind.computes());
        assert!(computing.clone().all(|piece| piece.format == OperandFormat::Single) && computing.count() == 3);
    }

    #[test]
    fn control_goes_first_and_is_charged_set_up() {
        let mut unit = dividing(1);
        assert_eq!(step(&mut unit, Some(frame(8, 8))).occupancy, 1);
        let square = polygon(&[[1.0, 1.0, 0.0, 1.0], [3.0, 1.0, 0.0, 1.0], [3.0, 2.0, 0.0, 1.0], [1.0, 2.0, 0.0, 1.0]]);
        let first = step(&mut unit, Some(square.clone()));
        let latency = unit.latency;
        assert_eq!((first.out, first.occupancy, first.latency), (Some(Flow::Control(square)), 2 * 7, latency));
        let places: Vec<_> = fragments(&mut unit).iter().map(|f| (f.x, f.y)).collect();
        assert_eq!(places.len(), 2);
        assert_eq!(step(&mut unit, Some(Control::FrameEnd)).out, Some(Flow::Control(Control::FrameEnd)));
        let counters = unit.state.counters;
        assert_eq!((counters.polygons, counters.triangles, counters.fragments, counters.bump_fragments), (1, 2, 2, 2));
    }

    #[test]
    fn polygon_without_pixels_passes_only_control() {
        for corners in [
            [[1.1, 1.1, 0.0, 1.0], [1.2, 1.1, 0.0, 1.0], [1.2, 1.2, 0.0, 1.0]],
            [[1.0, 1.0, 0.0, 1.0], [5.0, 5.0, 0.0, 1.0], [9.0, 9.0, 0.0, 1.0]],
            [[-9.0, 1.0, 0.0, 1.0], [-5.0, 5.0, 0.0, 1.0], [-9.0, 9.0, 0.0, 1.0]],
            [[f32::NAN, 1.0, 0.0, 1.0], [f32::NAN, 5.0, 0.0, 1.0], [f32::NAN, 9.0, 0.0, 1.0]],
        ] {
            assert!(drawn(RasterizerConfig::default(), &corners).is_empty());
        }
        assert!(drawn(RasterizerConfig::default(), &[]).is_empty());
    }

    #[test]
    fn blocks_are_visited_row_by_row() {
        let square = [[0.0, 0.0, 0.0, 1.0], [8.0, 0.0, 0.0, 1.0], [0.0, 8.0, 0.0, 1.0]];
        let order: Vec<_> =
            drawn(RasterizerConfig::default(), &square).iter().map(|f| (f.y / 4, f.x / 4, f.y % 4, f.x % 4)).collect();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(order, sorted);
        assert_eq!(order.len(), 8 * 7 / 2);
    }

    #[test]
    fn depth_is_plane_through_vertices_in_z_steps() {
        let corners = [[0.5, 0.5, 0.0, 1.0], [32.5, 0.5, 1.0, 1.0], [0.5, 32.5, 0.5, 1.0]];
        for z_bits in [16, 24, 32] {
            let max = u32::MAX >> (32 - z_bits);
            for f in drawn(RasterizerConfig { z_bits, ..RasterizerConfig::default() }, &corners) {
                let z = (f64::from(f.x) + 0.5 * f64::from(f.y)) / 32.0 * f64::from(max);
                assert!((f64::from(f.z) - z).abs() <= 0.501, "{f:?} {z}");
            }
        }
        let beyond = [[0.0, 0.0, -1.0, 1.0], [9.0, 0.0, 2.0, 1.0], [0.0, 9.0, 2.0, 1.0]];
        let all = drawn(RasterizerConfig::default(), &beyond);
        assert_eq!(all.iter().map(|f| f.z).min(), Some(0));
        assert_eq!(all.iter().map(|f| f.z).max(), Some((1 << 24) - 1));
    }

    #[test]
    fn weights_are_perspective_correct() {
        // A road that recedes from the viewer: half way up the screen is 1 / (1 + w ratio) of its length.
        let corners = [[0.5, 40.5, 0.0, 1.0], [16.5, 0.5, 0.0, 0.25], [32.5, 40.5, 0.0, 1.0]];
        let all = drawn(RasterizerConfig::default(), &corners);
        let middle = all.iter().find(|f| (f.x, f.y) == (16, 20)).expect("inside");
        assert!((middle.weights[0] - 0.2).abs() < 1e-6, "{middle:?}");
        assert!((middle.weights[1] - 0.4).abs() < 1e-6, "{middle:?}");
    }

    #[test]
    fn damaged_one_over_w_gives_no_nan() {
        for q in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let corners = [[0.0, 0.0, 0.0, q], [9.0, 0.0, 0.0, 1.0], [0.0, 9.0, 0.0, 1.0]];
            let all = drawn(RasterizerConfig::default(), &corners);
            assert!(!all.is_empty() && all.iter().all(|f| f.weights.iter().all(|w| (0.0..=1.0).contains(w))));
        }
    }

    #[test]
    fn huge_coordinates_cover_screen() {
        for reach in [32768.0, 1e6, 1e30, f32::INFINITY] {
            let corners =
                [[-reach, -reach, 0.0, 1.0], [reach, -reach, 0.0, 1.0], [reach, reach, 0.0, 1.0], [-reach, reach, 0.0, 1.0]];
            for subpixel_bits in [1, 8, 10] {
                let all = drawn(RasterizerConfig { subpixel_bits, ..RasterizerConfig::default() }, &corners);
                assert_eq!(all.len(), 64 * 48);
            }
        }
    }
}
