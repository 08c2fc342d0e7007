//! Transform from object space to clip and world space.

use basrelief_kernel::OperatorCounts;
use basrelief_signals::{Mesh, Object, Vertex};
use glam::{DMat3, DMat4, DVec3, Mat3, Mat4, Vec3, Vec4};
use serde::{Deserialize, Serialize};

/// A vertex in clip space. The `position` of its attributes is still empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClipCorner {
    /// Clip-space position.
    pub clip: Vec4,
    /// Attributes in world space.
    pub vertex: Vertex,
}

/// Matrices of an object in a frame. Products are computed in double precision and rounded once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectTransform {
    /// Matrix from object to clip space.
    clip: Mat4,
    /// Matrix of directions from object to world space.
    direction: Mat3,
    /// Matrix of normals from object to world space, up to a positive factor.
    normal: Mat3,
    /// True if the world matrix turns counter-clockwise into clockwise.
    pub mirrored: bool,
}

/// Creates a matrix from row-major storage.
fn matrix(rows: &[f64; 16]) -> DMat4 {
    DMat4::from_cols_array(rows).transpose()
}

impl ObjectTransform {
    /// Arithmetic of the matrices of an object: a product of two 4 x 4 matrices, nine cofactors, the scale of the largest, the
    /// sign of the determinant.
    pub const OF_OBJECT: OperatorCounts =
        OperatorCounts { multiply: 64 + 18 + 9 + 3, add: 48 + 9 + 8 + 2, divide: 1, ..OperatorCounts::NONE };
    /// Arithmetic of a position (w = 1) times a 4 x 4 matrix.
    pub const POSITION: OperatorCounts = OperatorCounts { multiply: 12, add: 12, ..OperatorCounts::NONE };
    /// Arithmetic of a normal or a tangent times a 3 x 3 matrix, made unit.
    pub const DIRECTION: OperatorCounts =
        OperatorCounts { multiply: 9, add: 6, ..OperatorCounts::NONE }.and(OperatorCounts::NORMALIZE);
    /// Longest dependent chain of a position: a product and three sums.
    pub const POSITION_CHAIN: OperatorCounts = OperatorCounts { multiply: 1, add: 3, ..OperatorCounts::NONE };
    /// Longest dependent chain of a direction: a product and two sums, then squared length, root, reciprocal, product.
    pub const DIRECTION_CHAIN: OperatorCounts =
        OperatorCounts { multiply: 1 + 2, add: 2 + 2, divide: 1, square_root: 1, ..OperatorCounts::NONE };

    /// Creates the matrices of an object with this world matrix under this view projection, both row-major.
    pub fn new(view_projection: &[f64; 16], world: &[f64; 16]) -> Self {
        let clip = matrix(view_projection) * matrix(world);
        let direction = DMat3::from_mat4(matrix(world));
        let mirrored = direction.determinant() < 0.0;
        Self { clip: clip.as_mat4(), direction: direction.as_mat3(), normal: normal_matrix(&direction), mirrored }
    }

    /// Returns vertex `index` of the mesh. Returns `None` if it does not exist.
    pub fn vertex(&self, mesh: &Mesh, index: u32) -> Option<ClipCorner> {
        let i = index as usize;
        let position = Vec3::from(*mesh.positions.get(i)?);
        let unset = Vertex::default();
        let normal = self.normal * Vec3::from(mesh.normals.get(i).copied().unwrap_or(unset.normal));
        let [x, y, z, w] = mesh.tangents.get(i).copied().unwrap_or(unset.tangent);
        let tangent = (self.direction * Vec3::new(x, y, z)).normalize_or_zero();
        // The handedness is the file's in world space too, although cross(N, T) of a mirrored frame points away from the
        // surface's v. glTF's reference viewer and the Mesa tool do the same, and models are designed for that look.
        let vertex = Vertex {
            normal: normal.normalize_or(Vec3::Z).to_array(),
            tangent: tangent.extend(w).to_array(),
            uv: mesh.uv.get(i).copied().unwrap_or(unset.uv),
            uv_normal: mesh.uv_normal.get(i).copied().unwrap_or(unset.uv_normal),
            color: mesh.colors.get(i).copied().unwrap_or(unset.color),
            ..unset
        };
        Some(ClipCorner { clip: self.clip * position.extend(1.0), vertex })
    }
}

/// Returns the inverse transpose up to a positive factor, by cofactors, so that it exists for flattened objects too. It is scaled
/// to one, so that no size of object leaves the range of single precision.
fn normal_matrix(direction: &DMat3) -> Mat3 {
    let [x, y, z] = [direction.x_axis, direction.y_axis, direction.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let largest = cofactors.to_cols_array().iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let sign = if direction.determinant() < 0.0 { -1.0 } else { 1.0 };
    if largest > 0.0 { (cofactors * (sign / largest)).as_mat3() } else { Mat3::IDENTITY }
}

/// Returns the centre of the axis-aligned box of the object's vertices in world space, or the object's origin if it has no
/// vertices.
pub fn centre(object: &Object) -> [f32; 3] {
    let world = matrix(&object.world);
    let mut points = object.mesh.positions.iter().map(|p| world.transform_point3(Vec3::from(*p).as_dvec3()));
    let first = points.next().unwrap_or_else(|| world.transform_point3(DVec3::ZERO));
    let (low, high) = points.fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
    (0.5 * (low + high)).as_vec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::sync::Arc;

    const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

    fn world(linear: [f64; 9]) -> [f64; 16] {
        let [a, b, c, d, e, f, g, h, i] = linear;
        [a, b, c, 5.0, d, e, f, -7.0, g, h, i, 9.0, 0.0, 0.0, 0.0, 1.0]
    }

    fn mesh(normal: Vec3, tangent: Vec3, w: f32) -> Mesh {
        let tangents = vec![tangent.extend(w).to_array()];
        Mesh { positions: vec![[1.0, 2.0, 3.0]], normals: vec![normal.to_array()], tangents, ..Mesh::default() }
    }

    #[test]
    fn matrices_are_row_major() {
        let t = ObjectTransform::new(&IDENTITY, &world([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]));
        let corner = t.vertex(&mesh(Vec3::Z, Vec3::X, 1.0), 0).expect("vertex 0");
        assert_eq!(corner.clip.to_array(), [6.0, -5.0, 12.0, 1.0]);
        assert!(t.vertex(&mesh(Vec3::Z, Vec3::X, 1.0), 1).is_none());
    }

    #[test]
    fn centre_is_that_of_world_space_box() {
        let mesh = Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], ..Mesh::default() };
        let linear = [1.0, 1.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let object = |mesh| Object {
            id: 0,
            name: String::new(),
            mesh: Arc::new(mesh),
            world: world(linear),
            material: Arc::default(),
            entries: None,
            bias: None,
            bump: None,
            shading: Default::default(),
        };
        assert_eq!(centre(&object(mesh)), [5.5, -7.0, 9.0]);
        assert_eq!(centre(&object(Mesh::default())), [5.0, -7.0, 9.0]);
    }

    fn unit_vector() -> impl Strategy<Value = Vec3> {
        [-1f32..1.0, -1f32..1.0, -1f32..1.0]
            .prop_map(Vec3::from)
            .prop_filter("long enough", |v| v.length() > 0.1)
            .prop_map(Vec3::normalize)
    }

    proptest! {
        #[test]
        fn normals_stay_outward_and_bitangent_follows_surface(
            m in prop::array::uniform9(-2f64..2.0), n in unit_vector(), t in unit_vector(), left in any::<bool>(),
        ) {
            let linear = DMat3::from_cols_array(&m).transpose();
            prop_assume!(linear.determinant().abs() > 0.2);
            let t = (t - n * n.dot(t)).normalize_or(n.any_orthonormal_vector());
            let w = if left { -1.0 } else { 1.0 };
            let bitangent = n.cross(t) * w;
            let corner = ObjectTransform::new(&IDENTITY, &world(m)).vertex(&mesh(n, t, w), 0).expect("vertex 0");
            let (normal, tangent) = (Vec3::from(corner.vertex.normal), Vec4::from(corner.vertex.tangent));
            let to_world = |v: Vec3| (linear * v.as_dvec3()).as_vec3();
            prop_assert!((normal.length() - 1.0).abs() < 1e-5 && (tangent.truncate().length() - 1.0).abs() < 1e-5);
            prop_assert!(normal.dot(to_world(t)).abs() < 1e-4 && normal.dot(to_world(bitangent)).abs() < 1e-4);
            prop_assert!(normal.dot(to_world(n)) > 0.0, "outward");
            prop_assert_eq!(tangent.w, w);
            let follows = (normal.cross(tangent.truncate()) * tangent.w).dot(to_world(bitangent)) > 0.0;
            prop_assert_eq!(follows, linear.determinant() > 0.0, "a mirrored frame keeps the file's handedness");
        }

        #[test]
        fn object_size_does_not_change_normals(scale in prop_oneof![Just(1e-20f64), Just(1e-3), Just(1e12)], n in unit_vector()) {
            let at = |s: f64| {
                let t = ObjectTransform::new(&IDENTITY, &world([s, 0.0, 0.0, 0.0, 2.0 * s, 0.0, 0.0, 0.0, s]));
                Vec3::from(t.vertex(&mesh(n, Vec3::X, 1.0), 0).expect("vertex 0").vertex.normal)
            };
            prop_assert!(at(scale).distance(at(1.0)) < 1e-5);
        }
    }
}
