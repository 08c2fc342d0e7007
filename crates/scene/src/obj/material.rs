//! Materials and their pictures.

use super::map::TextureMap;
use super::mtl::{self, MtlMaterial};
use super::text::{escaped, shown, words};
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::outside::ImportContext;
use crate::textures::{TextureContent, TexturePicture, TextureStore};
use basrelief_signals::{Lighting, Material, Sampler, TexelFilter, Texture, WrapMode};
use basrelief_threads::workers;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Memory of an object or a material beside its name and its mesh \[bytes\].
pub(super) const OBJECT: u64 = 512;

/// Height of white over black \[texels\] where a bump map says `-bm 1` (assumed: the format does not say).
const BUMP_HEIGHT: f64 = 4.0;

/// Exponents that the devices have.
const EXPONENTS: [f32; 2] = [1.0, 1000.0];

/// Materials by name: a file can have as many as lines.
pub(super) type MaterialLibrary<'a> = BTreeMap<&'a [u8], &'a MtlMaterial>;

/// Returns materials by name. The first of two materials with the same name counts.
pub(super) fn by_name<'a>(definitions: &'a [MtlMaterial], warnings: &mut ImportWarnings) -> MaterialLibrary<'a> {
    let mut library = MaterialLibrary::new();
    for definition in definitions {
        if library.contains_key(definition.name.as_slice()) {
            warnings.add(format!("material `{}` is defined twice: its first definition is used", shown(&definition.name)));
        } else {
            library.insert(&definition.name, definition);
        }
    }
    library
}

/// File, whether it is clamped, kind of content, and the bits of its height.
type TextureKey = (String, bool, u8, u64);

/// A material with the maps that place its textures.
#[derive(Clone)]
pub(super) struct PlacedMaterial {
    pub material: Arc<Material>,
    /// Map of the colour texture.
    pub color: Option<TextureMap>,
    /// Map of the normal map.
    pub relief: Option<TextureMap>,
    /// The material only emits. Vertex colours multiply `Kd`, which is black, so they have no effect.
    pub emits: bool,
}

/// Builds materials and loads their pictures.
pub(super) struct MaterialBuilder<'a> {
    outside: &'a ImportContext<'a>,
    store: TextureStore,
    /// Textures made so far; `None` for a picture that is missing.
    shared: BTreeMap<TextureKey, Option<Arc<Texture>>>,
    /// A library cannot be read, so that a warning names its lack.
    lacks_library: bool,
}

impl<'a> MaterialBuilder<'a> {
    pub fn new(outside: &'a ImportContext<'a>) -> Self {
        Self { outside, store: TextureStore::default(), shared: BTreeMap::new(), lacks_library: false }
    }

    /// Reads the libraries that `mtllib` statements name. A missing one is a warning.
    pub fn libraries(&mut self, statements: &[Vec<u8>], warnings: &mut ImportWarnings) -> Result<Vec<MtlMaterial>, SceneError> {
        let mut all = Vec::new();
        for statement in statements {
            match self.library(statement, warnings) {
                Ok(materials) => all.extend(materials),
                Err(error) if error.over_budget => return Err(error),
                // A statement can name several libraries; a name can have blanks, too.
                Err(error) if words(statement).nth(1).is_none() => self.warn_of_library(&error, warnings),
                Err(_) => {
                    for word in words(statement) {
                        match self.library(word, warnings) {
                            Ok(materials) => all.extend(materials),
                            Err(error) if error.over_budget => return Err(error),
                            Err(error) => self.warn_of_library(&error, warnings),
                        }
                    }
                }
            }
        }
        Ok(all)
    }

    fn warn_of_library(&mut self, error: &SceneError, warnings: &mut ImportWarnings) {
        self.lacks_library = true;
        warnings.add(format!("{error}; drawn without its materials"));
    }

    fn library(&self, name: &[u8], warnings: &mut ImportWarnings) -> Result<Vec<MtlMaterial>, SceneError> {
        let name = escaped(name).replace('\\', "/");
        let (bytes, _held) = self.outside.read(&name, "mtllib")?;
        let mut materials = mtl::parse(&bytes, &name, self.outside, warnings).map_err(|e| e.in_file(&name))?;
        let folder = name.rfind('/').map_or("", |end| &name[..=end]);
        for map in materials.iter_mut().flat_map(MtlMaterial::maps) {
            map.file.insert_str(0, folder);
        }
        Ok(materials)
    }

    pub fn build(
        &mut self,
        id: u32,
        name: &[u8],
        library: &MaterialLibrary<'_>,
        warnings: &mut ImportWarnings,
    ) -> Result<PlacedMaterial, SceneError> {
        self.outside.hold(OBJECT + 2 * name.len() as u64, "", "materials and their names")?;
        // Without culling: OBJ does not say which side of a face is meant.
        let plain = Material { id, name: escaped(name), double_sided: true, ..Material::default() };
        let Some(definition) = library.get(name) else {
            let is_reported = library.is_empty() && self.lacks_library;
            if !name.is_empty() && !is_reported {
                warnings.add(format!("material `{}` is in no library: drawn white", shown(name)));
            }
            return Ok(PlacedMaterial { material: Arc::new(plain), color: None, relief: None, emits: false });
        };
        let emits = definition.diffuse == [0.0; 3] && definition.emission != [0.0; 3];
        warn_of_omissions(definition, emits, warnings);
        let color = if emits { &definition.emission_map } else { &definition.color }.as_deref();
        let (relief, content) = match (&definition.normal, &definition.bump) {
            (Some(normal), _) => (Some(&**normal), TextureContent::Normals),
            (None, bump) => (bump.as_deref(), TextureContent::Heights(BUMP_HEIGHT * bump.as_ref().map_or(1.0, |m| m.height))),
        };
        self.decode_ahead([(color, TextureContent::Color), (relief, content)]);
        let color_texture = self.texture(color, TextureContent::Color, warnings)?;
        let normal_map = self.texture(relief, content, warnings)?;
        let gain = color.map_or(1.0, |map| gain(map, warnings));
        let [r, g, b] = if emits { definition.emission } else { definition.diffuse }.map(|c| c * gain);
        let mut lighting = lighting(definition, warnings);
        if emits {
            let ks = definition.specular.map_or(0.0, |_| lighting.ks);
            lighting = Lighting { ka: 1.0, kd: 0.0, ks, ..lighting };
        }
        let material = Material { base_color: [r, g, b, 1.0], color_texture, normal_map, lighting, ..plain };
        Ok(PlacedMaterial { material: Arc::new(material), color: color.cloned(), relief: relief.cloned(), emits })
    }

    fn texture(
        &mut self,
        map: Option<&TextureMap>,
        content: TextureContent,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        let Some(map) = map else { return Ok(None) };
        let key = texture_key(map, content);
        if let Some(texture) = self.shared.get(&key) {
            return Ok(texture.clone());
        }
        let texture = match self.store.add_ahead(content, self.outside) {
            Some(texture) => Some(texture),
            None => self.decoded(map, content, warnings)?,
        };
        // A key, and its place in the table.
        self.outside.hold(256 + map.file.len() as u64, "MTL", "names of images")?;
        self.shared.insert(key, texture.clone());
        Ok(texture)
    }

    /// Decodes the picture of a map; `None`, with a warning, if it cannot be read.
    fn decoded(
        &mut self,
        map: &TextureMap,
        content: TextureContent,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        match self.picture(map, content) {
            Ok(picture) => self.store.decode(&picture, self.outside).map(Some),
            Err(e) if e.over_budget => Err(e),
            Err(e) => {
                warnings.add(format!("{e}; drawn without it"));
                Ok(None)
            }
        }
    }

    /// Returns the picture file of a map for this use.
    fn picture(&self, map: &TextureMap, content: TextureContent) -> Result<TexturePicture<'static>, SceneError> {
        let wrap = if map.clamp { WrapMode::Clamp } else { WrapMode::Repeat };
        let sampler = Sampler { wrap: [wrap; 2], filter: TexelFilter::Bilinear };
        let (bytes, held) = self.outside.read(&map.file, "MTL")?;
        Ok(TexturePicture { bytes: bytes.into(), _held: held, name: map.file.clone(), sampler, content })
    }

    /// Decodes the pictures of two maps at the same time, if neither has a texture yet.
    fn decode_ahead(&mut self, maps: [(Option<&TextureMap>, TextureContent); 2]) {
        let picture = |(map, content): (Option<&TextureMap>, TextureContent)| {
            let map = map.filter(|map| !self.shared.contains_key(&texture_key(map, content)))?;
            self.picture(map, content).ok()
        };
        let [color, relief] = maps;
        let both = || Some([picture(color)?, picture(relief)?]);
        let pictures = if workers() > 1 { both() } else { None };
        self.store.decode_ahead(self.outside, pictures);
    }
}

fn texture_key(map: &TextureMap, content: TextureContent) -> TextureKey {
    let (kind, bits) = match content {
        TextureContent::Color => (0, 0),
        TextureContent::Normals => (1, 0),
        TextureContent::Heights(height) => (2, height.to_bits()),
    };
    (map.file.clone(), map.clamp, kind, bits)
}

/// Factor of a colour picture; a base other than 0 and gains beyond 1 are left out.
fn gain(map: &TextureMap, warnings: &mut ImportWarnings) -> f32 {
    let [base, gain] = map.range;
    if base == 0.0 && (0.0..=1.0).contains(&gain) {
        return gain as f32;
    }
    warnings.add("MTL option `-mm` of a colour image is not supported unless its base is 0 and its gain 0..=1: drawn without it");
    1.0
}

/// The lighting coefficients of a material. Ks and Ns are the devices' ks and n; the others are as in any model.
fn lighting(definition: &MtlMaterial, warnings: &mut ImportWarnings) -> Lighting {
    let mut lighting = Lighting::default();
    if let Some([r, g, b]) = definition.specular {
        if r != g || g != b {
            warnings.add("coloured highlights (`Ks`) are drawn white, with the luminance of their colour (Rec. 709)");
        }
        lighting.ks = if r == g && g == b { r } else { 0.2126 * r + 0.7152 * g + 0.0722 * b };
    }
    if let Some(exponent) = definition.exponent {
        let [least, most] = EXPONENTS;
        lighting.n = exponent.clamp(least, most);
        if lighting.n != exponent {
            warnings.add(format!("exponents of highlights (`Ns`) beyond {least}..={most} are clamped"));
        }
    }
    match definition.model {
        // A constant colour.
        Some(0) => lighting = Lighting { ka: 1.0, kd: 0.0, ks: 0.0, ..lighting },
        // No highlights.
        Some(1) => lighting.ks = 0.0,
        Some(model @ 3..) => {
            warnings.add(format!("MTL: `illum {model}` is drawn as `illum 2`, without reflection and refraction"))
        }
        _ => {}
    }
    lighting
}

fn warn_of_omissions(definition: &MtlMaterial, emits: bool, warnings: &mut ImportWarnings) {
    let name = || shown(&definition.name);
    let black = definition.diffuse == [0.0; 3];
    if definition.emission != [0.0; 3] && !emits {
        warnings.add(format!("material `{}` emits light (`Ke`): not used, because its `Kd` is not black", name()));
    }
    if definition.emission_map.is_some() && !emits {
        warnings.add("MTL statement `map_Ke` is not used, except where `Kd` is black and `Ke` is not");
    }
    if definition.normal.is_some() && definition.bump.is_some() {
        warnings.add(format!("material `{}`: its `bump` is not used, because its `norm` is a normal map too", name()));
    }
    if black && definition.color.is_some() {
        warnings.add(format!("material `{}`: its `Kd` is black, so that its `map_Kd` does not show", name()));
    }
}
