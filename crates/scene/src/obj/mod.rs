//! Wavefront OBJ and MTL.
//!
//! Read with a parser of this crate: the error messages of the known library have no line numbers, and it takes
//! non-finite numbers and unknown text for granted.

mod mtl;
mod parse;
#[cfg(test)]
mod tests;

use crate::SceneError;
use crate::error::Warnings;
use crate::files::shorten;
use crate::model::{Model, bounds};
use crate::outside::{Outside, mesh_bytes, over_budget};
use crate::textures::{Content, TextureStore};
use crate::{normals, tangents};
use basrelief_input::{Held, OverBudget};
use basrelief_signals::{Material, Mesh, Object, Sampler, ShadingSettings, TexelFilter, Texture, WrapMode};
use glam::DVec3;
use mtl::{Map, MtlMaterial};
use parse::{Corner, Group, NONE, Obj};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a corner takes while a mesh is made: its index, in a list that grows by doubling \[bytes\].
const CORNER: u64 = 8;
/// What a vertex takes: its places in lists that grow by doubling, and in a table \[bytes\].
const VERTEX: u64 = 200;
/// Vertices that are counted at a time.
const VERTICES: u32 = 256;
/// What is counted.
const TRIANGLES: &str = "vertices and triangles";

/// What an object or a material takes beside its name and its mesh \[bytes\].
const OBJECT: u64 = 512;

/// Height of white over black \[texels\] where a bump map says `-bm 1` (assumed: the format does not say).
const BUMP_HEIGHT: f64 = 4.0;

const IDENTITY: [f64; 16] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];

/// Imports an OBJ file.
pub(crate) fn import(bytes: &[u8], outside: &Outside<'_>, warnings: &mut Warnings) -> Result<Model, SceneError> {
    let (obj, _held) = parse::parse(bytes, outside, warnings)?;
    if obj.groups.is_empty() {
        return Err(SceneError::at("", "nothing to draw")
            .expected("at least one face (`f`)")
            .cure("export the model with its faces")
            .with_notes(warnings.sentences()));
    }
    let mut materials = Materials { outside, store: TextureStore::default(), shared: BTreeMap::new() };
    let definitions = materials.libraries(&obj.libraries, warnings)?;
    // Of two with the same name the first.
    let library: Library<'_> = definitions.iter().rev().map(|m| (m.name.as_str(), m)).collect();
    let (smooth, _smooth) = smooth_normals(&obj, outside)?;
    let mut by_name: BTreeMap<&str, Arc<Material>> = BTreeMap::new();
    let mut objects = Vec::new();
    for group in &obj.groups {
        let material = match by_name.get(group.material.as_str()) {
            Some(material) => material.clone(),
            None => materials.build(by_name.len() as u32, &group.material, &library, warnings)?,
        };
        by_name.insert(&group.material, material.clone());
        let corners = 3 * group.triangles.len() as u64;
        let tangents = if material.normal_map.is_some() { tangents::BYTES_PER_CORNER } else { 0 };
        let mut held = outside.take((CORNER + tangents) * corners, "", TRIANGLES)?;
        let mesh = build_mesh(&obj, group, &smooth, &material, &mut held, warnings).map_err(|e| over_budget("", &e))?;
        let name = object_name(group);
        held.shrink_to(mesh_bytes(&mesh));
        outside.keep(held);
        outside.hold(OBJECT + name.len() as u64, "", "objects and their names")?;
        objects.push(Arc::new(Object {
            id: objects.len() as u32,
            name,
            mesh: Arc::new(mesh),
            world: IDENTITY,
            material,
            entries: None,
            bias: None,
            bump: None,
            shading: ShadingSettings::default(),
        }));
    }
    Ok(Model { bounds: bounds(&objects), objects, camera: None, lamps: Vec::new(), shading: ShadingSettings::default() })
}

fn object_name(group: &Group) -> String {
    let parts: Vec<&str> = [group.object.as_str(), group.material.as_str()].into_iter().filter(|p| !p.is_empty()).collect();
    if parts.is_empty() { "object".into() } else { parts.join(" / ") }
}

/// Smooth normals per position, over the whole file; empty where every corner has its own.
fn smooth_normals(obj: &Obj, outside: &Outside<'_>) -> Result<(Vec<[f32; 3]>, Held), SceneError> {
    let triangles = || obj.groups.iter().flat_map(|g| &g.triangles).flatten();
    if triangles().all(|corner| corner[2] != NONE) {
        return Ok((Vec::new(), outside.nothing()));
    }
    let corners = triangles().count();
    let (sums, indices) = (36 * obj.positions.len(), 8 * corners);
    let held = outside.take((sums + indices) as u64, "", "normals of vertices")?;
    let indices: Vec<u32> = triangles().map(|corner| corner[0]).collect();
    Ok((normals::smooth(&obj.positions, &indices), held))
}

/// The mesh of a group: one vertex for each different corner.
fn build_mesh(
    obj: &Obj,
    group: &Group,
    smooth: &[[f32; 3]],
    material: &Material,
    held: &mut Held,
    warnings: &mut Warnings,
) -> Result<Mesh, OverBudget> {
    let mut mesh = Mesh::default();
    let textured = material.color_texture.is_some() || material.normal_map.is_some();
    let mut vertices: BTreeMap<Corner, u32> = BTreeMap::new();
    for corner in group.triangles.iter().flatten() {
        let next = mesh.positions.len() as u32;
        let vertex = *vertices.entry(*corner).or_insert(next);
        mesh.indices.push(vertex);
        if vertex < next {
            continue;
        }
        if next.is_multiple_of(VERTICES) {
            held.grow(VERTEX * u64::from(VERTICES), TRIANGLES)?;
        }
        let [position, uv, normal] = corner.map(|i| i as usize);
        mesh.positions.push(obj.positions.get(position).copied().unwrap_or_default());
        let own = obj.normals.get(normal).map(|n| DVec3::from_array(n.map(f64::from)));
        let fallback = smooth.get(position).copied().unwrap_or([0.0, 0.0, 1.0]);
        mesh.normals.push(own.and_then(DVec3::try_normalize).map_or(fallback, |n| n.as_vec3().to_array()));
        if !obj.colors.is_empty() {
            mesh.colors.push(obj.colors.get(position).copied().unwrap_or([1.0; 4]));
        }
        if textured {
            if uv == NONE as usize {
                warnings.add(format!("`{}` has faces without texture coordinates: all (0, 0)", object_name(group)));
            }
            // OBJ's v runs up, glTF's down.
            mesh.uv.push(obj.uv.get(uv).map_or([0.0; 2], |[u, v]| [*u, 1.0 - v]));
        }
    }
    if material.normal_map.is_some() {
        mesh.uv_normal = mesh.uv.clone();
        tangents::generate(&mut mesh);
    }
    if material.color_texture.is_none() {
        mesh.uv.clear();
    }
    Ok(mesh)
}

/// Materials by name: a file can have as many as lines.
type Library<'a> = BTreeMap<&'a str, &'a MtlMaterial>;

/// File, whether it is clamped, kind of content, and the bits of its height.
type TextureKey = (String, bool, u8, u64);

/// Builds materials and loads their pictures.
struct Materials<'a> {
    outside: &'a Outside<'a>,
    store: TextureStore,
    /// Textures made so far; `None` for a picture that is missing.
    shared: BTreeMap<TextureKey, Option<Arc<Texture>>>,
}

fn texture_key(map: &Map, content: Content) -> TextureKey {
    let (kind, bits) = match content {
        Content::Color => (0, 0),
        Content::Normals => (1, 0),
        Content::Heights(height) => (2, height.to_bits()),
    };
    (map.file.clone(), map.clamp, kind, bits)
}

impl Materials<'_> {
    /// Reads all material libraries; a missing one is a warning.
    fn libraries(&self, names: &[String], warnings: &mut Warnings) -> Result<Vec<MtlMaterial>, SceneError> {
        let mut all = Vec::new();
        for name in names {
            let name = name.replace('\\', "/");
            match self.outside.read(&name, "mtllib") {
                Ok((bytes, _held)) => {
                    let mut materials = mtl::parse(&bytes, self.outside, warnings).map_err(|e| e.in_file(&name))?;
                    let folder = name.rfind('/').map_or("", |end| &name[..=end]);
                    for map in materials.iter_mut().flat_map(|m| [&mut m.color, &mut m.bump, &mut m.normal]).flatten() {
                        map.file.insert_str(0, folder);
                    }
                    all.extend(materials);
                }
                Err(e) if e.over_budget => return Err(e),
                Err(e) => warnings.add(format!("{e}; drawn without its materials")),
            }
        }
        Ok(all)
    }

    fn build(
        &mut self,
        id: u32,
        name: &str,
        library: &Library<'_>,
        warnings: &mut Warnings,
    ) -> Result<Arc<Material>, SceneError> {
        self.outside.hold(OBJECT + 2 * name.len() as u64, "", "materials and their names")?;
        // Without culling: OBJ does not say which side of a face is meant.
        let plain = Material { id, name: name.into(), double_sided: true, ..Material::default() };
        let Some(definition) = library.get(name) else {
            if !name.is_empty() && !library.is_empty() {
                warnings.add(format!("material `{}` is in no library: drawn white", shorten(name)));
            }
            return Ok(Arc::new(plain));
        };
        let color_texture = self.texture(definition.color.as_ref(), Content::Color, warnings)?;
        let normal_map = match (&definition.normal, &definition.bump) {
            (Some(normal), _) => self.texture(Some(normal), Content::Normals, warnings)?,
            (None, bump) => {
                let height = BUMP_HEIGHT * bump.as_ref().map_or(1.0, |m| m.multiplier);
                self.texture(bump.as_ref(), Content::Heights(height), warnings)?
            }
        };
        let [r, g, b] = definition.diffuse;
        Ok(Arc::new(Material { base_color: [r, g, b, 1.0], color_texture, normal_map, ..plain }))
    }

    fn texture(
        &mut self,
        map: Option<&Map>,
        content: Content,
        warnings: &mut Warnings,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        let Some(map) = map else { return Ok(None) };
        let key = texture_key(map, content);
        if let Some(texture) = self.shared.get(&key) {
            return Ok(texture.clone());
        }
        let wrap = if map.clamp { WrapMode::Clamp } else { WrapMode::Repeat };
        let sampler = Sampler { wrap: [wrap; 2], filter: TexelFilter::Bilinear };
        let texture = match self.outside.read(&map.file, "MTL") {
            Ok((bytes, _held)) => Some(self.store.decode(&bytes, &map.file, sampler, content, self.outside)?),
            Err(e) if e.over_budget => return Err(e),
            Err(e) => {
                warnings.add(format!("{e}; drawn without it"));
                None
            }
        };
        // A key, and its place in the table.
        self.outside.hold(256 + map.file.len() as u64, "MTL", "names of pictures")?;
        self.shared.insert(key, texture.clone());
        Ok(texture)
    }
}
