//! Moves of the vertices of a skinned primitive.

use crate::SceneError;
use basrelief_signals::Mesh;
use glam::{DMat3, DMat4, DVec3, DVec4};

/// Matrix of each vertex of a primitive, from mesh space to the world.
pub(crate) struct VertexMatrices {
    pub matrices: Vec<DMat4>,
}

impl VertexMatrices {
    /// Moves positions, normals and tangents to where the joints take them.
    pub fn pose(
        &self,
        mesh: &mut Mesh,
        normals: Option<&mut Vec<[f32; 3]>>,
        tangents: Option<&mut Vec<[f32; 4]>>,
        place: &str,
    ) -> Result<(), SceneError> {
        for (position, matrix) in mesh.positions.iter_mut().zip(&self.matrices) {
            *position = matrix.transform_point3(DVec3::from_array(position.map(f64::from))).as_vec3().to_array();
        }
        if mesh.positions.iter().flatten().any(|c| !c.is_finite()) {
            return Err(
                SceneError::at(place, "its skin moves vertices beyond single precision").expected("joints of ordinary size")
            );
        }
        for (normal, matrix) in normals.into_iter().flatten().zip(&self.matrices) {
            let n = DVec3::from_array(normal.map(f64::from));
            *normal = (cofactors(matrix) * n).normalize_or_zero().as_vec3().to_array();
        }
        for (tangent, matrix) in tangents.into_iter().flatten().zip(&self.matrices) {
            let [x, y, z, w] = tangent.map(f64::from);
            let t = matrix.transform_vector3(DVec3::new(x, y, z)).normalize_or_zero();
            *tangent = DVec4::from((t, w)).as_vec4().to_array();
        }
        Ok(())
    }
}

/// Takes normals to where a matrix takes surfaces: its inverse transpose up to a factor of positive sign.
fn cofactors(matrix: &DMat4) -> DMat3 {
    let linear = DMat3::from_mat4(*matrix);
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}
