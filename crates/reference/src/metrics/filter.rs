//! Separable filters over planes of `f64`.

use std::ops::Range;

/// What lies beyond the rim of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rim {
    /// The rim pixel extends.
    Extended,
    /// The picture is mirrored, rim pixel included.
    Mirrored,
}

/// The part of a picture that filters are computed on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

impl Window {
    pub fn width(&self) -> usize {
        self.columns.len()
    }

    pub fn pixels(&self) -> usize {
        self.columns.len() * self.rows.len()
    }
}

/// Pixels that are looked at at a time: where there are more, it is done strip by strip, so that what is found of a large picture is
/// never in memory as a whole.
pub(crate) const STRIP_PIXELS: usize = 1 << 19;
/// Rows that a strip has, at least, where there are so many: up to twenty more are filtered for it. So the rows that are held take no more
/// than 37 bytes per pixel.
pub(crate) const STRIP_ROWS: usize = 64;

/// Rows that are looked at, and those that filters reach from there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Strip {
    pub rows: Range<usize>,
    pub reached: Range<usize>,
}

impl Strip {
    /// The strips of a window, of about so many pixels. What is filtered in one is what it would be of the whole window: its rim is
    /// the window's, or lies beyond what filters of this radius reach.
    pub fn all(pixels: usize, window: &Window, radius: usize) -> Vec<Self> {
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
pub(crate) struct Kernel(pub Vec<f64>);

impl Kernel {
    /// Weights `f(-radius) ..= f(radius)`.
    pub fn new(radius: usize, f: impl Fn(f64) -> f64) -> Self {
        let radius = radius as i32;
        Self((-radius..=radius).map(|x| f(f64::from(x))).collect())
    }

    /// Scaled so that positive weights sum to 1 and negative ones to -1.
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

    /// Adds the weighted rows that the taps 0, 1, .. read. Four taps at a time: the sums are then loaded and stored a
    /// quarter as often, which halves the time of a filter.
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

/// The last rows of a plane, filtered across: as many as a filter down the plane reads. Whole planes, some twenty of them, would have to
/// come from memory for every pass, and from the operating system for every picture: two threads lost two fifths of their time there.
#[derive(Clone, Debug)]
pub(crate) struct Rows<'a> {
    across: &'a Kernel,
    rim: Rim,
    width: usize,
    height: usize,
    /// A ring of rows.
    values: Vec<f64>,
    /// A row, with what lies beyond its rim on both sides.
    padded: Vec<f64>,
}

impl<'a> Rows<'a> {
    /// Of a plane of this width and height, whose rows are taken in up to a radius ahead of the one that is filtered down.
    pub fn new(across: &'a Kernel, radius: usize, (width, height): (usize, usize), rim: Rim) -> Self {
        let held = height.min(2 * radius + 1);
        Self { across, rim, width, height, values: vec![0.0; held * width], padded: vec![0.0; width + 2 * across.radius()] }
    }

    fn held(&self, row: usize) -> Range<usize> {
        let first = row * self.width % self.values.len();
        first..first + self.width
    }

    /// Takes in a row of the plane. They come in order.
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

    /// A row of the plane, filtered down, too.
    pub fn down(&self, row: usize, kernel: &Kernel, out: &mut [f64]) {
        out.fill(0.0);
        kernel.add_taps(out, |k| {
            let from = self.rim.inside((row + k) as isize - kernel.radius() as isize, self.height);
            &self.values[self.held(from)]
        });
    }
}

/// Rows up to `last`, as far as there are such, that have not been taken yet: they are then.
pub(crate) fn due(taken: &mut usize, last: usize, height: usize) -> Range<usize> {
    let until = height.min(last + 1);
    std::mem::replace(taken, until)..until
}

impl Rim {
    fn inside(self, at: isize, size: usize) -> usize {
        let size = size as isize;
        let inside = match self {
            Rim::Extended => at.clamp(0, size - 1),
            Rim::Mirrored => {
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

    /// A plane, filtered across and down; by no kernel it stays as it is.
    fn filtered(plane: &[f64], width: usize, kernels: [Option<&Kernel>; 2], rim: Rim) -> Vec<f64> {
        let same = Kernel(vec![1.0]);
        let [across, down] = kernels.map(|kernel| kernel.unwrap_or(&same));
        let (height, radius) = (plane.len() / width, down.radius());
        let mut rows = Rows::new(across, radius, (width, height), rim);
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
    fn kernels_normalise_positive_and_negative_weights_apart() {
        let kernel = Kernel::new(2, |x| -x).normalised();
        assert_eq!(kernel.0, [2.0 / 3.0, 1.0 / 3.0, 0.0, -1.0 / 3.0, -2.0 / 3.0]);
    }

    #[test]
    fn rims_extend_or_mirror() {
        let kernel = Kernel(vec![1.0, 0.0, 0.0, 0.0, 0.0]);
        let row = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(filtered(&row, 4, [Some(&kernel), None], Rim::Extended), [1.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&row, 4, [Some(&kernel), None], Rim::Mirrored), [2.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&row, 1, [None, Some(&kernel)], Rim::Extended), [1.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&row, 1, [None, Some(&kernel)], Rim::Mirrored), [2.0, 1.0, 1.0, 2.0]);
        assert_eq!(filtered(&[5.0, 6.0], 2, [None, Some(&kernel)], Rim::Mirrored), [5.0, 6.0]);
    }

    #[test]
    fn a_plane_has_more_rows_than_are_held() {
        let plane: Vec<f64> = (0..9).map(f64::from).collect();
        let two_up = Kernel(vec![1.0, 0.0, 0.0, 0.0, 0.0]);
        let two_down = Kernel(vec![0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(filtered(&plane, 1, [None, Some(&two_up)], Rim::Extended), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(filtered(&plane, 1, [None, Some(&two_down)], Rim::Mirrored), [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.0, 7.0]);
    }
}
