//! Writer of glTF 2.0 with embedded buffers and textures.

use crate::geometry::GlMesh;
use crate::surface::{GlSurface, GlTexture};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{SceneError, over_budget};
use glam::DMat4;
use serde_json::{Value, json};

/// An object of the scene.
#[derive(Debug)]
pub(crate) struct GlObject {
    pub name: String,
    pub mesh: GlMesh,
    /// Affine.
    pub world: DMat4,
    pub surface: GlSurface,
}

/// Largest memory of a vertex in buffers, base64 and text \[bytes\].
const VERTEX: u64 = 4 * 64;

/// Writes objects as nodes of one scene. Returns the text and its reservation.
pub(crate) fn write(objects: &[GlObject], budget: &MemoryPool) -> Result<(String, MemoryReservation), SceneError> {
    let png = |texture: &Option<GlTexture>| texture.as_ref().map_or(0, |texture| 4 * texture.png.len() as u64);
    let size = |object: &GlObject| {
        let vertices = VERTEX * object.mesh.positions.len() as u64 + 16 * object.mesh.indices.len() as u64;
        vertices + png(&object.surface.albedo) + png(&object.surface.normal_map) + 4096
    };
    let mut held = budget.try_reserve(objects.iter().map(size).sum(), "the glTF text").map_err(|e| over_budget("", &e))?;
    let mut writer = GltfWriter::default();
    for (number, object) in objects.iter().enumerate() {
        let primitive = writer.primitive(&object.mesh, number);
        writer.meshes.push(json!({ "name": object.name, "primitives": [primitive] }));
        let material = writer.material(&object.surface, &object.name);
        writer.materials.push(material);
        writer.nodes.push(json!({ "name": object.name, "mesh": number, "matrix": object.world.to_cols_array() }));
    }
    let text = writer.into_text();
    held.shrink_to(text.len() as u64);
    Ok((text, held))
}

#[derive(Default)]
struct GltfWriter {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    nodes: Vec<Value>,
    /// Texture files in the order of images, to share equal ones.
    files: Vec<Vec<u8>>,
    images: Vec<Value>,
    samplers: Vec<Value>,
    textures: Vec<Value>,
}

impl GltfWriter {
    fn primitive(&mut self, mesh: &GlMesh, material: usize) -> Value {
        let mut attributes = serde_json::Map::new();
        let [low, high] = bounds(&mesh.positions);
        let positions = self.floats(mesh.positions.as_flattened(), "VEC3", 3);
        if let Some(accessor) = self.accessors.get_mut(positions) {
            (accessor["min"], accessor["max"]) = (json!(low), json!(high));
        }
        attributes.insert("POSITION".into(), json!(positions));
        let lists: [(&str, Option<&[f32]>, &str, usize); 4] = [
            ("NORMAL", mesh.normals.as_deref().map(|list| list.as_flattened()), "VEC3", 3),
            ("TANGENT", mesh.tangents.as_deref().map(|list| list.as_flattened()), "VEC4", 4),
            ("TEXCOORD_0", mesh.uv.as_deref().map(|list| list.as_flattened()), "VEC2", 2),
            ("COLOR_0", mesh.colors.as_deref().map(|list| list.as_flattened()), "VEC4", 4),
        ];
        for (name, list, kind, size) in lists {
            if let Some(list) = list {
                attributes.insert(name.into(), json!(self.floats(list, kind, size)));
            }
        }
        let bytes: Vec<u8> = mesh.indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessors.push(json!({ "bufferView": view, "componentType": 5125, "count": mesh.indices.len(), "type": "SCALAR" }));
        json!({ "attributes": attributes, "indices": self.accessors.len() - 1, "material": material })
    }

    /// Adds a list of numbers. Returns the number of its accessor.
    fn floats(&mut self, list: &[f32], kind: &str, size: usize) -> usize {
        let bytes: Vec<u8> = list.iter().flat_map(|number| number.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessors.push(json!({ "bufferView": view, "componentType": 5126, "count": list.len() / size, "type": kind }));
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    fn material(&mut self, surface: &GlSurface, name: &str) -> Value {
        let [red, green, blue] = surface.base_color;
        let lighting = surface.lighting;
        let mut material = json!({
            "name": name,
            "doubleSided": surface.double_sided,
            "pbrMetallicRoughness": { "baseColorFactor": [red, green, blue, 1.0] },
            "extras": { "basrelief": { "lighting": lighting } },
        });
        if let Some(texture) = &surface.albedo {
            material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": self.texture(texture) });
        }
        if let Some(texture) = &surface.normal_map {
            material["normalTexture"] = json!({ "index": self.texture(texture) });
        }
        material
    }

    /// Adds a texture. Returns its number.
    fn texture(&mut self, texture: &GlTexture) -> usize {
        let known = self.files.iter().position(|file| *file == texture.png);
        let image = known.unwrap_or_else(|| {
            self.files.push(texture.png.clone());
            let uri = format!("data:image/png;base64,{}", STANDARD.encode(&texture.png));
            self.images.push(json!({ "name": texture.name, "uri": uri }));
            self.images.len() - 1
        });
        let sampler = texture.sampler;
        let sampler = json!({
            "magFilter": sampler.mag_filter,
            "minFilter": sampler.min_filter,
            "wrapS": sampler.wrap[0],
            "wrapT": sampler.wrap[1],
        });
        let number = find_or_add(&mut self.samplers, sampler);
        find_or_add(&mut self.textures, json!({ "source": image, "sampler": number }))
    }

    fn into_text(self) -> String {
        let nodes: Vec<usize> = (0..self.nodes.len()).collect();
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        let mut document = json!({
            "asset": { "version": "2.0", "generator": "basrelief" },
            "scene": 0,
            "scenes": [{ "nodes": nodes }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": self.bytes.len(), "uri": uri }],
        });
        // glTF forbids empty lists.
        for (name, list) in [("images", self.images), ("samplers", self.samplers), ("textures", self.textures)] {
            if !list.is_empty() {
                document[name] = list.into();
            }
        }
        document.to_string()
    }
}

/// Returns the number of an equal item, which is added if there is none.
fn find_or_add(list: &mut Vec<Value>, item: Value) -> usize {
    let known = list.iter().position(|other| *other == item);
    known.unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    })
}

/// Returns the least and the greatest coordinates.
fn bounds(positions: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let first = positions.first().copied().unwrap_or_default();
    positions.iter().fold([first, first], |[mut low, mut high], position| {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
        [low, high]
    })
}
