//! Scan of a polygon's dots in both circuits and process 24: the same dots in the same order.

use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{HardwareKind, OperandWidth, OperatorCounts, Operators};
use basrelief_shading::{AttributeGradient, PolygonScan, RasterGrid, fan_triangles};
use basrelief_signals::width::{COORDINATE, NUMBER};
use basrelief_signals::{Fragment, Polygon};
use serde::{Deserialize, Serialize};

/// Arithmetic of a triangle's scan: x and y of three corners in steps of the grid; two differences, two products and a difference
/// for each edge; sign and reciprocal of the area.
pub(crate) const SCAN_SET_UP: OperatorCounts = OperatorCounts { multiply: 6 + 6, add: 6 + 9, divide: 1, ..OperatorCounts::NONE };
/// Arithmetic of two slopes of the depth.
pub(crate) const DEPTH_SET_UP: OperatorCounts = OperatorCounts { multiply: 6, add: 4, ..OperatorCounts::NONE };
/// Arithmetic of two differences between the corners for each of three values.
const VALUES_SET_UP: OperatorCounts = OperatorCounts { add: 6, ..OperatorCounts::NONE };
/// Longest dependent chain of a triangle's set-up in a circuit: steps of the grid, differences of the corners, area, its
/// reciprocal.
const SET_UP_CHAIN: OperatorCounts = OperatorCounts { multiply: 2, add: 3, divide: 1, ..OperatorCounts::NONE };
/// Operators of a circuit for the set-up.
const SET_UP_UNITS: OperatorCounts = OperatorCounts { multiply: 1, add: 1, divide: 1, ..OperatorCounts::NONE };
/// Longest dependent chain from a triangle's slopes to a value at a dot: `a + w1 * (b - a) + w2 * (c - a)`.
pub(crate) const INTERPOLATION: OperatorCounts = OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE };
/// Arithmetic of the three values of a dot: two products and two sums each.
const THREE_VALUES: OperatorCounts = OperatorCounts { multiply: 6, add: 6, ..OperatorCounts::NONE };

/// Returns the occupancy of a circuit by the triangles of a polygon's fan before its dots, one after the other \[cycles\]. A
/// circuit with `depth` also sets up the slopes of the depth. A triangle takes at least its longest dependent chain.
pub(crate) fn set_up_cycles(polygon: &Polygon, depth: bool, operators: &Operators) -> u64 {
    triangle_cycles(depth, operators) * u64::from(fan_triangles(polygon))
}

/// Returns the occupancy of a circuit by the set-up of a triangle \[cycles\].
pub(crate) fn triangle_cycles(depth: bool, operators: &Operators) -> u64 {
    let work = SCAN_SET_UP.and(VALUES_SET_UP).and(if depth { DEPTH_SET_UP } else { OperatorCounts::NONE });
    operators.interval(work, SET_UP_UNITS).max(operators.latency(SET_UP_CHAIN))
}

/// Reports the hardware of a circuit that scans polygons and interpolates three numbers at each dot, every `interval` cycles.
pub(crate) fn tell_interpolator(stats: &mut UnitStats, operators: &Operators, interval: u32) {
    let have = operators.sustaining(THREE_VALUES, interval);
    stats.hardware(HardwareKind::Multiplier, "interpolation", have.multiply, OperandWidth::SINGLE);
    stats.hardware(HardwareKind::Adder, "the same", have.add, OperandWidth::SINGLE);
    stats.hardware(HardwareKind::Adder, "steps of three edges", 3_u64, OperandWidth::SINGLE);
    let work = SCAN_SET_UP.and(VALUES_SET_UP);
    stats.shared_operators("set-up of a triangle", SET_UP_UNITS, work, OperandWidth::SINGLE);
    stats.hardware(HardwareKind::Registers, "scan: column, row", 2_u64, COORDINATE);
    stats.hardware(HardwareKind::Registers, "scan: three edges, value and two slopes each", 9_u64, NUMBER);
    stats.hardware(HardwareKind::Registers, "three values at three corners", 9_u64, NUMBER);
}

/// A polygon in progress. The scan stands on a dot, or past the last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DotScan {
    scan: PolygonScan,
    more: bool,
}

impl DotScan {
    /// Creates a scan on the first dot of `polygon`.
    pub(crate) fn new(polygon: &Polygon, raster: RasterGrid) -> Self {
        let mut scan = PolygonScan::new(polygon, raster);
        let more = scan.advance(polygon);
        Self { scan, more }
    }

    /// Returns the next dot, with the weights of equation (6). Returns `None` past the last.
    #[inline]
    pub(crate) fn next(&mut self, polygon: &Polygon) -> Option<Fragment> {
        if !self.more {
            return None;
        }
        let dot = self.scan.walk.linear_fragment();
        self.more = self.scan.advance(polygon);
        Some(dot)
    }
}

/// Three numbers at the corners of a triangle of the fan, interpolated with the weights of equation (6).
///
/// With (alpha, beta, gamma) of a scan line through edges P1P2 and P1P3, the weights of P2 and P3 are (1-alpha)*gamma and
/// (1-beta)*(1-gamma), and P1 has the rest. These are the shares of the triangle's area that lie opposite the corners,
/// independent of the edges that the line cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CornerValues {
    /// Number of the triangle, counted from 1. 0 means no triangle yet.
    triangle: u32,
    values: [[f32; 3]; 3],
}

impl CornerValues {
    /// Returns the values at `dot`. `points` returns the values of each sample point.
    #[inline]
    pub(crate) fn at(&mut self, dot: &Fragment, points: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        if self.triangle != u32::from(dot.triangle) + 1 {
            let i = usize::from(dot.triangle);
            *self = Self { triangle: u32::from(dot.triangle) + 1, values: [points(0), points(i + 1), points(i + 2)] };
        }
        let [a, b, c] = &self.values;
        AttributeGradient::new([a, b, c]).at(dot.weights)
    }
}
