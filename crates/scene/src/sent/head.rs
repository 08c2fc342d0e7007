//! The head of a scene that travels: everything but the arrays of its meshes.

use crate::camera::{Viewpoint, WorldBounds};
use crate::picture::MAX_SIDE;
use crate::view::{LightOrbit, LightSource, ViewHints};
use crate::{SceneError, SceneSubject};
use basrelief_signals::{Image, Lighting, Material, Mesh, Object, Sampler, ShadingSettings, Texture};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Everything but arrays. References are places in lists.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SceneManifest {
    name: String,
    textures: Vec<TextureHead>,
    materials: Vec<MaterialHead>,
    pub(super) meshes: Vec<MeshHead>,
    objects: Vec<ObjectHead>,
    view: ViewHead,
    warnings: Vec<String>,
}

/// A texture: its size and the hash of its picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct TextureHead {
    id: u32,
    name: String,
    sampler: Sampler,
    size: [u32; 2],
    offset: u64,
    picture: [u8; 32],
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct MaterialHead {
    id: u32,
    name: String,
    base_color: [f32; 4],
    color_texture: Option<u32>,
    normal_map: Option<u32>,
    normal_scale: f32,
    lighting: Lighting,
    double_sided: bool,
}

/// Lengths of the arrays of a mesh.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct MeshHead {
    pub(super) vertices: u32,
    pub(super) triangles: u32,
    pub(super) uv: bool,
    pub(super) uv_normal: NormalUv,
    pub(super) colors: bool,
}

/// Coordinates of the normal map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum NormalUv {
    /// There are none.
    None,
    /// The coordinates of the colour texture.
    Same,
    /// Other coordinates.
    Own,
}

impl NormalUv {
    /// Those of a mesh; equal to the bit, or its own.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let bits = |uv: &[[f32; 2]]| uv.as_flattened().iter().map(|n| n.to_bits()).collect::<Vec<_>>();
        match mesh.uv_normal.is_empty() {
            true => Self::None,
            false if bits(&mesh.uv) == bits(&mesh.uv_normal) => Self::Same,
            false => Self::Own,
        }
    }
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct ObjectHead {
    name: String,
    mesh: u32,
    world: [f64; 16],
    material: u32,
    entries: Option<u32>,
    bias: Option<u8>,
    bump: Option<bool>,
    shading: ShadingSettings,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct ViewHead {
    bounds: WorldBounds,
    camera: Option<Viewpoint>,
    lamps: Vec<(LightSource, f64)>,
    frames: u32,
    orbit: f64,
    light_orbit: LightOrbit,
    shading: ShadingSettings,
}

/// Things that several refer to, each once, in the order in which they were first named.
struct SharedItems<'a, T> {
    list: Vec<&'a Arc<T>>,
    places: BTreeMap<*const T, u32>,
}

impl<'a, T> SharedItems<'a, T> {
    fn new() -> Self {
        Self { list: vec![], places: BTreeMap::new() }
    }

    fn place(&mut self, of: &'a Arc<T>) -> u32 {
        let next = self.list.len() as u32;
        *self.places.entry(Arc::as_ptr(of)).or_insert_with(|| {
            self.list.push(of);
            next
        })
    }
}

impl SceneManifest {
    /// The head of a subject, and the meshes of the following arrays.
    pub(super) fn of<'a>(subject: &'a SceneSubject, hash: &mut dyn FnMut(&Texture) -> [u8; 32]) -> (Self, Vec<&'a Arc<Mesh>>) {
        let (mut meshes, mut materials, mut textures) = (SharedItems::new(), SharedItems::new(), SharedItems::new());
        let object = |object: &'a Arc<Object>| ObjectHead {
            name: object.name.clone(),
            mesh: meshes.place(&object.mesh),
            world: object.world,
            material: materials.place(&object.material),
            entries: object.entries,
            bias: object.bias,
            bump: object.bump,
            shading: object.shading,
        };
        let objects = subject.objects.iter().map(object).collect();
        let material = |material: &&'a Arc<Material>| MaterialHead {
            id: material.id,
            name: material.name.clone(),
            base_color: material.base_color,
            color_texture: material.color_texture.as_ref().map(|t| textures.place(t)),
            normal_map: material.normal_map.as_ref().map(|t| textures.place(t)),
            normal_scale: material.normal_scale,
            lighting: material.lighting,
            double_sided: material.double_sided,
        };
        let head = Self {
            name: subject.name.clone(),
            objects,
            materials: materials.list.iter().map(material).collect(),
            textures: textures.list.iter().map(|texture| TextureHead::of(texture, hash(texture))).collect(),
            meshes: meshes.list.iter().map(|mesh| MeshHead::of(mesh)).collect(),
            view: ViewHead::of(&subject.hints),
            warnings: subject.warnings.clone(),
        };
        (head, meshes.list)
    }

    /// The subject with these meshes.
    pub(super) fn subject(self, meshes: Vec<Mesh>) -> Result<SceneSubject, SceneError> {
        let Self { name, textures, materials, objects, view, warnings, .. } = self;
        let meshes: Vec<Arc<Mesh>> = meshes.into_iter().map(Arc::new).collect();
        distinct("textures", textures.iter().map(|t| t.id))?;
        distinct("materials", materials.iter().map(|m| m.id))?;
        let textures = read("textures", textures, TextureHead::texture)?;
        let materials = read("materials", materials, |material, i| material.material(i, &textures))?;
        let objects = read("objects", objects, |object, i| object.object(i, &meshes, &materials))?;
        Ok(SceneSubject { name, objects, hints: view.hints()?, camera_ratio: None, warnings })
    }
}

/// Each of a list, with its number.
fn read<T, U>(
    list: &str,
    all: Vec<T>,
    of: impl Fn(T, usize) -> Result<U, (&'static str, String)>,
) -> Result<Vec<Arc<U>>, SceneError> {
    let each = all.into_iter().enumerate();
    each.map(|(i, one)| of(one, i).map(Arc::new).map_err(|(field, what)| SceneError::at(place(list, i, field), what))).collect()
}

/// The place of an element of a list of the head.
pub(super) fn place(list: &str, index: usize, field: &str) -> String {
    if field.is_empty() { format!("/{list}/{index}") } else { format!("/{list}/{index}/{field}") }
}

fn distinct(list: &str, ids: impl Iterator<Item = u32>) -> Result<(), SceneError> {
    let mut known = BTreeSet::new();
    match ids.enumerate().find(|(_, id)| !known.insert(*id)) {
        Some((i, id)) => Err(SceneError::at(place(list, i, "id"), format!("{id}, as one before")).expected("another number")),
        None => Ok(()),
    }
}

/// Returns the element of a reference.
fn referred<T>(list: &[Arc<T>], place: u32, field: &'static str) -> Result<Arc<T>, (&'static str, String)> {
    let there = list.get(place as usize).cloned();
    there.ok_or_else(|| (field, format!("{place}, but there are {}", list.len())))
}

fn finite(numbers: impl IntoIterator<Item = f64>, field: &'static str) -> Result<(), (&'static str, String)> {
    match numbers.into_iter().find(|n| !n.is_finite()) {
        Some(n) => Err((field, format!("{n}; expected finite numbers"))),
        None => Ok(()),
    }
}

impl TextureHead {
    fn of(texture: &Texture, picture: [u8; 32]) -> Self {
        let size = texture.levels.first().map_or([1; 2], |image| [image.width, image.height]);
        Self { id: texture.id, name: texture.name.clone(), sampler: texture.sampler, size, offset: texture.offset, picture }
    }

    fn texture(self, _: usize) -> Result<Texture, (&'static str, String)> {
        let Self { id, name, sampler, size, offset, picture } = self;
        if size.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
            return Err(("size", format!("{} x {}; expected 1..={MAX_SIDE} per side", size[0], size[1])));
        }
        let levels = vec![Image { width: size[0], height: size[1], texels: vec![] }];
        Ok(Texture { id, name, sampler, levels, offset, elsewhere: Some(picture) })
    }
}

impl MaterialHead {
    fn material(self, _: usize, textures: &[Arc<Texture>]) -> Result<Material, (&'static str, String)> {
        let Self { id, name, base_color, color_texture, normal_map, normal_scale, lighting, double_sided } = self;
        finite(base_color.map(f64::from), "base_color")?;
        finite([normal_scale.into()], "normal_scale")?;
        let Lighting { ka, kd, ks, n } = lighting;
        if [ka, kd, ks].iter().any(|k| !(0.0..=1.0).contains(k)) || !(1.0..=1000.0).contains(&n) {
            return Err(("lighting", format!("{ka}, {kd}, {ks}, {n}; expected 0..=1 three times and 1..=1000")));
        }
        let color_texture = color_texture.map(|i| referred(textures, i, "color_texture")).transpose()?;
        let normal_map = normal_map.map(|i| referred(textures, i, "normal_map")).transpose()?;
        Ok(Material { id, name, base_color, color_texture, normal_map, normal_scale, lighting, double_sided })
    }
}

impl MeshHead {
    fn of(mesh: &Mesh) -> Self {
        Self {
            vertices: mesh.positions.len() as u32,
            triangles: (mesh.indices.len() / 3) as u32,
            uv: !mesh.uv.is_empty(),
            uv_normal: NormalUv::of(mesh),
            colors: !mesh.colors.is_empty(),
        }
    }
}

impl ObjectHead {
    fn object(self, id: usize, meshes: &[Arc<Mesh>], materials: &[Arc<Material>]) -> Result<Object, (&'static str, String)> {
        let Self { name, mesh, world, material, entries, bias, bump, shading } = self;
        finite(world, "world")?;
        in_range(&shading)?;
        let (mesh, material) = (referred(meshes, mesh, "mesh")?, referred(materials, material, "material")?);
        Ok(Object { id: id as u32, name, mesh, world, material, entries, bias, bump, shading })
    }
}

fn in_range(shading: &ShadingSettings) -> Result<(), (&'static str, String)> {
    match shading.out_of_range() {
        Some((name, value)) => Err(("shading", format!("{name} is {value}; expected 0..={}", ShadingSettings::MAX_INTENSITY))),
        None => Ok(()),
    }
}

impl ViewHead {
    fn of(hints: &ViewHints) -> Self {
        let ViewHints { bounds, camera, lamps, frames, orbit, light_orbit, shading } = hints;
        let (bounds, camera, lamps) = (*bounds, *camera, lamps.clone());
        Self { bounds, camera, lamps, frames: *frames, orbit: *orbit, light_orbit: *light_orbit, shading: *shading }
    }

    fn hints(self) -> Result<ViewHints, SceneError> {
        let Self { bounds, camera, lamps, frames, orbit, light_orbit, shading } = self;
        let lamp = |(lamp, intensity): &(LightSource, f64)| {
            let (LightSource::Directional(v) | LightSource::Point(v)) = lamp;
            [v.x, v.y, v.z, *intensity]
        };
        let camera_numbers = camera.iter().flat_map(|c| c.axes.into_iter().chain([c.eye]));
        let checked = finite([bounds.low, bounds.high].iter().flat_map(|v| v.to_array()), "bounds")
            .and_then(|()| finite(camera_numbers.flat_map(|v| v.to_array()), "camera"))
            .and_then(|()| finite(lamps.iter().flat_map(lamp), "lamps"))
            .and_then(|()| in_range(&shading));
        checked.map_err(|(field, what)| SceneError::at(format!("/view/{field}"), what))?;
        Ok(ViewHints { bounds, camera, lamps, frames, orbit, light_orbit, shading })
    }
}
