//! Curves through the plane.

use basrelief_signals::MapInline as _;
use glam::DVec2;

/// A cubic B-spline of N >= 4 control points: uniform knots, but for its ends, which are the first and the last control
/// point. Twice continuously differentiable.
pub(super) struct CubicSpline<const N: usize>(pub [DVec2; N]);

impl<const N: usize> CubicSpline<N> {
    /// Pieces of the curve.
    const SPANS: usize = N - 3;

    /// The point at t in 0..=1, and the direction in which the curve leaves it; its length means nothing.
    #[inline]
    pub(super) fn at(&self, t: f64) -> (DVec2, DVec2) {
        let place = t * Self::SPANS as f64;
        let span = (place as usize).min(Self::SPANS - 1);
        let mut points = [0, 1, 2, 3].map_inline(|i| self.0[span + i]);
        // De Boor's algorithm; the last of its three rounds is left out for the direction.
        for round in 1..3 {
            Self::blend(&mut points, span, round, place);
        }
        let along = points[3] - points[2];
        Self::blend(&mut points, span, 3, place);
        (points[3], along)
    }

    #[inline]
    fn blend(points: &mut [DVec2; 4], span: usize, round: usize, place: f64) {
        for j in (round..4).rev() {
            let (low, high) = (Self::knot(span + j), Self::knot(span + j + 4 - round));
            points[j] = points[j - 1].lerp(points[j], (place - low) / (high - low));
        }
    }

    /// Four knots at each end are one.
    fn knot(i: usize) -> f64 {
        i.saturating_sub(3).min(Self::SPANS) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ZIGZAG: CubicSpline<7> = CubicSpline([
        DVec2::new(0.0, 1.0),
        DVec2::new(1.0, -1.0),
        DVec2::new(2.0, 1.0),
        DVec2::new(4.0, -1.0),
        DVec2::new(5.0, 2.0),
        DVec2::new(6.0, -1.0),
        DVec2::new(7.0, 3.0),
    ]);

    #[test]
    fn curve_starts_and_ends_at_its_outer_control_points() {
        let [(start, leaving), (end, arriving)] = [0.0, 1.0].map(|t| ZIGZAG.at(t));
        assert_eq!((start, end), (ZIGZAG.0[0], ZIGZAG.0[6]));
        assert!(leaving.perp_dot(ZIGZAG.0[1] - ZIGZAG.0[0]).abs() < 1e-12 && leaving.x > 0.0);
        assert!(arriving.perp_dot(ZIGZAG.0[6] - ZIGZAG.0[5]).abs() < 1e-12 && arriving.x > 0.0);
    }

    /// With uniform knots, the point at a knot weights its three control points 1 : 4 : 1.
    #[test]
    fn inner_knots_weigh_one_four_one() {
        let uniform = CubicSpline([0.0, 1.0, 3.0, 2.0, 5.0, 4.0, 6.0, 9.0, 7.0, 8.0].map(|y| DVec2::new(1.0, y)));
        let (point, _) = uniform.at(3.0 / 7.0);
        assert!((point.y - (2.0 + 4.0 * 5.0 + 4.0) / 6.0).abs() < 1e-12, "{point}");
    }

    #[test]
    fn spline_direction_is_continuous() {
        for i in 1..400 {
            let t = f64::from(i) / 400.0;
            let [before, after] = [t - 1e-6, t + 1e-6].map(|t| ZIGZAG.at(t).0);
            let along = ZIGZAG.at(t).1.normalize();
            assert!((along - (after - before).normalize()).length() < 1e-5, "at {t}");
        }
    }
}
