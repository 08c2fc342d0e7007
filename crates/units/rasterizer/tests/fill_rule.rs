//! Fill rule: top-left. No pixel of a shared edge is drawn twice or missed.

use basrelief_kernel::{Demand, MemoryPorts, Operators, Unit};
use basrelief_rasterizer::{Rasterizer, RasterizerConfig};
use basrelief_signals::{Control, Flow, Frame, Polygon, Vertex};
use proptest::prelude::*;
use std::sync::Arc;

const SIDE: i64 = 24;
const STEPS: i64 = 16;
type Point = [i64; 2];

fn rasterizer(block: u32) -> Rasterizer {
    let config = RasterizerConfig { subpixel_bits: 4, block, ..RasterizerConfig::default() };
    let mut unit = Rasterizer::new(config, Operators::default());
    let frame = Frame { width: SIDE as u32, height: SIDE as u32, ..Frame::default() };
    unit.step(Some(Control::Frame(Arc::new(frame))), &mut MemoryPorts::default());
    unit
}

/// Returns the number of times that the polygons draw each pixel. Corners are in steps of 1/16 pixel.
fn drawn(polygons: &[&[Point]], block: u32) -> Vec<u8> {
    let mut count = vec![0; (SIDE * SIDE) as usize];
    let mut unit = rasterizer(block);
    for corners in polygons {
        let vertex = |p: &Point| {
            let [x, y] = p.map(|c| c as f32 / STEPS as f32);
            Vertex { position: [x, y, 0.5, 1.0], ..Vertex::default() }
        };
        let vertices = corners.iter().map(vertex).collect();
        let polygon = Polygon { vertices, material: Arc::default(), object: 0, lod: 0, bump: false, arrival: 0 };
        unit.step(Some(Control::Polygon(Arc::new(polygon))), &mut MemoryPorts::default());
        while unit.demand() == Demand::Nothing {
            match unit.step(None, &mut MemoryPorts::default()).out {
                Some(Flow::Item(stamp)) => {
                    assert!(stamp.len() <= 4 && stamp.iter().all(|f| (f.x / 4, f.y / 4) == (stamp[0].x / 4, stamp[0].y / 4)));
                    stamp.iter().for_each(|f| count[usize::from(f.y) * SIDE as usize + usize::from(f.x)] += 1);
                }
                other => panic!("a fragment, not {other:?}"),
            }
        }
    }
    count
}

fn cross(a: Point, b: Point, p: Point) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// Tests a pixel by brute force. The top-left rule shifts the sample to the right by an infinitely small step, and down by one
/// that is infinitely smaller. Then no edge goes through it.
fn inside(triangle: [Point; 3], x: i64, y: i64) -> bool {
    let centre = [x * STEPS + STEPS / 2, y * STEPS + STEPS / 2];
    let sign = cross(triangle[0], triangle[1], triangle[2]).signum();
    let side = |i: usize| {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        let ordered = [cross(a, b, centre), a[1] - b[1], b[0] - a[0]];
        ordered.into_iter().map(i64::signum).find(|s| *s != 0).unwrap_or(0)
    };
    sign != 0 && (0..3).all(|i| side(i) == sign)
}

fn brute(triangles: &[[Point; 3]]) -> Vec<u8> {
    let count = |i: i64| triangles.iter().filter(|t| inside(**t, i % SIDE, i / SIDE)).count() as u8;
    (0..SIDE * SIDE).map(count).collect()
}

/// Generates corners on and off the screen, on a grid coarse enough that pixel centres lie on edges.
fn point() -> impl Strategy<Value = Point> {
    let fine = -8 * STEPS..(SIDE + 8) * STEPS;
    let coarse = (-16..2 * SIDE + 16).prop_map(|c| c * STEPS / 2);
    prop_oneof![[fine.clone(), fine], [coarse.clone(), coarse]]
}

/// Generates triangles, including slivers: the third corner is close to the line through the others.
fn triangle() -> impl Strategy<Value = [Point; 3]> {
    let sliver = (point(), point(), 0i64..=16, -2i64..=2).prop_map(|(a, b, t, off)| {
        let c = [a[0] + (b[0] - a[0]) * t / 16 + off, a[1] + (b[1] - a[1]) * t / 16 + off];
        [a, b, c]
    });
    prop_oneof![[point(), point(), point()], sliver]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn coverage_equals_brute_force_test(t in triangle(), block in 1u32..=8) {
        prop_assert_eq!(drawn(&[&t], block), brute(&[t]));
    }

    #[test]
    fn triangles_sharing_an_edge_cover_each_pixel_once(t in triangle(), d in point()) {
        let [a, b, c] = t;
        prop_assume!(cross(a, b, c).signum() * cross(a, b, d).signum() < 0);
        let count = drawn(&[&t, &[b, a, d]], 4);
        prop_assert_eq!(&count, &brute(&[t, [a, d, b]]));
        prop_assert!(count.iter().all(|n| *n <= 1));
    }

    #[test]
    fn closed_fan_covers_each_pixel_once(
        hub in point(), spokes in prop::collection::vec((1..20 * STEPS, 0..20 * STEPS, 0usize..4), 0..8),
        first in [(1..20 * STEPS, 0..20 * STEPS), (1..20 * STEPS, 0..20 * STEPS), (1..20 * STEPS, 0..20 * STEPS), (1..20 * STEPS, 0..20 * STEPS)],
    ) {
        let rim = rim(hub, &first, &spokes);
        let n = rim.len();
        let wedges: Vec<[Point; 3]> = (0..n).map(|i| [hub, rim[i], rim[(i + 1) % n]]).collect();
        let polygons: Vec<&[Point]> = wedges.iter().map(|t| &t[..]).collect();
        let count = drawn(&polygons, 4);
        prop_assert_eq!(&count, &brute(&wedges));
        prop_assert!(count.iter().all(|n| *n <= 1));
        let centre = (hub[0] / STEPS, hub[1] / STEPS);
        if hub == [centre.0 * STEPS + STEPS / 2, centre.1 * STEPS + STEPS / 2] && (0..SIDE).contains(&centre.0) && (0..SIDE).contains(&centre.1) {
            prop_assert_eq!(count[(centre.1 * SIDE + centre.0) as usize], 1);
        }
    }

    /// The fifth corner of the polygon moves over the diagonal from the first corner by a few steps, as snapping may do. The
    /// polygon, with the triangles that fill its dent and its outside, must still tile the plane.
    #[test]
    fn snapped_polygon_still_meets_its_neighbours(
        t in triangle(), share in 1i64..16, dent in -3i64..=3, turn in 0usize..4,
    ) {
        let [a, b, c] = t;
        prop_assume!(cross(a, b, c) != 0);
        let on_edge = [a[0] + (c[0] - a[0]) * share / 16 + dent, a[1] + (c[1] - a[1]) * share / 16 - dent];
        // The quad a b c e and the triangle a c e share the edges a-e and e-c. If e is inside, they form the triangle a b c
        // together. If e is outside, e's triangle adds to a b c.
        let mut quad = [a, b, c, on_edge];
        prop_assume!(simple(quad));
        quad.rotate_left(turn);
        let count = drawn(&[&quad], 4);
        let (whole, cap) = (brute(&[t]), brute(&[[a, c, on_edge]]));
        let outward = cross(a, b, c).signum() * cross(a, c, on_edge).signum() >= 0;
        let expected: Vec<u8> =
            whole.iter().zip(&cap).map(|(w, k)| if outward { w + k } else { w.saturating_sub(*k) }).collect();
        prop_assert_eq!(count, expected);
    }
}

/// Returns true if no edge of the quad crosses the opposite one: its last corner is on the far side of `b`, or inside `a b c`.
fn simple([a, b, c, e]: [Point; 4]) -> bool {
    let s = cross(a, b, c).signum();
    cross(a, b, e).signum() == s && cross(b, c, e).signum() == s
}

/// Returns points around the hub in order of angle, at least one in each quadrant, so that no wedge reaches 180 degrees.
fn rim(hub: Point, first: &[(i64, i64); 4], spokes: &[(i64, i64, usize)]) -> Vec<Point> {
    let mut rim = Vec::new();
    for quadrant in 0..4 {
        let mut offsets: Vec<Point> = spokes.iter().filter(|s| s.2 == quadrant).map(|s| [s.0, s.1]).collect();
        offsets.push([first[quadrant].0, first[quadrant].1]);
        offsets.sort_by_key(|[x, y]| (y * 1_000_000 / x, *x));
        offsets.dedup_by(|a, b| a[0] * b[1] == a[1] * b[0]);
        let turn = |[x, y]: Point| [[x, y], [-y, x], [-x, -y], [y, -x]][quadrant];
        rim.extend(offsets.into_iter().map(turn).map(|[x, y]| [hub[0] + x, hub[1] + y]));
    }
    rim
}
