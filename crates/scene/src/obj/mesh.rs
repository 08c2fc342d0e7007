//! Meshes of groups.

use super::material::PlacedMaterial;
use super::parse::{CornerIndices, NONE, ObjFace, ObjFile, ObjGroup};
use super::polygon::{self, MOST_CONCAVE_CORNERS, triangulate};
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::outside::{ImportContext, over_budget};
use crate::{normals, tangents};
use basrelief_input::{MemoryReservation, OverBudget};
use basrelief_signals::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// Memory of a corner while a mesh is made: its index, in a list that grows by doubling \[bytes\].
pub(super) const CORNER: u64 = 8;
/// Memory of a vertex: its places in lists that grow by doubling, and in a table \[bytes\].
const VERTEX: u64 = 200;
/// Vertices that are counted at a time.
const VERTICES: u32 = 256;
/// Memory of a vertex that has a smooth normal: its number in a table, and three lists \[bytes\].
const SMOOTHED: u64 = 128;
/// Reason for taking memory.
pub(super) const TRIANGLES: &str = "vertices and triangles";

/// Positions are stored from an offset if the model's distance from the origin is this many times its size.
///
/// Single precision has 24 bits. At 16 times the size 20 of them are left for the shape.
const FAR: f64 = 16.0;

/// Positions of a file in single precision, from an offset.
pub(super) struct OffsetPositions {
    pub offset: DVec3,
    pub local: Vec<[f32; 3]>,
}

impl OffsetPositions {
    /// Subtracts an offset on each axis on which the model is far from the origin, in double precision.
    pub fn new(obj: &ObjFile) -> Self {
        let points = || obj.positions.iter().copied().map(DVec3::from_array);
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
        let far = FAR * (high - low).max_element();
        let offset = [0, 1, 2].map(|i| if low[i].abs() > far && low[i].is_finite() { low[i].round() } else { 0.0 });
        let offset = DVec3::from_array(offset);
        Self { offset, local: points().map(|point| (point - offset).as_vec3().to_array()).collect() }
    }

    /// Places of a polygon's corners, from the offset.
    fn polygon(&self, obj: &ObjFile, corners: &[CornerIndices], points: &mut Vec<DVec3>) {
        let place = |corner: &CornerIndices| obj.positions.get(corner[0] as usize).map_or(DVec3::ZERO, |p| DVec3::from_array(*p));
        points.clear();
        points.extend(corners.iter().map(|corner| place(corner) - self.offset));
    }
}

/// Calls `each` with each face, the places of its corners, and its triangles.
fn for_each_face(
    obj: &ObjFile,
    positions: &OffsetPositions,
    group: &ObjGroup,
    mut each: impl FnMut(ObjFace, &[CornerIndices], &[DVec3], &[[u32; 3]]) -> Result<(), OverBudget>,
) -> Result<(), SceneError> {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (face, corners) in group.faces() {
        positions.polygon(obj, corners, &mut points);
        if corners.len() > MOST_CONCAVE_CORNERS && !polygon::is_convex(&points) {
            return Err(SceneError::at("", format!("a concave face has {} vertices", corners.len()))
                .expected(format!("at most {MOST_CONCAVE_CORNERS}"))
                .cure("cut it into triangles in the program that it comes from"));
        }
        triangulate(&points, &mut triangles);
        each(face, corners, &points, &triangles).map_err(|error| over_budget("", &error))?;
    }
    Ok(())
}

/// Normals of positions in smoothing groups, over the whole file.
#[derive(Default)]
pub(super) struct SmoothNormals {
    /// Number of a normal by position and smoothing group.
    numbers: BTreeMap<(u32, u32), u32>,
    normals: Vec<[f32; 3]>,
}

impl SmoothNormals {
    /// Computes normals from the faces around each position, unless every corner has a normal in the file.
    pub fn new(
        obj: &ObjFile,
        positions: &OffsetPositions,
        outside: &ImportContext<'_>,
        warnings: &mut ImportWarnings,
    ) -> Result<(Self, MemoryReservation), SceneError> {
        let faces = || obj.groups.iter().flat_map(ObjGroup::faces);
        let mut held = outside.nothing();
        if !faces().any(|(face, corners)| face.smoothing > 0 && corners.iter().any(|corner| corner[2] == NONE)) {
            return Ok((Self::default(), held));
        }
        let (mut numbers, mut places, mut indices) = (BTreeMap::new(), Vec::new(), Vec::new());
        for group in &obj.groups {
            for_each_face(obj, positions, group, |face, corners, _, triangles| {
                if face.smoothing == 0 {
                    return Ok(());
                }
                held.try_grow(3 * CORNER * triangles.len() as u64, "normals of vertices")?;
                for corner in triangles.iter().flatten().filter_map(|i| corners.get(*i as usize)) {
                    let next = places.len() as u32;
                    let number = *numbers.entry((corner[0], face.smoothing)).or_insert(next);
                    if number == next {
                        held.try_grow(SMOOTHED, "normals of vertices")?;
                        places.push(positions.local.get(corner[0] as usize).copied().unwrap_or_default());
                    }
                    indices.push(number);
                }
                Ok(())
            })?;
        }
        let normals = normals::smooth(&places, &indices);
        if obj.smoothing_is_assumed && has_sharp_edge(&places, &indices, &normals) {
            warnings.add("the file has neither smoothing groups (`s`) nor normals at some sharp edges: drawn smooth");
        }
        Ok((Self { numbers, normals }, held))
    }

    fn get(&self, position: u32, smoothing: u32) -> Option<[f32; 3]> {
        self.normals.get(*self.numbers.get(&(position, smoothing))? as usize).copied()
    }
}

/// True if a face leans away from one of its vertex normals by more than half a right angle, as all faces of a cube do.
fn has_sharp_edge(places: &[[f32; 3]], indices: &[u32], normals: &[[f32; 3]]) -> bool {
    let dot = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
    indices.as_chunks::<3>().0.iter().zip(normals::flat(places, indices)).any(|(corners, face)| {
        corners.iter().filter_map(|i| normals.get(*i as usize)).any(|normal| dot(normal, &face) < std::f32::consts::FRAC_1_SQRT_2)
    })
}

/// The parts of a file that meshes of groups are made from.
pub(super) struct MeshParts<'a> {
    pub obj: &'a ObjFile,
    pub positions: &'a OffsetPositions,
    pub smooth: &'a SmoothNormals,
}

impl MeshParts<'_> {
    /// The mesh of a group: one vertex for each different corner.
    pub fn mesh(
        &self,
        group: &ObjGroup,
        surface: &PlacedMaterial,
        held: &mut MemoryReservation,
        warnings: &mut ImportWarnings,
    ) -> Result<Mesh, SceneError> {
        let mut builder =
            MeshBuilder { shape: self, surface, mesh: Mesh::default(), vertices: BTreeMap::new(), without_uv: false };
        let mut faces = 0;
        for_each_face(self.obj, self.positions, group, |face, corners, points, triangles| {
            faces += 1;
            // A flat face shares no vertex with another.
            let (sharing, flat) = match face.smoothing {
                0 => (faces, Some(normals::unit(polygon::area_vector(points), DVec3::Z))),
                group => (group, None),
            };
            let corners = triangles.iter().flatten().filter_map(|i| corners.get(*i as usize));
            corners.copied().try_for_each(|corner| builder.push(corner, sharing, flat, held))
        })?;
        if builder.without_uv {
            warnings.add(format!("`{}` has faces without texture coordinates: all (0, 0)", group.name()));
        }
        let mut mesh = builder.mesh;
        if surface.material.normal_map.is_some() {
            tangents::generate(&mut mesh);
        }
        Ok(mesh)
    }
}

/// Collects the vertices of a mesh.
struct MeshBuilder<'a> {
    shape: &'a MeshParts<'a>,
    surface: &'a PlacedMaterial,
    mesh: Mesh,
    /// Numbers of vertices by corner and, for corners without a normal, by smoothing group or flat face.
    vertices: BTreeMap<(CornerIndices, u32), u32>,
    /// A corner of a textured group has no texture coordinates.
    without_uv: bool,
}

impl MeshBuilder<'_> {
    fn push(
        &mut self,
        corner: CornerIndices,
        sharing: u32,
        flat: Option<[f32; 3]>,
        held: &mut MemoryReservation,
    ) -> Result<(), OverBudget> {
        let MeshParts { obj, positions, smooth } = self.shape;
        let [position, uv, normal] = corner.map(|i| i as usize);
        let own = obj.normals.get(normal).and_then(|n| DVec3::from_array(n.map(f64::from)).try_normalize());
        let key = (corner, if own.is_some() { 0 } else { sharing });
        let next = self.mesh.positions.len() as u32;
        let vertex = *self.vertices.entry(key).or_insert(next);
        self.mesh.indices.push(vertex);
        if vertex < next {
            return Ok(());
        }
        if next.is_multiple_of(VERTICES) {
            held.try_grow(VERTEX * u64::from(VERTICES), TRIANGLES)?;
        }
        self.mesh.positions.push(positions.local.get(position).copied().unwrap_or_default());
        let computed = || flat.or_else(|| smooth.get(corner[0], sharing)).unwrap_or([0.0, 0.0, 1.0]);
        self.mesh.normals.push(own.map_or_else(computed, |n| n.as_vec3().to_array()));
        if !obj.colors.is_empty() && !self.surface.emits {
            self.mesh.colors.push(obj.colors.get(position).copied().unwrap_or([1.0; 4]));
        }
        let material = &self.surface.material;
        for (texture, map, list) in [
            (&material.color_texture, &self.surface.color, &mut self.mesh.uv),
            (&material.normal_map, &self.surface.relief, &mut self.mesh.uv_normal),
        ] {
            if let (Some(_), Some(map)) = (texture, map) {
                self.without_uv |= uv == NONE as usize;
                list.push(obj.uv.get(uv).map_or([0.0; 2], |uv| map.at(*uv)));
            }
        }
        Ok(())
    }
}
