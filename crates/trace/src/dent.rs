//! Polygons that are not convex.

use crate::error::TracePlace;
use std::fmt;

/// Smallest dent that is reported \[pixels\]. Corners that a geometry processor computes at the near plane are rounded, so its polygons
/// can have smaller dents.
const LEAST_DENT: f64 = 1.0 / 16.0;

/// The polygons of a trace that are not convex. Its text is a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DentedPolygons {
    /// Place of the first one.
    pub first: TracePlace,
    /// Number of polygons, at least 1.
    pub count: u64,
}

impl fmt::Display for DentedPolygons {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, count } = self;
        write!(
            f,
            "{first}: polygon.position: the polygon is not convex or crosses itself, so image and reference image can be wrong; "
        )?;
        f.write_str("cut it into triangles")?;
        match count - 1 {
            0 => Ok(()),
            1 => f.write_str(", as well as 1 later polygon"),
            others => write!(f, ", as well as {others} later polygons"),
        }
    }
}

/// Returns true if a polygon is visibly not convex in the window. Depth and 1 / w do not matter.
pub(crate) fn is_dented(position: &[[f32; 4]]) -> bool {
    // All triangles are convex.
    if position.len() < 4 {
        return false;
    }
    let points: Vec<[f64; 2]> = position.iter().map(|&[x, y, ..]| [f64::from(x), f64::from(y)]).collect();
    let fan = || points.windows(2).map(|edge| [points[0], edge[0], edge[1]]);
    let area: f64 = fan().map(twice_area).sum();
    let next = |steps: usize| points.iter().copied().cycle().skip(steps);
    let corners = next(0).zip(next(1)).zip(next(2)).take(points.len()).map(|((a, b), c)| [a, b, c]);
    // A polygon whose corners all turn the same way can still cross itself. Then a triangle of the fan faces the other way.
    corners.chain(fan()).any(|triangle| {
        let against = -twice_area(triangle) * area.signum();
        against > LEAST_DENT * longest_side(triangle)
    })
}

/// Returns twice the signed area of a triangle.
fn twice_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn longest_side([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let squared = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
    squared(a, b).max(squared(b, c)).max(squared(c, a)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dented(points: &[[f32; 2]]) -> bool {
        let forward: Vec<[f32; 4]> = points.iter().map(|&[x, y]| [x, y, 0.5, 1.0]).collect();
        let all = (0..points.len()).map(|start| {
            let mut turned = forward.clone();
            turned.rotate_left(start);
            let found = is_dented(&turned);
            turned.reverse();
            assert_eq!(is_dented(&turned), found, "either winding");
            found
        });
        let all: Vec<bool> = all.collect();
        assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "{points:?} from any corner: {all:?}");
        all[0]
    }

    #[test]
    fn dents_and_crossings_are_found_from_any_corner() {
        assert!(dented(&[[1., 1.], [4., 3.], [7., 1.], [4., 7.]]), "dent");
        assert!(dented(&[[1., 1.], [7., 7.], [1., 7.], [7., 1.]]), "bow");
        let star = [[50., 0.], [79., 90.], [2., 35.], [98., 35.], [21., 90.]];
        assert!(dented(&star), "all corners of a pentagram turn the same way");
        assert!(!dented(&[[0., 0.], [9., 0.], [9., 9.], [0., 9.]]));
        assert!(!dented(&star[..3]), "a triangle");
    }

    #[test]
    fn rounded_and_degenerate_polygons_are_convex() {
        assert!(!dented(&[[0., 0.], [9., 0.], [9., 0.], [9., 9.], [0., 9.]]), "equal corners");
        assert!(!dented(&[[0., 0.], [4., 0.], [9., 0.], [9., 9.], [0., 9.]]), "a corner on an edge");
        assert!(!dented(&[[0., 0.], [4., 0.05], [9., 0.], [9., 9.], [0., 9.]]), "rounding");
        assert!(dented(&[[0., 0.], [4., 0.07], [9., 0.], [9., 9.], [0., 9.]]), "more than rounding");
        assert!(!dented(&[[3., 3.]; 5]), "one point");
        assert!(!dented(&[[0., 0.], [3., 0.], [9., 0.], [5., 0.]]), "a line");
    }
}
