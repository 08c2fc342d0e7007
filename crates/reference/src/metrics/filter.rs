//! Separable filters over planes of `f64`.

use std::ops::Range;

/// Continuation of a picture beyond its rim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RimMode {
    /// The rim pixel is repeated.
    Extended,
    /// The picture is mirrored, including the rim pixel.
    Mirrored,
}

/// Part of a picture on which filters are computed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FilterWindow {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

impl FilterWindow {
    pub fn width(&self) -> usize {
        self.columns.len()
    }

    pub fn pixels(&self) -> usize {
        self.columns.len() * self.rows.len()
    }
}

/// Pixels processed at a time. Larger pictures are processed strip by strip, so that intermediate results of a large picture are
/// never all in memory.
pub(crate) const STRIP_PIXELS: usize = 1 << 19;
/// Least rows of a strip, if the window has that many. Up to twenty more are filtered for it. The stored rows therefore take at
/// most 37 bytes per pixel.
pub(crate) const STRIP_ROWS: usize = 64;

/// Rows of a strip, and the rows that its filters reach.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RowStrip {
    pub rows: Range<usize>,
    pub reached: Range<usize>,
}

impl RowStrip {
    /// Divides a window into strips of about this many pixels. A filter of this radius has the same result in a strip as in the
    /// whole window: the strip's rim is the window's, or lies beyond the reach of the filter.
    pub fn all(pixels: usize, window: &FilterWindow, radius: usize) -> Vec<Self> {
        if window.pixels() == 0 {
            return Vec::new();
        }
        let Range { start, end } = window.rows;
        let height = (pixels / window.width()).clamp(1, window.rows.len());
        let strip = |row: usize| {
            let rows = row..(row + height).min(end);
            Self { reached: row.saturating_sub(radius).max(start)..(rows.end + radius).min(end), rows }
        };
        (start..end).step_by(height).map(strip).collect()
    }
}

/// Weights at -radius..=radius.
#[derive(Clone, Debug)]
pub(crate) struct FilterKernel(pub Vec<f64>);

impl FilterKernel {
    /// Creates weights `f(-radius) ..= f(radius)`.
    pub fn new(radius: usize, f: impl Fn(f64) -> f64) -> Self {
        let radius = radius as i32;
        Self((-radius..=radius).map(|x| f(f64::from(x))).collect())
    }

    /// Scales the weights so that positive ones sum to 1 and negative ones to -1.
    pub fn normalised(mut self) -> Self {
        let total = |sign: f64| self.0.iter().map(|w| (w * sign).max(0.0)).sum::<f64>();
        let (positive, negative) = (total(1.0), total(-1.0));
        for weight in &mut self.0 {
            *weight /= if *weight > 0.0 { positive } else { negative.max(f64::MIN_POSITIVE) };
        }
        self
    }

    fn radius(&self) -> usize {
        self.0.len() / 2
    }

    /// Adds the weighted rows that the taps 0, 1, .. read. Four taps at a time load and store the sums a quarter as often, which
    /// halves the time of a filter.
    fn add_taps<'a>(&self, sums: &mut [f64], row: impl Fn(usize) -> &'a [f64]) {
        let mut taps = self.0.chunks_exact(4);
        let mut first = 0;
        for weights in &mut taps {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| row(first + k));
            for ((((sum, a), b), c), d) in sums.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *sum += a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3];
            }
            first += 4;
        }
        for (k, weight) in taps.remainder().iter().enumerate() {
            for (sum, value) in sums.iter_mut().zip(row(first + k)) {
                *sum += value * weight;
            }
        }
    }
}

/// Size of a plane \[values\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneSize {
    pub width: usize,
    pub height: usize,
}

/// Last rows of a plane, filtered across: as many as a filter down the plane reads. Some twenty whole planes would come from
/// memory in every pass, and from the operating system for every picture: two threads lost two fifths of their time there.
#[derive(Clone, Debug)]
pub(crate) struct FilteredRows<'a> {
    across: &'a FilterKernel,
    rim: RimMode,
    width: usize,
    height: usize,
    /// Ring buffer of rows.
    values: Vec<f64>,
    /// A row, extended beyond its rim on both sides.
    padded: Vec<f64>,
}

impl<'a> FilteredRows<'a> {
    /// Creates a buffer for a plane of this size. Rows are received up to a radius ahead of the row that is filtered
    /// down.
    pub fn new(across: &'a FilterKernel, radius: usize, size: PlaneSize, rim: RimMode) -> Self {
        let PlaneSize { width, height } = size;
        let held = height.min(2 * radius + 1);
        Self { across, rim, width, height, values: vec![0.0; held * width], padded: vec![0.0; width + 2 * across.radius()] }
    }

    fn held(&self, row: usize) -> Range<usize> {
        let first = row * self.width % self.values.len();
        first..first + self.width
    }

    /// Receives a row of the plane. Rows arrive in order.
    pub fn take(&mut self, row: usize, values: &[f64]) {
        let (radius, width) = (self.across.radius(), self.width);
        let rim = |i: usize| self.rim.inside(i as isize - radius as isize, width);
        let held = self.held(row);
        let padded = &mut self.padded;
        padded[radius..radius + width].copy_from_slice(values);
        (0..radius).chain(radius + width..width + 2 * radius).for_each(|i| padded[i] = values[rim(i)]);
        let out = &mut self.values[held];
        out.fill(0.0);
        self.across.add_taps(out, |k| &self.padded[k..k + width]);
    }

    /// Returns a row of the plane, filtered both across and down.
    pub fn down(&self, row: usize, kernel: &FilterKernel, out: &mut [f64]) {
        out.fill(0.0);
        kernel.add_taps(out, |k| {
            let from = self.rim.inside((row + k) as isize - kernel.radius() as isize, self.height);
            &self.values[self.held(from)]
        });
    }
}

/// Returns the existing rows up to `last` that were not received before, and marks them as received.
pub(crate) fn due(taken: &mut usize, last: usize, height: usize) -> Range<usize> {
    let until = height.min(last + 1);
    std::mem::replace(taken, until)..until
}

impl RimMode {
    fn inside(self, at: isize, size: usize) -> usize {
        let size = size as isize;
        let inside = match self {
            RimMode::Extended => at.clamp(0, size - 1),
            RimMode::Mirrored => {
                let folded = at.rem_euclid(2 * size);
                if folded < size { folded } else { 2 * size - 1 - folded }
            }
        };
        inside as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a plane filtered across and down. Without kernels it is unchanged.
    fn filtered(plane: &[f64], width: usize, kernels: [Option<&FilterKernel>; 2], rim: RimMode) -> Vec<f64> {
        let same = FilterKernel(vec![1.0]);
        let [across, down] = kernels.map(|kernel| kernel.unwrap_or(&same));
        let (height, radius) = (plane.len() / width, down.radius());
        let mut rows = FilteredRows::new(across, radius, PlaneSize { width, height }, rim);
        let mut result = vec![0.0; plane.len()];
        let mut taken = 0;
        for (row, out) in result.chunks_exact_mut(width).enumerate() {
            for due in due(&mut taken, row + radius, height) {
                rows.take(due, &plane[due * width..][..width]);
            }
            rows.down(row, down, out);
        }
        result
    }

    #[test]
    fn kernel_normalises_positive_and_negative_weights() {
        let kernel = FilterKernel::new(2, |x| -x).normalised();
        assert_eq!(kernel.0, [2.0 / 3.0, 1.0 / 3.0, 0.0, -1.0 / 3.0, -2.0 / 3.0]);
    }

    #[test]
    fn rims_extend_or_mirror() {
        let kernel = FilterKernel(vec![1.0, 0.0, 0.0, 0.0, 0.0]);
        let row = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(filtered(&row, 4, [Some(&kernel), None], RimMode::Extended), [1.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&row, 4, [Some(&kernel), None], RimMode::Mirrored), [2.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&row, 1, [None, Some(&kernel)], RimMode::Extended), [1.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&row, 1, [None, Some(&kernel)], RimMode::Mirrored), [2.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&[5.0, 6.0], 2, [None, Some(&kernel)], RimMode::Mirrored), [5.0, 6.0]);
    }

    #[test]
    fn plane_may_have_more_rows_than_buffer() {
        let plane: Vec<f64> = (0..9).map(f64::from).collect();
        let two_up = FilterKernel(vec![1.0, 0.0, 0.0, 0.0, 0.0]);
        let two_down = FilterKernel(vec![0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(filtered(&plane, 1, [None, Some(&two_up)], RimMode::Extended), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(
            filtered(&plane, 1, [None, Some(&two_down)], RimMode::Mirrored),
            [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.0, 7.0]
        );
    }
}
