//! Materials and their textures.

use super::buffers::{GltfBuffers, read_uri};
use super::check::{resolve, unsupported};
use super::geometry::{RequestedAttributes, UvRequest};
use super::json::{GltfDocument, GltfInteger, MaterialDef, TextureInfo};
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::files::shorten;
use crate::outside::ImportContext;
use crate::picture;
use crate::textures::{TextureContent, TexturePicture, TextureStore};
use basrelief_input::MemoryReservation;
use basrelief_signals::{Lighting, Material, Sampler, TexelFilter, Texture, WrapMode};
use basrelief_threads::workers;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Memory of a material beside its name \[bytes\].
const MATERIAL: u64 = 512;

/// Number of a linear filter in glTF.
const LINEAR: u64 = 9729;

/// Number of a linear filter between linearly filtered MIP levels in glTF.
const LINEAR_MIPMAP_LINEAR: u64 = 9987;

/// A material and its requests to the primitives that use it.
#[derive(Clone)]
pub(crate) struct BuiltMaterial {
    pub material: Arc<Material>,
    pub needs: RequestedAttributes,
}

/// Builds the materials of one document.
pub(crate) struct MaterialBuilder<'a> {
    pub document: &'a GltfDocument,
    pub buffers: &'a GltfBuffers<'a>,
    outside: &'a ImportContext<'a>,
    pub store: TextureStore,
    /// Textures made so far, by picture. Each picture has a few, by sampler and use.
    shared: BTreeMap<usize, Vec<(Sampler, TextureContent, Arc<Texture>)>>,
    /// Materials by number in the document; the last is the default material.
    surfaces: Vec<Option<BuiltMaterial>>,
}

impl<'a> MaterialBuilder<'a> {
    pub(crate) fn new(document: &'a GltfDocument, buffers: &'a GltfBuffers<'a>, outside: &'a ImportContext<'a>) -> Self {
        let surfaces = vec![None; document.materials.len() + 1];
        Self { document, buffers, outside, store: TextureStore::default(), shared: BTreeMap::new(), surfaces }
    }

    /// The material of a primitive; built at its first use, so that textures of unused ones are not decoded.
    pub(crate) fn surface(
        &mut self,
        index: Option<GltfInteger>,
        warnings: &mut ImportWarnings,
    ) -> Result<BuiltMaterial, SceneError> {
        let i = index.map_or(self.document.materials.len(), GltfInteger::index);
        if let Some(Some(surface)) = self.surfaces.get(i) {
            return Ok(surface.clone());
        }
        let document = self.document;
        let surface = match document.materials.get(i) {
            Some(definition) => self.build(i, definition, warnings)?,
            None => {
                let material = Material { id: i as u32, name: "default".into(), ..Material::default() };
                BuiltMaterial { material: Arc::new(material), needs: RequestedAttributes::default() }
            }
        };
        if let Some(slot) = self.surfaces.get_mut(i) {
            *slot = Some(surface.clone());
        }
        Ok(surface)
    }

    fn build(&mut self, i: usize, def: &MaterialDef, warnings: &mut ImportWarnings) -> Result<BuiltMaterial, SceneError> {
        let place = format!("/materials/{i}");
        warn_of_omissions(def, &place, warnings);
        let pbr = def.pbr_metallic_roughness.as_ref();
        let emits = emits_only(def);
        let base_texture = pbr.and_then(|p| p.base_color_texture.as_ref());
        let color_info = if emits { def.emissive_texture.as_ref() } else { base_texture };
        let normal_info = def.normal_texture.as_ref();
        self.decode_ahead(color_info, normal_info);
        let color = self.texture(color_info, TextureContent::Color, warnings)?;
        let normal_map = self.texture(normal_info, TextureContent::Normals, warnings)?;
        let factor = pbr.map_or([1.0; 4], |p| p.base_color_factor);
        if factor.iter().any(|c| !(0.0..=1.0).contains(c)) {
            return Err(SceneError::at(format!("{place}/pbrMetallicRoughness/baseColorFactor"), format!("is {factor:?}"))
                .expected("four numbers, each 0..=1"));
        }
        if def.emissive_factor.iter().any(|c| !(0.0..=1.0).contains(c)) {
            return Err(SceneError::at(format!("{place}/emissiveFactor"), format!("is {:?}", def.emissive_factor))
                .expected("three numbers, each 0..=1"));
        }
        let [red, green, blue] = def.emissive_factor;
        let factor = if emits { [red, green, blue, factor[3]] } else { factor };
        let usual = if emits { Lighting { ka: 1.0, kd: 0.0, ks: 0.0, ..Lighting::default() } } else { Lighting::default() };
        let lighting = def.extras.lighting.unwrap_or(usual);
        let scale = normal_info.and_then(|n| n.scale).unwrap_or(1.0) as f32;
        if !scale.is_finite() {
            return Err(
                SceneError::at(format!("{place}/normalTexture/scale"), "is out of range").expected("a single-precision number")
            );
        }
        let name = def.name.as_ref().map_or(0, String::len) as u64;
        self.outside.hold(MATERIAL + name, place, "materials and their names")?;
        let needs = RequestedAttributes {
            color: color_info.filter(|_| color.is_some()).map(request),
            normal_map: normal_info.filter(|_| normal_map.is_some()).map(request),
            without_colors: emits,
        };
        let material = Material {
            id: i as u32,
            name: def.name.clone().unwrap_or_else(|| format!("material {i}")),
            base_color: factor.map(|c| c as f32),
            color_texture: color,
            normal_map,
            normal_scale: scale,
            double_sided: def.double_sided,
            lighting,
        };
        Ok(BuiltMaterial { material: Arc::new(material), needs })
    }

    /// Returns the texture of a material; `None` if it has none that can be read.
    fn texture(
        &mut self,
        info: Option<&TextureInfo>,
        content: TextureContent,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        let Some(info) = info else { return Ok(None) };
        let place = format!("/textures/{}", info.index.0);
        let texture = resolve(&self.document.textures, "textures", info.index, || place.clone())?;
        for name in texture.extensions.keys() {
            warnings.add(format!("{place}: the extension `{name}` is not supported: its image is not used"));
        }
        let Some(source) = texture.source else {
            warnings.add(format!("{place} has no source that can be read: drawn without it"));
            return Ok(None);
        };
        let sampler = self.sampler(texture.sampler)?;
        self.warn_of_filters(texture.sampler, warnings);
        let of_picture = self.shared.get(&source.index()).into_iter().flatten();
        if let Some((.., shared)) = of_picture.into_iter().find(|(s, c, _)| *s == sampler && *c == content) {
            return Ok(Some(shared.clone()));
        }
        let texture = if let Some(texture) = self.store.add_ahead(content, self.outside) {
            texture
        } else {
            let picture = self.picture(source, sampler, content)?;
            self.store.decode(&picture, self.outside).map_err(|e| named(e, source))?
        };
        self.shared.entry(source.index()).or_default().push((sampler, content, texture.clone()));
        Ok(Some(texture))
    }

    /// Decodes the pictures of a colour texture and of a normal map at the same time, if none of them has a texture yet.
    fn decode_ahead(&mut self, color: Option<&TextureInfo>, normals: Option<&TextureInfo>) {
        let picture = |info: Option<&TextureInfo>, content| {
            let texture = self.document.textures.get(info?.index.index())?;
            let source = texture.source.filter(|source| !self.shared.contains_key(&source.index()))?;
            self.picture(source, self.sampler(texture.sampler).ok()?, content).ok()
        };
        let both = || Some([picture(color, TextureContent::Color)?, picture(normals, TextureContent::Normals)?]);
        let pictures = if workers() > 1 { both() } else { None };
        self.store.decode_ahead(self.outside, pictures);
    }

    fn sampler(&self, index: Option<GltfInteger>) -> Result<Sampler, SceneError> {
        let Some(index) = index else { return Ok(Sampler::default()) };
        let place = || format!("/samplers/{}", index.0);
        let definition = resolve(&self.document.samplers, "samplers", index, place)?;
        let wrap = |mode: Option<GltfInteger>, field: &str| match mode.map(|m| m.0) {
            None | Some(10497) => Ok(WrapMode::Repeat),
            Some(33648) => Ok(WrapMode::Mirror),
            Some(33071) => Ok(WrapMode::Clamp),
            Some(other) => Err(SceneError::at(format!("{}/{field}", place()), format!("wrap mode {other}"))
                .expected("10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp to edge)")),
        };
        let filter = match definition.mag_filter.map(|m| m.0) {
            None | Some(LINEAR) => TexelFilter::Bilinear,
            Some(9728) => TexelFilter::Nearest,
            Some(other) => {
                return Err(SceneError::at(format!("{}/magFilter", place()), format!("filter {other}"))
                    .expected("9728 (nearest) or 9729 (linear)"));
            }
        };
        Ok(Sampler { wrap: [wrap(definition.wrap_s, "wrapS")?, wrap(definition.wrap_t, "wrapT")?], filter })
    }

    /// Warns if a sampler has other filters than the linear ones with MIP levels. No device reads the filters of a sampler.
    fn warn_of_filters(&self, index: Option<GltfInteger>, warnings: &mut ImportWarnings) {
        let Some(definition) = index.and_then(|index| self.document.samplers.get(index.index())) else { return };
        let differs = |filter: Option<GltfInteger>, linear: u64| filter.is_some_and(|filter| filter.0 != linear);
        if differs(definition.mag_filter, LINEAR) || differs(definition.min_filter, LINEAR_MIPMAP_LINEAR) {
            warnings.add(
                "filters of samplers (`magFilter`, `minFilter`) are not used: the device filters all textures alike, \
                 by its parameters `filter` and `mip`",
            );
        }
    }

    /// Returns a picture file for this use.
    fn picture(&self, source: GltfInteger, sampler: Sampler, content: TextureContent) -> Result<TexturePicture<'a>, SceneError> {
        let (bytes, name, held) = self.image(source)?;
        Ok(TexturePicture { bytes, _held: held, name, sampler, content })
    }

    /// Returns the bytes and the name of a picture file, with their reservation.
    fn image(&self, index: GltfInteger) -> Result<(Cow<'a, [u8]>, String, MemoryReservation), SceneError> {
        let place = format!("/images/{}", index.0);
        let image = resolve(&self.document.images, "images", index, || place.clone())?;
        let buffers: &'a GltfBuffers<'a> = self.buffers;
        let (bytes, held) = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                let (bytes, held) = read_uri(uri, self.outside, &format!("{place}/uri"))?;
                (Cow::Owned(bytes), held)
            }
            (None, Some(view)) => {
                let bytes = buffers.view(self.document, view, || format!("{place}/bufferView"))?;
                (Cow::Borrowed(bytes), self.outside.nothing())
            }
            (None, None) => {
                return Err(SceneError::at(place, "has neither a uri nor a bufferView").expected("one of them"));
            }
        };
        let from_uri = image.uri.as_deref().filter(|u| !u.starts_with("data:")).map(shorten);
        let name = image.name.clone().or(from_uri).unwrap_or_else(|| format!("image {}", index.0));
        Ok((bytes, name, held))
    }

    /// Decodes every picture. A fault may be the reason why nothing is drawn.
    pub(crate) fn check_pictures(&mut self) -> Result<(), SceneError> {
        for i in 0..self.document.images.len() {
            let index = GltfInteger(i as u64);
            let picture = self.picture(index, Sampler::default(), TextureContent::Color)?;
            self.store.decode(&picture, self.outside).map_err(|e| named(e, index))?;
        }
        Ok(())
    }

    /// Looks at the pictures that no drawn material uses: a missing or unknown one is worth a warning, but no more.
    pub(crate) fn check_unused(&self, warnings: &mut ImportWarnings) {
        for i in 0..self.document.images.len() {
            if self.shared.contains_key(&i) {
                continue;
            }
            match self.image(GltfInteger(i as u64)) {
                Ok((bytes, name, _)) if picture::sniff(&bytes).is_none() => {
                    warnings.add(format!("/images/{i}: `{name}` is neither PNG nor JPEG (nothing drawn uses it)"));
                }
                Ok(_) => {}
                Err(e) => warnings.add(format!("{e} (nothing drawn uses it)")),
            }
        }
    }
}

/// Adds the pointer to an error of a picture, which knows only its file.
fn named(mut error: SceneError, source: GltfInteger) -> SceneError {
    error.place = format!("/images/{}", source.0);
    error
}

fn request(info: &TextureInfo) -> UvRequest {
    let transform = info.extensions.transform.clone();
    let set = transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(info.tex_coord);
    UvRequest { set: set.0, transform }
}

/// True if a surface emits light and reflects none: its emission can be drawn as constant ambient light.
fn emits_only(definition: &MaterialDef) -> bool {
    let base = definition.pbr_metallic_roughness.as_ref().map_or([1.0; 4], |p| p.base_color_factor);
    definition.emissive_factor != [0.0; 3] && base.iter().take(3).all(|c| *c == 0.0)
}

fn warn_of_omissions(definition: &MaterialDef, place: &str, warnings: &mut ImportWarnings) {
    if definition.emissive_factor != [0.0; 3] && !emits_only(definition) {
        warnings.add(format!("{place}: its emission is not used, because its base colour is not black"));
    }
    let roughness = definition.pbr_metallic_roughness.as_ref().and_then(|p| p.metallic_roughness_texture.as_ref());
    for (texture, name) in [(roughness, "metallicRoughnessTexture"), (definition.occlusion_texture.as_ref(), "occlusionTexture")]
    {
        if texture.is_some() {
            warnings.add(format!("`{name}` is not used: the devices have no such property"));
        }
    }
    if let Some(mode) = definition.alpha_mode.as_deref().filter(|m| *m != "OPAQUE") {
        warnings.add(format!("{place}: alphaMode {mode} is not supported: drawn opaque"));
    }
    for name in definition.extensions.keys() {
        warnings.add(unsupported(name));
    }
}
