//! Matrices of a draw call: from object to clip space, and their parts.

use glam::{DMat4, DVec3, DVec4};
use serde_json::Value;

/// Largest deviation from an affine matrix, relative to its largest element. Dumps have seven digits.
const ROUNDING: f64 = 1e-4;

/// Returns a 4 x 4 matrix of a dump: four lists of columns, or 16 numbers column by column. `None` for other values.
pub(crate) fn matrix(value: &Value) -> Option<DMat4> {
    let list = value.as_array()?;
    let numbers: Option<Vec<f64>> = if list.len() == 16 {
        list.iter().map(Value::as_f64).collect()
    } else {
        let columns: Vec<&Vec<Value>> = list.iter().filter_map(Value::as_array).filter(|column| column.len() == 4).collect();
        (list.len() == 4 && columns.len() == 4).then(|| columns.into_iter().flatten().map(Value::as_f64).collect()).flatten()
    };
    let numbers: [f64; 16] = numbers?.try_into().ok()?;
    Some(DMat4::from_cols_array(&numbers)).filter(|matrix| matrix.is_finite())
}

/// Returns an affine matrix with the exact last row; `None` if the matrix is far from affine or cannot be inverted.
pub(crate) fn affine(matrix: DMat4) -> Option<DMat4> {
    let largest = matrix.to_cols_array().into_iter().fold(0.0, |largest: f64, element| largest.max(element.abs()));
    let last = matrix.row(3) / matrix.w_axis.w;
    let is_affine = last.is_finite() && (last - DVec4::W).length() <= ROUNDING * largest.max(1.0);
    let mut exact = matrix * (1.0 / matrix.w_axis.w);
    for (column, element) in
        [(&mut exact.x_axis, 0.0), (&mut exact.y_axis, 0.0), (&mut exact.z_axis, 0.0), (&mut exact.w_axis, 1.0)]
    {
        column.w = element;
    }
    (is_affine && exact.is_finite() && exact.determinant() != 0.0).then_some(exact)
}

/// Returns the model-view matrix of a normal matrix, which is its inverse transpose.
pub(crate) fn from_normal_matrix(normal: DMat4) -> Option<DMat4> {
    (normal.determinant() != 0.0).then(|| normal.transpose().inverse()).and_then(affine)
}

/// Returns the model-view matrix of a product with a projection that has no skew, if the model is scaled equally along all axes.
///
/// The last row of the product is the negated third row of the model-view matrix (perspective), or (0, 0, 0, 1) (parallel).
pub(crate) fn model_view_of(product: DMat4) -> Option<DMat4> {
    let [x, y, w] = [product.row(0), product.row(1), product.row(3)];
    let scale = w.truncate().length();
    let (z, across) = if scale > f64::EPSILON * w.w.abs() {
        (w * (-1.0 / scale), x.truncate())
    } else {
        let z = x.truncate().cross(y.truncate()).try_normalize()?;
        (z.extend(0.0), x.truncate())
    };
    let back = z.truncate();
    let right = (across - back * back.dot(across)).try_normalize()?;
    let up = back.cross(right);
    let share = |row: DVec4, axis: DVec3| row.truncate().dot(axis);
    // Distances along the axes: the projection maps x_eye to share * x_eye + skew * z_eye.
    let offset = |row: DVec4, axis: DVec3| {
        let depth = if scale > f64::EPSILON * w.w.abs() { row.truncate().dot(back) * z.w } else { 0.0 };
        (row.w - depth) / share(row, axis)
    };
    let rows = [right.extend(offset(x, right)), up.extend(offset(y, up)), back.extend(z.w), DVec4::W];
    let result = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    let is_straight = share(y, right).abs() <= ROUNDING * share(y, up).abs();
    (is_straight && result.is_finite()).then_some(result)
}

/// Returns the unit direction from the scene to the viewer: against the view axis.
pub(crate) fn to_viewer(view_projection: DMat4) -> DVec3 {
    let perspective = -view_projection.row(3).truncate();
    let parallel = -view_projection.row(2).truncate();
    perspective.try_normalize().or(parallel.try_normalize()).unwrap_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn model_view() -> DMat4 {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
        DMat4::from_rotation_translation(turn, DVec3::new(0.3, -0.2, -5.0))
    }

    fn perspective() -> DMat4 {
        DMat4::from_cols_array(&[1.3, 0., 0., 0., 0., 1.7, 0., 0., 0.1, -0.2, -1.1, -1., 0., 0., -2.1, 0.])
    }

    fn rounded(matrix: DMat4) -> DMat4 {
        DMat4::from_cols_array(&matrix.to_cols_array().map(|element| f64::from(element as f32)))
    }

    fn assert_near(found: Option<DMat4>, expected: DMat4) {
        let found = found.unwrap();
        assert!(found.abs_diff_eq(expected, 1e-5), "{found} {expected}");
    }

    #[test]
    fn perspective_product_yields_its_model_view() {
        assert_near(model_view_of(rounded(perspective() * model_view())), model_view());
    }

    #[test]
    fn parallel_product_yields_its_rotation() {
        let parallel = DMat4::from_diagonal(DVec4::new(0.5, 0.7, -0.1, 1.0));
        let found = model_view_of(parallel * model_view()).unwrap();
        let axis = found.row(2).truncate();
        assert!((axis - model_view().row(2).truncate()).length() < 1e-9, "{axis}");
    }

    #[test]
    fn normal_matrix_yields_its_model_view() {
        assert_near(from_normal_matrix(rounded(model_view().inverse().transpose())), model_view());
    }

    #[test]
    fn projection_is_not_affine() {
        assert_eq!(affine(perspective()), None);
        let mut near = model_view();
        near.x_axis.w = 1e-7;
        assert_eq!(affine(near), Some(model_view()));
        near.x_axis.w = 0.1;
        assert_eq!(affine(near), None);
    }

    #[test]
    fn viewer_is_against_the_view_axis() {
        assert_eq!(to_viewer(perspective()), DVec3::Z);
        assert_eq!(to_viewer(DMat4::from_diagonal(DVec4::new(1.0, 1.0, -0.5, 1.0))), DVec3::Z);
    }

    #[test]
    fn both_forms_of_a_matrix_are_read() {
        let nested = serde_json::json!([[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12], [13, 14, 15, 16]]);
        let flat = serde_json::json!([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]);
        assert_eq!(matrix(&nested), matrix(&flat));
        assert_eq!(matrix(&flat).unwrap().w_axis, DVec4::new(13., 14., 15., 16.));
        assert_eq!(matrix(&serde_json::json!([1, 2])), None);
        assert_eq!(matrix(&serde_json::json!([[1], [2], [3], [4]])), None);
    }
}
