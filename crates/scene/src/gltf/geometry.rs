//! Primitives to meshes.

use super::accessor::AccessorReader;
use super::json::{GltfInteger, GltfPrimitive, TextureTransform};
use super::semantic::AttributeSemantic;
use super::vertex_matrices::VertexMatrices;
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::normals;
use crate::tangents;
use basrelief_signals::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// Texture coordinates that a material requests.
#[derive(Clone, Default)]
pub(crate) struct UvRequest {
    /// Which TEXCOORD set.
    pub set: u64,
    /// `KHR_texture_transform`, to be baked in.
    pub transform: Option<TextureTransform>,
}

/// Attributes that a material requests from its primitives.
#[derive(Clone, Default)]
pub(crate) struct RequestedAttributes {
    /// Coordinates of the colour texture; `None` without one.
    pub color: Option<UvRequest>,
    /// Coordinates of the normal map; `None` without one.
    pub normal_map: Option<UvRequest>,
    /// The material only emits. Vertex colours multiply its base colour, which is black, so they have no effect.
    pub without_colors: bool,
}

/// Reads primitives of one document.
pub(crate) struct PrimitiveReader<'a> {
    pub accessors: &'a AccessorReader<'a>,
    /// `KHR_mesh_quantization` is declared.
    pub quantized: bool,
    /// Largest vertex number of each accessor of indices that gives no triangle in a mode. Many primitives can share it.
    without_triangle: BTreeMap<(GltfInteger, u64), u32>,
}

/// The triangles of a primitive.
pub(super) struct PrimitiveCorners {
    /// Vertex numbers.
    pub indices: Vec<u32>,
    /// Number of vertices.
    pub vertices: u64,
}

/// A primitive with everything that its mesh depends on.
#[derive(Clone, Copy)]
pub(crate) struct MeshSource<'a> {
    pub primitive: &'a GltfPrimitive,
    pub needs: &'a RequestedAttributes,
    /// Weights of its morph targets.
    pub weights: &'a [f64],
    pub skin: Option<&'a VertexMatrices>,
    /// JSON pointer.
    pub place: &'a str,
}

impl<'a> PrimitiveReader<'a> {
    pub(super) fn new(accessors: &'a AccessorReader<'a>, quantized: bool) -> Self {
        Self { accessors, quantized, without_triangle: BTreeMap::new() }
    }

    /// Returns the vertex numbers of the triangles of a primitive, and its number of vertices; `None` if it has no triangles.
    pub(super) fn corners(
        &mut self,
        primitive: &GltfPrimitive,
        place: &str,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<PrimitiveCorners>, SceneError> {
        let mode = primitive.mode.map_or(TRIANGLES, |m| m.0);
        if mode < TRIANGLES {
            warnings.add(format!("{place} draws points or lines: skipped"));
            return Ok(None);
        }
        let Some(positions) = primitive.attributes.get("POSITION") else {
            warnings.add(format!("{place} has no POSITION: skipped"));
            return Ok(None);
        };
        let (_, vertices) = self.accessors.describe(*positions, place)?;
        let flat = primitive.indices.map(|index| (index, mode));
        let is_known = flat.and_then(|key| self.without_triangle.get(&key)).is_some_and(|largest| u64::from(*largest) < vertices);
        let (indices, largest) =
            if is_known { Default::default() } else { self.triangles(primitive, mode, vertices, place, warnings)? };
        if indices.is_empty() {
            warnings.add(format!("{place} has no triangle: skipped"));
            if let Some(key) = flat.filter(|_| !is_known) {
                self.without_triangle.insert(key, largest);
            }
            return Ok(None);
        }
        Ok(Some(PrimitiveCorners { indices, vertices }))
    }

    /// Returns the mesh of a primitive with these triangles.
    pub(super) fn mesh(
        &self,
        source: &MeshSource<'_>,
        corners: PrimitiveCorners,
        warnings: &mut ImportWarnings,
    ) -> Result<Mesh, SceneError> {
        let positions = self.attribute::<3>(source, "POSITION", None, AttributeSemantic::Position, warnings)?.unwrap_or_default();
        let mut mesh = Mesh { positions, indices: corners.indices, ..Mesh::default() };
        self.fill(&mut mesh, source, warnings)?;
        Ok(mesh)
    }

    /// Everything beside positions and indices.
    fn fill(&self, mesh: &mut Mesh, source: &MeshSource<'_>, warnings: &mut ImportWarnings) -> Result<(), SceneError> {
        let MeshSource { needs, place, .. } = *source;
        let count = Some(mesh.positions.len() as u64);
        mesh.uv = self.uv(source, needs.color.as_ref(), mesh.positions.len(), warnings)?;
        mesh.uv_normal = self.uv(source, needs.normal_map.as_ref(), mesh.positions.len(), warnings)?;
        if !needs.without_colors {
            mesh.colors = self.attribute(source, "COLOR_0", count, AttributeSemantic::Color, warnings)?.unwrap_or_default();
        }
        for color in &mut mesh.colors {
            *color = color.map(|c| c.clamp(0.0, 1.0));
        }
        let mut normals = self.attribute::<3>(source, "NORMAL", count, AttributeSemantic::Direction, warnings)?;
        let mut tangents = self.attribute::<4>(source, "TANGENT", count, AttributeSemantic::Direction, warnings)?;
        if let Some(skin) = source.skin {
            skin.pose(mesh, normals.as_mut(), tangents.as_mut(), place)?;
        }
        let has_normals = normals.is_some();
        match normals {
            Some(normals) => {
                self.accessors.charge(SMOOTHING * normals.len() as u64, place)?;
                mesh.normals = unit_normals(normals, mesh, place, warnings);
            }
            None => {
                self.accessors.charge(FLATTENING * mesh.indices.len() as u64, place)?;
                flatten(mesh);
            }
        }
        if needs.normal_map.is_none() {
            return Ok(());
        }
        match tangents.filter(|_| has_normals) {
            Some(given) => {
                self.accessors.charge(size_of::<[f32; 4]>() as u64 * given.len() as u64, place)?;
                mesh.tangents = given.iter().zip(&mesh.normals).map(|(t, n)| tangents::repair(*t, *n)).collect();
            }
            None => {
                self.accessors.charge(tangents::BYTES_PER_CORNER * mesh.indices.len() as u64, place)?;
                tangents::generate(mesh);
            }
        }
        Ok(())
    }

    fn uv(
        &self,
        source: &MeshSource<'_>,
        request: Option<&UvRequest>,
        count: usize,
        warnings: &mut ImportWarnings,
    ) -> Result<Vec<[f32; 2]>, SceneError> {
        let place = source.place;
        let Some(request) = request else { return Ok(Vec::new()) };
        let name = format!("TEXCOORD_{}", request.set);
        let uv = self.attribute::<2>(source, &name, Some(count as u64), AttributeSemantic::TexCoord, warnings)?;
        if uv.is_none() {
            self.accessors.charge(size_of::<[f32; 2]>() as u64 * count as u64, place)?;
        }
        let mut uv = uv.unwrap_or_else(|| {
            warnings.add(format!("{place} has no {name}, which its material asks for: all (0, 0)"));
            vec![[0.0; 2]; count]
        });
        if let Some(transform) = &request.transform {
            bake(transform, &mut uv);
            if uv.iter().flatten().any(|c| !c.is_finite()) {
                return Err(SceneError::at(place, "its KHR_texture_transform makes texture coordinates infinite")
                    .expected("a transform of ordinary size"));
            }
        }
        Ok(uv)
    }

    /// An attribute with one element per vertex.
    fn attribute<const N: usize>(
        &self,
        source: &MeshSource<'_>,
        name: &str,
        count: Option<u64>,
        semantic: AttributeSemantic,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<Vec<[f32; N]>>, SceneError> {
        let place = format!("{}/attributes/{name}", source.place);
        let base = self.elements(&source.primitive.attributes, name, count, semantic, &place, warnings)?;
        let Some(mut base) = base else { return Ok(None) };
        self.morph(&mut base, source, name, semantic, warnings)?;
        Ok(Some(base))
    }

    /// Adds the morph targets of an attribute, each times its weight.
    fn morph<const N: usize>(
        &self,
        base: &mut [[f32; N]],
        source: &MeshSource<'_>,
        name: &str,
        semantic: AttributeSemantic,
        warnings: &mut ImportWarnings,
    ) -> Result<(), SceneError> {
        let MeshSource { primitive, weights, place, .. } = *source;
        if weights.len() != primitive.targets.len() && !weights.is_empty() {
            warnings.add(format!("{place}: {} weights for {} morph targets", weights.len(), primitive.targets.len()));
        }
        for (i, (target, weight)) in primitive.targets.iter().zip(weights).enumerate().filter(|(_, (_, weight))| **weight != 0.0)
        {
            let place = format!("{place}/targets/{i}/{name}");
            let add = |value: &mut f32, delta: f32| *value = (f64::from(*value) + weight * f64::from(delta)) as f32;
            // The handedness of a tangent, its fourth component, has no delta.
            if semantic == AttributeSemantic::Direction && N == 4 {
                let deltas =
                    self.elements::<3>(target, name, Some(base.len() as u64), semantic, &place, warnings)?.unwrap_or_default();
                base.iter_mut().zip(deltas).for_each(|(base, delta)| base.iter_mut().zip(delta).for_each(|(b, d)| add(b, d)));
            } else {
                let deltas =
                    self.elements::<N>(target, name, Some(base.len() as u64), semantic, &place, warnings)?.unwrap_or_default();
                // The alpha that a colour of three components gets is no delta.
                base.iter_mut()
                    .zip(deltas)
                    .for_each(|(base, delta)| base.iter_mut().zip(delta).take(3).for_each(|(b, d)| add(b, d)));
            }
            if base.iter().flatten().any(|value| !value.is_finite()) {
                return Err(SceneError::at(place, "its weight makes vertices infinite").expected("weights of ordinary size"));
            }
        }
        Ok(())
    }

    /// The elements of the accessor that attributes name.
    pub(super) fn elements<const N: usize>(
        &self,
        attributes: &BTreeMap<String, GltfInteger>,
        name: &str,
        count: Option<u64>,
        semantic: AttributeSemantic,
        place: &str,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<Vec<[f32; N]>>, SceneError> {
        let Some(index) = attributes.get(name) else { return Ok(None) };
        let (format, elements) = self.accessors.describe(*index, place)?;
        let width_fits = format.is_vector(N) || (matches!(semantic, AttributeSemantic::Color) && format.is_vector(3));
        if !width_fits || !semantic.allows(format, self.quantized) {
            return Err(SceneError::at(place, format!("accessor {} is {}", index.0, format.name()))
                .expected(format!("VEC{N} of {}", semantic.expected()))
                .cure("export the model again"));
        }
        if let Some(count) = count.filter(|c| *c != elements) {
            return Err(SceneError::at(place, format!("accessor {} has {elements} elements", index.0))
                .expected(format!("{count}, as many as POSITION")));
        }
        if self.accessors.stride(*index).is_none() && !format.element_bytes().is_multiple_of(4) {
            let bytes = format.element_bytes();
            warnings.add(format!("{place}: vertices of accessor {} lie {bytes} bytes apart, expected a multiple of 4", index.0));
        }
        self.accessors.floats(*index, place, warnings).map(Some)
    }

    /// Vertex numbers of all triangles, without those that use a vertex twice, and the largest vertex number.
    fn triangles(
        &self,
        primitive: &GltfPrimitive,
        mode: u64,
        vertices: u64,
        place: &str,
        warnings: &mut ImportWarnings,
    ) -> Result<(Vec<u32>, u32), SceneError> {
        let order = match primitive.indices {
            Some(index) => self.indices(index, vertices, &format!("{place}/indices"), warnings)?,
            None => {
                self.accessors.charge((size_of::<u32>() as u64).saturating_mul(vertices), place)?;
                (0..vertices as u32).collect()
            }
        };
        if mode == TRIANGLES && order.len() % 3 != 0 {
            warnings.add(format!("{place}: {} vertices are no whole number of triangles: the rest is left out", order.len()));
        }
        // Up to three for each in a strip, in a list that grows by doubling.
        self.accessors.charge(6 * size_of::<u32>() as u64 * order.len() as u64, place)?;
        Ok((triangulate(&order, mode), order.iter().copied().max().unwrap_or_default()))
    }

    fn indices(
        &self,
        index: GltfInteger,
        vertices: u64,
        place: &str,
        warnings: &mut ImportWarnings,
    ) -> Result<Vec<u32>, SceneError> {
        let order = self.accessors.indices(index, place, warnings)?;
        match order.iter().enumerate().find(|(_, i)| u64::from(**i) >= vertices) {
            Some((k, i)) => Err(SceneError::at(place, format!("index {k} of accessor {} is {i}", index.0))
                .expected(format!("indices below {vertices}, the number of vertices"))
                .cure("export the model again")),
            None => Ok(order),
        }
    }
}

/// Memory for making normals unit \[bytes per vertex\]: sums of face normals, and two lists.
const SMOOTHING: u64 = 48;
/// Memory for a vertex per corner \[bytes per corner\]: all lists but tangents, and face normals.
const FLATTENING: u64 = 80;

const TRIANGLES: u64 = 4;
const TRIANGLE_STRIP: u64 = 5;

/// Separate triangles out of a list, strip or fan (glTF 2.0, section 3.7.2.1: each keeps the winding of the first).
fn triangulate(order: &[u32], mode: u64) -> Vec<u32> {
    let triangles: Box<dyn Iterator<Item = [u32; 3]>> = match mode {
        TRIANGLES => Box::new(order.as_chunks::<3>().0.iter().copied()),
        TRIANGLE_STRIP => Box::new(order.windows(3).enumerate().filter_map(|(i, w)| {
            let [a, b, c] = *w.first_chunk()?;
            Some(if i % 2 == 0 { [a, b, c] } else { [a, c, b] })
        })),
        _ => {
            let hub = order.first().copied().unwrap_or_default();
            let rim = order.get(1..).unwrap_or_default();
            Box::new(rim.windows(2).filter_map(move |w| w.first_chunk().map(|[a, b]| [*a, *b, hub])))
        }
    };
    triangles.filter(|[a, b, c]| a != b && b != c && c != a).flatten().collect()
}

/// Makes normals unit. Normals of length 0 are computed from the faces around them.
fn unit_normals(given: Vec<[f32; 3]>, mesh: &Mesh, place: &str, warnings: &mut ImportWarnings) -> Vec<[f32; 3]> {
    let vector = |n: &[f32; 3]| DVec3::from_array(n.map(f64::from));
    if given.iter().all(|n| vector(n).try_normalize().is_some()) {
        return given.iter().map(|n| normals::unit(vector(n), DVec3::Z)).collect();
    }
    warnings.add(format!("{place} has normals of length 0: computed from the faces around them"));
    let computed = normals::smooth(&mesh.positions, &mesh.indices);
    given.iter().zip(computed).map(|(n, c)| normals::unit(vector(n), DVec3::from_array(c.map(f64::from)))).collect()
}

/// Gives each triangle its own vertices and flat normals, as glTF asks for meshes without normals.
fn flatten(mesh: &mut Mesh) {
    fn pick<T: Copy>(list: &[T], indices: &[u32]) -> Vec<T> {
        if list.is_empty() { Vec::new() } else { indices.iter().filter_map(|i| list.get(*i as usize).copied()).collect() }
    }
    let faces = normals::flat(&mesh.positions, &mesh.indices);
    mesh.normals = faces.into_iter().flat_map(|n| [n; 3]).collect();
    mesh.positions = pick(&mesh.positions, &mesh.indices);
    mesh.uv = pick(&mesh.uv, &mesh.indices);
    mesh.uv_normal = pick(&mesh.uv_normal, &mesh.indices);
    mesh.colors = pick(&mesh.colors, &mesh.indices);
    mesh.indices = (0..mesh.positions.len() as u32).collect();
}

/// `KHR_texture_transform`: scale, then rotate counter-clockwise as seen in the image (v down), then move. The sign of the
/// rotation is that of the extension's prose and example; its GLSL, read literally, turns the other way.
fn bake(transform: &TextureTransform, uv: &mut [[f32; 2]]) {
    let (sin, cos) = (libm::sin(transform.rotation), libm::cos(transform.rotation));
    for point in uv {
        let u = f64::from(point[0]) * transform.scale[0];
        let v = f64::from(point[1]) * transform.scale[1];
        *point = [(cos * u + sin * v + transform.offset[0]) as f32, (-sin * u + cos * v + transform.offset[1]) as f32];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangulate(&[0, 1, 2, 3, 4], TRIANGLE_STRIP), [0, 1, 2, 1, 3, 2, 2, 3, 4]);
        assert_eq!(triangulate(&[0, 1, 2, 3], 6), [1, 2, 0, 2, 3, 0]);
        assert_eq!(triangulate(&[0, 1, 2, 3], TRIANGLES), [0, 1, 2]);
        assert_eq!(triangulate(&[0, 1, 1, 2, 3], TRIANGLE_STRIP), [1, 2, 3], "degenerate ones join strips");
        for mode in [4, 5, 6] {
            assert!(triangulate(&[], mode).is_empty() && triangulate(&[0, 1], mode).is_empty());
        }
    }

    /// The extension's own example: the lower left quadrant of the picture, turned by 90 degrees.
    #[test]
    fn texture_transform_scales_then_rotates_then_moves() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let mut uv = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        bake(&TextureTransform { offset: [0.0, 1.0], rotation: quarter, scale: [0.5, 0.5], tex_coord: None }, &mut uv);
        for (got, expected) in uv.iter().zip([[0.0, 1.0], [0.0, 0.5], [0.5, 1.0], [0.5, 0.5]]) {
            assert!((got[0] - expected[0]).abs() < 1e-6 && (got[1] - expected[1]).abs() < 1e-6, "{got:?}");
        }
        let mut uv = [[1.0, 0.0], [0.0, 1.0]];
        bake(&TextureTransform { offset: [0.5, 0.0], rotation: quarter, scale: [2.0, 3.0], tex_coord: None }, &mut uv);
        for (got, expected) in uv.iter().zip([[0.5, -2.0], [3.5, 0.0]]) {
            assert!((got[0] - expected[0]).abs() < 1e-6 && (got[1] - expected[1]).abs() < 1e-6, "{got:?}");
        }
    }
}
