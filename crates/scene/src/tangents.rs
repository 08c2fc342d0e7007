//! Tangents for meshes that have none: MikkTSpace, in glTF's sense of handedness.
//!
//! glTF's v runs down the image while the y axis of its normal maps points up it, so bitangent = w * cross(N, T) points
//! to *decreasing* v. MikkTSpace's bitangent points to increasing v; it is therefore given -v. (Flipping the sign of its
//! result instead would be the same, except where a face has no area in the texture.)

use basrelief_signals::Mesh;
use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// Maximum memory of [`generate`] \[bytes per corner\]: lists of corners, faces and groups, tables of vertices to be split, and
/// the mesh with a vertex per corner. Measured: 167 if all corners share a vertex, 250 if each has its own.
pub(crate) const BYTES_PER_CORNER: u64 = 320;

/// Gives the mesh tangents from its positions, normals and normal-map coordinates. Vertices whose faces disagree, as
/// along a mirrored seam, are split: the mesh may end with more of them.
pub(crate) fn generate(mesh: &mut Mesh) {
    let mut corners = MeshCorners { mesh, tangents: vec![None; mesh.indices.len()] };
    // The error type has no values; a mesh that gives no tangents falls back below.
    let _ = generate_tangents(&mut corners);
    let tangents = corners.tangents;
    split(mesh, &tangents);
}

/// Some unit tangent perpendicular to the normal, right-handed: for corners that MikkTSpace cannot serve.
fn any_tangent(normal: [f32; 3]) -> [f32; 4] {
    let n = DVec3::from_array(normal.map(f64::from));
    let axis = if n.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let t = (axis - n * n.dot(axis)).normalize_or(DVec3::X).as_vec3();
    [t.x, t.y, t.z, 1.0]
}

/// Makes a tangent unit; replaces one that has no direction.
pub(crate) fn repair(tangent: [f32; 4], normal: [f32; 3]) -> [f32; 4] {
    let t = DVec3::from_array([tangent[0], tangent[1], tangent[2]].map(f64::from)).normalize_or_zero().as_vec3();
    if t == Vec3::ZERO {
        return any_tangent(normal);
    }
    [t.x, t.y, t.z, if tangent[3] < 0.0 { -1.0 } else { 1.0 }]
}

/// A mesh as MikkTSpace reads it, and one tangent per corner.
struct MeshCorners<'a> {
    mesh: &'a Mesh,
    tangents: Vec<Option<[f32; 4]>>,
}

impl MeshCorners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices.get(3 * face + corner).map_or(0, |i| *i as usize)
    }
}

impl Geometry<LibmFloats> for MeshCorners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions.get(self.vertex(face, corner)).copied().unwrap_or_default()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals.get(self.vertex(face, corner)).copied().unwrap_or_default()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let [u, v] = self.mesh.uv_normal.get(self.vertex(face, corner)).copied().unwrap_or_default();
        [u, -v]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(slot) = self.tangents.get_mut(3 * face + corner) {
            *slot = space.map(|s| s.tangent_encoded());
        }
    }
}

/// The two functions that differ between platforms, from `libm`.
enum LibmFloats {}

impl Ops for LibmFloats {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

/// Writes the corners' tangents to the vertices; a vertex with several is copied.
fn split(mesh: &mut Mesh, tangents: &[Option<[f32; 4]>]) {
    let vertices = mesh.positions.len();
    let mut copies: BTreeMap<(u32, [u32; 4]), u32> = BTreeMap::new();
    let mut used = vec![false; vertices];
    mesh.tangents = vec![[1.0, 0.0, 0.0, 1.0]; vertices];
    let mut indices = std::mem::take(&mut mesh.indices);
    for (index, tangent) in indices.iter_mut().zip(tangents) {
        let vertex = *index as usize;
        let Some(normal) = mesh.normals.get(vertex).copied() else { continue };
        let tangent = repair(tangent.unwrap_or_default(), normal);
        let key = (*index, tangent.map(f32::to_bits));
        if let Some(copy) = copies.get(&key) {
            *index = *copy;
        } else {
            if used[vertex] {
                *index = duplicate(mesh, vertex);
            }
            used[vertex] = true;
            copies.insert(key, *index);
            mesh.tangents[*index as usize] = tangent;
        }
    }
    mesh.indices = indices;
}

/// Copies a vertex to the end of the mesh; its new number.
fn duplicate(mesh: &mut Mesh, vertex: usize) -> u32 {
    fn push_copy<T: Copy>(list: &mut Vec<T>, i: usize) {
        if let Some(value) = list.get(i).copied() {
            list.push(value);
        }
    }
    let new = mesh.positions.len() as u32;
    push_copy(&mut mesh.positions, vertex);
    push_copy(&mut mesh.normals, vertex);
    push_copy(&mut mesh.tangents, vertex);
    push_copy(&mut mesh.uv, vertex);
    push_copy(&mut mesh.uv_normal, vertex);
    push_copy(&mut mesh.colors, vertex);
    new
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn quad(uv_normal: [[f32; 2]; 4]) -> Mesh {
        Mesh {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
            normals: vec![[0., 0., 1.]; 4],
            uv_normal: uv_normal.to_vec(),
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Mesh::default()
        }
    }

    /// An upright picture on a wall: u to the right, v down. T points right, w is +1 and cross(N, T) points up.
    #[test]
    fn upright_picture_has_w_plus_one() {
        let mut mesh = quad([[0., 1.], [1., 1.], [1., 0.], [0., 0.]]);
        generate(&mut mesh);
        assert_eq!(mesh.tangents, [[1., 0., 0., 1.]; 4]);
        let mut mirrored = quad([[1., 1.], [0., 1.], [0., 0.], [1., 0.]]);
        generate(&mut mirrored);
        assert_eq!(mirrored.tangents, [[-1., 0., 0., -1.]; 4]);
    }

    #[test]
    fn mirrored_seam_splits_its_vertices() {
        let mut mesh = quad([[0., 1.], [1., 1.], [1., 0.], [0., 0.]]);
        // The second triangle's u runs the other way.
        mesh.uv_normal[3] = [2., 0.];
        let before = mesh.positions.len();
        generate(&mut mesh);
        assert!(mesh.positions.len() > before);
        assert_eq!(mesh.tangents.len(), mesh.positions.len());
        assert_eq!(mesh.uv_normal.len(), mesh.positions.len());
        let w = |t: usize| [0, 1, 2].map(|c| mesh.tangents[mesh.indices[3 * t + c] as usize][3]);
        assert_ne!(w(0), w(1));
    }

    proptest! {
        #[test]
        fn any_finite_mesh_gets_unit_tangents(
            positions in proptest::collection::vec(prop::array::uniform3(-1e30f32..1e30), 8),
            uv in proptest::collection::vec(prop::array::uniform2(-1e3f32..1e3), 8),
            indices in proptest::collection::vec(0u32..8, 3..30),
        ) {
            let mut indices = indices;
            indices.truncate(indices.len() / 3 * 3);
            let normals = crate::normals::smooth(&positions, &indices);
            let mut mesh = Mesh { positions, normals, uv_normal: uv, indices, ..Mesh::default() };
            generate(&mut mesh);
            prop_assert_eq!(mesh.tangents.len(), mesh.positions.len());
            for t in &mesh.tangents {
                let length = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt();
                prop_assert!((length - 1.0).abs() < 1e-5 && t[3].abs() == 1.0, "{:?}", t);
            }
        }
    }
}
