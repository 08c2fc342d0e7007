//! glTF 2.0: `.gltf` with external files or data URIs, and `.glb`.
//!
//! The JSON is read into structs of this crate ([`json`]) and not of a glTF library. The known libraries reject files that
//! can be drawn or panic on offsets beyond the end, and their errors do not name the place in the file.

mod accessor;
mod buffers;
mod check;
mod extras;
mod format;
mod geometry;
pub(crate) mod glb;
mod json;
mod material;
mod nodes;
mod other;
pub(crate) mod parse;
mod pointer;
mod scene;
mod semantic;
mod skin;
#[cfg(test)]
mod tests;
mod unknown;
mod vertex_matrices;

use crate::SceneError;
use crate::camera::rows;
use crate::error::ImportWarnings;
use crate::model::{ImportedModel, bounds};
use crate::outside::{ImportContext, mesh_bytes};
use accessor::AccessorReader;
use basrelief_signals::{Material, Mesh, Object, ShadingSettings};
use buffers::{GltfBuffers, GltfContainer};
use extras::BasreliefExtras;
use geometry::{MeshSource, PrimitiveReader};
use glam::{DMat3, DMat4};
use json::{GltfDocument, GltfNode, GltfPrimitive};
use material::MaterialBuilder;
use nodes::PlacedNode;
use skin::SkinReader;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum number of vertices of all objects together: a mesh may be placed many times.
const MAX_PLACED_VERTICES: usize = 1 << 27;

/// Memory of a placed object beside its name and its mesh \[bytes\].
const OBJECT: u64 = 512;

/// Imports a `.glb` file.
pub(crate) fn import_glb(
    bytes: &[u8],
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<ImportedModel, SceneError> {
    let glb = glb::parse(bytes, warnings)?;
    import(glb.json, GltfContainer::Glb(glb.bin), outside, warnings)
}

/// Imports a `.gltf` file.
pub(crate) fn import_json(
    bytes: &[u8],
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<ImportedModel, SceneError> {
    import(bytes, GltfContainer::Json, outside, warnings)
}

fn import(
    json: &[u8],
    container: GltfContainer<'_>,
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<ImportedModel, SceneError> {
    let (document, _held) = parse::parse(json, outside, warnings)?;
    check::check(&document, warnings)?;
    let buffers = GltfBuffers::load(&document, container, outside)?;
    let accessors = AccessorReader::new(&document, &buffers, outside, warnings)?;
    // Lists that grow by doubling: nodes in the world, nodes to be placed, and a flag for nodes with a parent.
    let placed = document.nodes.len() as u64 * 4 * size_of::<PlacedNode>() as u64;
    let _placed = outside.take(placed, "/nodes", "nodes in the world")?;
    let nodes = nodes::place(&document, warnings)?;
    let camera = scene::camera(&document, &nodes, warnings)?;
    let quantized = document.extensions_used.iter().any(|e| e == "KHR_mesh_quantization");
    let mut importer = GltfImporter {
        document: &document,
        outside,
        geometry: PrimitiveReader::new(&accessors, quantized),
        skins: SkinReader::new(&document, &accessors, warnings)?,
        materials: MaterialBuilder::new(&document, &buffers, outside),
        primitives: BTreeMap::new(),
        objects: Vec::new(),
        vertices: 0,
    };
    importer.draw_nodes(&nodes, warnings)?;
    importer.materials.check_unused(warnings);
    let objects = std::mem::take(&mut importer.objects);
    if objects.is_empty() {
        // The reason may be a fault in the data of the model.
        accessors.check_finite(warnings)?;
        importer.materials.check_pictures()?;
        return Err(nothing_to_draw(&document).with_notes(warnings.sentences()));
    }
    let bounds = bounds(&objects);
    let lamps = scene::lamps(&document, &nodes, bounds.centre(), warnings)?;
    let shading = document
        .scenes
        .get(document.scene.map_or(0, |scene| scene.index()))
        .map_or_else(ShadingSettings::default, |s| s.extras.shading);
    let (camera, camera_ratio) = camera.unzip();
    Ok(ImportedModel { objects, bounds, camera, camera_ratio: camera_ratio.flatten(), lamps, shading })
}

fn nothing_to_draw(document: &GltfDocument) -> SceneError {
    let (place, cure) = if document.meshes.is_empty() {
        ("/meshes", "the file has no mesh: export the model with its geometry")
    } else {
        ("/scene", "its meshes are in no visible node of the scene, or have no triangles: export the model with them")
    };
    SceneError::at(place, "nothing to draw").expected("at least one triangle in the scene").cure(cure)
}

/// True if a transform leaves no area: two or more of its scales are 0.
fn is_line_or_point(world: DMat4) -> bool {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = DMat3::from_mat4(world);
    [x.cross(y), y.cross(z), z.cross(x)].iter().all(|area| area.length_squared() == 0.0)
}

/// A primitive ready to be placed.
type BuiltPrimitive = (Arc<Mesh>, Arc<Material>, BasreliefExtras);

/// Collects objects; meshes that several nodes use are shared.
struct GltfImporter<'a> {
    document: &'a GltfDocument,
    outside: &'a ImportContext<'a>,
    geometry: PrimitiveReader<'a>,
    skins: SkinReader<'a>,
    materials: MaterialBuilder<'a>,
    /// Meshes by mesh, primitive, and the node that has the skin or weights.
    primitives: BTreeMap<(usize, usize, Option<usize>), Option<BuiltPrimitive>>,
    objects: Vec<Arc<Object>>,
    vertices: usize,
}

impl GltfImporter<'_> {
    /// Draws the meshes of the nodes, or all meshes if the file has no nodes.
    fn draw_nodes(&mut self, nodes: &[PlacedNode], warnings: &mut ImportWarnings) -> Result<(), SceneError> {
        let document = self.document;
        for placed in nodes.iter().filter(|placed| placed.visible) {
            let Some(node) = document.nodes.get(placed.index) else { continue };
            let Some(mesh) = node.mesh else { continue };
            // The joints alone say where a skinned mesh is (glTF 2.0, section 3.7.3.3).
            let world = if node.skin.is_some() { DMat4::IDENTITY } else { placed.world };
            if is_line_or_point(world) {
                warnings.add(format!("/nodes/{} is scaled to a line or a point: not drawn", placed.index));
                continue;
            }
            self.draw_mesh(mesh.index(), world, Some((placed.index, node)), warnings)?;
        }
        if document.nodes.is_empty() && !document.meshes.is_empty() {
            warnings.add("the file has no nodes: all its meshes are drawn where they are");
            for mesh in 0..document.meshes.len() {
                self.draw_mesh(mesh, DMat4::IDENTITY, None, warnings)?;
            }
        }
        Ok(())
    }

    fn draw_mesh(
        &mut self,
        mesh: usize,
        world: DMat4,
        placed: Option<(usize, &GltfNode)>,
        warnings: &mut ImportWarnings,
    ) -> Result<(), SceneError> {
        let node = placed.map(|(_, node)| node);
        let document = self.document;
        let Some(definition) = document.meshes.get(mesh) else { return Ok(()) };
        let node_name = node.and_then(|n| n.name.clone());
        let base = node_name.or(definition.name.clone()).unwrap_or_else(|| format!("mesh {mesh}"));
        for (i, primitive) in definition.primitives.iter().enumerate() {
            let posed = placed.filter(|(_, node)| node.skin.is_some() || node.weights.is_some());
            let Some((built, material, extras)) = self.primitive(mesh, i, primitive, posed, warnings)? else { continue };
            self.vertices = self.vertices.saturating_add(built.positions.len());
            if self.vertices > MAX_PLACED_VERTICES {
                return Err(SceneError::at(format!("/meshes/{mesh}"), "is placed so often that there is too much to draw")
                    .expected(format!("at most {MAX_PLACED_VERTICES} vertices in all places")));
            }
            let object = OBJECT + base.len() as u64;
            self.outside.hold(object, format!("/meshes/{mesh}/primitives/{i}"), "objects and their names")?;
            let own = node.map(|n| n.extras).unwrap_or_default();
            self.objects.push(Arc::new(Object {
                id: self.objects.len() as u32,
                // Not formatted, which would take twice the room for a long one.
                name: if definition.primitives.len() > 1 { [&base, " / ", &i.to_string()].concat() } else { base.clone() },
                mesh: built,
                world: rows(world),
                material,
                entries: own.entries.or(extras.entries),
                bias: own.bias.or(extras.bias),
                bump: own.bump.or(extras.bump),
                shading: own.shading.or(extras.shading),
            }));
        }
        Ok(())
    }

    /// The mesh and material of a primitive, built once.
    fn primitive(
        &mut self,
        mesh: usize,
        number: usize,
        primitive: &GltfPrimitive,
        posed: Option<(usize, &GltfNode)>,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<BuiltPrimitive>, SceneError> {
        let key = (mesh, number, posed.map(|(node, _)| node));
        if let Some(built) = self.primitives.get(&key) {
            return Ok(built.clone());
        }
        let place = format!("/meshes/{mesh}/primitives/{number}");
        let Some(corners) = self.geometry.corners(primitive, &place, warnings)? else {
            self.geometry.accessors.built(0);
            self.primitives.insert(key, None);
            return Ok(None);
        };
        let surface = self.materials.surface(primitive.material, warnings)?;
        let own = self.document.meshes.get(mesh).map_or(&[][..], |mesh| &mesh.weights);
        let weights = posed.and_then(|(_, node)| node.weights.as_deref()).unwrap_or(own);
        let skin = match posed.and_then(|(_, node)| node.skin) {
            Some(skin) => self.skins.influences(&self.geometry, skin, primitive, corners.vertices, &place, warnings)?,
            None => None,
        };
        let source = MeshSource { primitive, needs: &surface.needs, weights, skin: skin.as_ref(), place: &place };
        let mesh = self.geometry.mesh(&source, corners, warnings)?;
        self.geometry.accessors.built(mesh_bytes(&mesh));
        let extras = primitive.material.and_then(|m| self.document.materials.get(m.index())).map(|m| m.extras);
        let built = Some((Arc::new(mesh), surface.material, extras.unwrap_or_default()));
        self.primitives.insert(key, built.clone());
        Ok(built)
    }
}
