//! Cholesky factor of a covariance matrix that grows by one point at a time.
//!
//! Linear algebra libraries choose instructions by processor, so their last bits differ between machines, and so would the choices of an
//! exploration. These loops add in one order.

/// Lower triangular matrix `L` with `L L^T = K`. Row `n` has `n + 1` numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct Cholesky {
    rows: Vec<Vec<f64>>,
}

impl Cholesky {
    /// Adds a row of `K`: the covariances with all earlier points, then the variance of the point. Returns false, and adds nothing, if
    /// rounding leaves no positive remainder.
    pub(super) fn push(&mut self, mut row: Vec<f64>) -> bool {
        let n = self.rows.len();
        for (j, other) in self.rows.iter().enumerate() {
            row[j] = (row[j] - dot(&row[..j], other)) / other[j];
        }
        let rest = row[n] - dot(&row[..n], &row);
        if rest > 0.0 {
            row[n] = rest.sqrt();
            self.rows.push(row);
        }
        rest > 0.0
    }

    /// Solves `L x = y`.
    pub(super) fn forward(&self, y: &[f64]) -> Vec<f64> {
        let mut x = Vec::with_capacity(y.len());
        self.extend_forward(&mut x, y);
        x
    }

    /// Extends a solution of `L x = y` to the rows that were added since.
    pub(super) fn extend_forward(&self, x: &mut Vec<f64>, y: &[f64]) {
        let solved = x.len();
        for (row, y) in self.rows.iter().zip(y).skip(solved) {
            let rest = y - dot(x, row);
            x.push(rest / row[x.len()]);
        }
    }

    /// Solves `L^T x = y`.
    pub(super) fn backward(&self, mut y: Vec<f64>) -> Vec<f64> {
        for (n, row) in self.rows.iter().enumerate().rev() {
            y[n] /= row[n];
            let x = y[n];
            y[..n].iter_mut().zip(row).for_each(|(y, k)| *y -= x * k);
        }
        y
    }

    /// Returns half the logarithm of the determinant of `K`.
    pub(super) fn half_log_determinant(&self) -> f64 {
        self.rows.iter().enumerate().map(|(n, row)| libm::log(row[n])).sum()
    }
}

/// Returns the sum of products over the shorter length. Four sums run side by side, because each addition waits for the one before.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, b) = (a[..length].chunks_exact(4), b[..length].chunks_exact(4));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 4];
    for (a, b) in a.zip(b) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_solves_the_system() {
        let k = [[4.0, 2.0, 0.5], [2.0, 5.0, 1.0], [0.5, 1.0, 3.0]];
        let mut factor = Cholesky::default();
        assert!(k.iter().enumerate().all(|(n, row)| factor.push(row[..=n].to_vec())));
        let x = factor.backward(factor.forward(&[1.0, -2.0, 3.0]));
        for (row, y) in k.iter().zip([1.0, -2.0, 3.0]) {
            assert!((dot(row, &x) - y).abs() < 1e-12, "{x:?}");
        }
        let determinant: f64 = 4.0 * (15.0 - 1.0) - 2.0 * (6.0 - 0.5) + 0.5 * (2.0 - 2.5);
        assert!((2.0 * factor.half_log_determinant() - determinant.ln()).abs() < 1e-12);
        // A point that is a copy of the first leaves no remainder.
        assert!(!factor.push(vec![4.0, 2.0, 0.5, 4.0]));
    }
}
