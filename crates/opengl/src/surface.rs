//! Materials: textures and uniforms of a draw call become base colour, normal map and lighting coefficients.

use crate::dump::{GlDump, ImageRecord};
use crate::fixed::{self, FixedMaterial};
use crate::geometry::GlMesh;
use crate::map_value::NONE;
use crate::mapping::MapKey;
use crate::picture;
use crate::program;
use crate::reader::DrawReader;
use basrelief_input::MemoryPool;
use basrelief_scene::{SceneError, pyramid};
use basrelief_signals::{Image, Lighting, WrapMode};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::Value;

/// Filters and wrap modes of a texture, as in glTF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GlSampler {
    pub mag_filter: u32,
    pub min_filter: u32,
    pub wrap: [u32; 2],
}

/// A texture: a PNG file and its sampler.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GlTexture {
    /// Name of the sampler uniform.
    pub name: String,
    pub png: Vec<u8>,
    pub sampler: GlSampler,
}

/// A material.
#[derive(Clone, Debug, Default)]
pub(crate) struct GlSurface {
    pub base_color: [f64; 3],
    pub albedo: Option<GlTexture>,
    pub normal_map: Option<GlTexture>,
    pub lighting: Lighting,
    pub double_sided: bool,
}

/// Names of the textures of a draw call by purpose.
#[derive(Default)]
struct ChosenTextures {
    normal: Option<String>,
    height: Option<String>,
    albedo: Option<String>,
}

/// Returns the material of a draw call.
pub(crate) fn surface(reader: &mut DrawReader<'_>, mesh: &GlMesh, double_sided: bool) -> Result<GlSurface, SceneError> {
    let samplers = samplers(reader);
    let choose = if mesh.uv.is_some() { choose_textures } else { leave_out_textures };
    let ChosenTextures { normal, height, albedo } = choose(reader, &samplers)?;
    let normal_map = match (normal, height) {
        (Some(name), other) => {
            other.iter().for_each(|name| reader.warn(format!("texture `{name}` is left out, because there is a normal map")));
            texture(reader, &name)?
        }
        (None, Some(name)) => height_texture(reader, &name)?,
        (None, None) => None,
    };
    let albedo = albedo.map(|name| texture(reader, &name)).transpose()?.flatten();
    let usual = if fixed::is_fixed(reader.dump) {
        fixed::material(reader)
    } else if mesh.normals.is_some() || normal_map.is_some() {
        FixedMaterial { base_color: [1.0; 3], lighting: Lighting::default() }
    } else {
        reader.note("ambient = 1, diffuse = 0, specular = 0 (guessed: no light, because there are no normals)");
        FixedMaterial::UNLIT
    };
    let base_color = base_color(reader, usual.base_color)?;
    Ok(GlSurface { base_color, albedo, normal_map, lighting: lighting(reader, usual.lighting)?, double_sided })
}

/// Chooses textures by purpose, and warns of the rest.
fn choose_textures(reader: &mut DrawReader<'_>, samplers: &[String]) -> Result<ChosenTextures, SceneError> {
    let has = |words: &'static [&'static str]| move |name: &str| words.iter().any(|word| name.contains(word));
    let normal = choose(reader, MapKey::NormalMap, samplers, has(&["normal", "bump"]))?;
    let height = choose(reader, MapKey::HeightMap, samplers, has(&["height", "displace", "parallax"]))?;
    let is_free = |name: &&String| ![&normal, &height].iter().any(|other| other.as_ref() == Some(name));
    let rest: Vec<String> = samplers.iter().filter(is_free).cloned().collect();
    let other = |name: &str| !has(&["spec", "gloss", "rough", "metal", "occlusion", "emiss", "environment", "shadow"])(name);
    let albedo = choose(reader, MapKey::Albedo, &rest, other)?;
    for name in rest.iter().filter(|name| albedo.as_ref() != Some(name)) {
        let reason = if holds_depths(reader, name) { ", because it holds depths" } else { "" };
        reader.warn(format!("texture `{name}` is left out{reason}"));
    }
    Ok(ChosenTextures { normal, height, albedo })
}

/// Chooses no texture, because the draw call has no texture coordinates. Warns of each.
fn leave_out_textures(reader: &mut DrawReader<'_>, samplers: &[String]) -> Result<ChosenTextures, SceneError> {
    for key in [MapKey::Albedo, MapKey::NormalMap, MapKey::HeightMap] {
        // Nothing is guessed, but a mapped name must exist.
        choose(reader, key, samplers, |_| false)?;
    }
    for name in samplers {
        reader.warn(format!("texture `{name}` is left out, because the draw call has no texture coordinates"));
    }
    Ok(ChosenTextures::default())
}

/// Chooses a texture for a purpose. A texture of depths is no guess, and an error if it is mapped.
fn choose(
    reader: &mut DrawReader<'_>,
    key: MapKey,
    samplers: &[String],
    guess: impl Fn(&str) -> bool,
) -> Result<Option<String>, SceneError> {
    let (depths, colors): (Vec<String>, Vec<String>) = samplers.iter().cloned().partition(|name| holds_depths(reader, name));
    match reader.mapped(key).filter(|given| depths.iter().any(|name| name == given)) {
        Some(given) => Err(SceneError::at("", format!("--map {key}={given}: the texture holds depths"))
            .expected("a sampler of a texture with colours")
            .cure(format!("leave it out with --map {key}={NONE}"))),
        None => reader.choose(key, &colors, guess),
    }
}

/// Returns true if the dump states that a texture holds depths.
fn holds_depths(reader: &DrawReader<'_>, name: &str) -> bool {
    let key = unit(reader.dump, name).map(texture_key);
    key.and_then(|key| reader.dump.textures.get(&key)).is_some_and(|record| record.format.starts_with("GL_DEPTH"))
}

/// Returns the names of active two-dimensional samplers, or of the texture units of the fixed function.
fn samplers(reader: &DrawReader<'_>) -> Vec<String> {
    if fixed::is_fixed(reader.dump) {
        return fixed::texture_units(reader.dump);
    }
    let mut names: Vec<String> = reader.dump.shaders.values().flat_map(|source| program::samplers(source)).collect();
    names.retain(|name| reader.dump.uniforms.contains_key(name));
    names.sort();
    names.dedup();
    names
}

/// Returns the finest level of a texture, as a PNG file; `None`, with a warning, if the dump has no such texture.
fn texture(reader: &mut DrawReader<'_>, name: &str) -> Result<Option<GlTexture>, SceneError> {
    let Some((place, record, sampler)) = record(reader, name)? else { return Ok(None) };
    // Decoded here, so that errors name the draw call.
    picture::decode(record, &place, reader.budget)?;
    let (png, held) = picture::file_of(record, &place, reader.budget)?;
    reader.keep(held);
    Ok(Some(GlTexture { name: name.into(), png, sampler }))
}

/// Returns the normal map of a height map.
fn height_texture(reader: &mut DrawReader<'_>, name: &str) -> Result<Option<GlTexture>, SceneError> {
    let Some((place, record, sampler)) = record(reader, name)? else { return Ok(None) };
    let strength = reader.mapped_number(MapKey::HeightScale).unwrap_or(1.0);
    reader.note(format!("height-map = {name}: 1.0 is {strength} texels high"));
    let (image, held) = picture::decode(record, &place, reader.budget)?;
    // Heights of 8 bytes, and the levels of normals.
    let _work = reader.reserve(4 * held.bytes(), &place, "heights")?;
    let wrap = sampler.wrap.map(|mode| match mode {
        10497 => WrapMode::Repeat,
        33648 => WrapMode::Mirror,
        _ => WrapMode::Clamp,
    });
    // Heights are the red channel, as programs sample it.
    let red = Image { texels: image.texels.iter().map(|[r, ..]| [*r, *r, *r, 255]).collect(), ..image };
    let levels = pyramid::height_levels(pyramid::heights_of(&red), strength, wrap);
    let Some(finest) = levels.first() else { return Ok(None) };
    let png = png(finest, reader.budget, &place)?;
    Ok(Some(GlTexture { name: format!("{name} as normals"), png, sampler }))
}

fn png(image: &Image, budget: &MemoryPool, place: &str) -> Result<Vec<u8>, SceneError> {
    let mut bytes = Vec::new();
    let texels = image.texels.as_flattened();
    let _work = budget.try_reserve(2 * texels.len() as u64, "a PNG file").map_err(|e| basrelief_scene::over_budget(place, &e))?;
    let written = PngEncoder::new(&mut bytes).write_image(texels, image.width, image.height, ExtendedColorType::Rgba8);
    written.map(|()| bytes).map_err(|e| SceneError::at(place, format!("cannot be written as PNG: {e}")))
}

/// Returns the texture unit of a sampler.
fn unit(dump: &GlDump, name: &str) -> Option<u64> {
    let of_fixed = || name.strip_prefix("GL_TEXTURE").filter(|_| fixed::is_fixed(dump)).and_then(|unit| unit.parse().ok());
    dump.uniforms.get(name).and_then(Value::as_u64).or_else(of_fixed)
}

/// Returns the name of the finest level in a dump.
fn texture_key(unit: u64) -> String {
    format!("GL_TEXTURE{unit}, GL_TEXTURE_2D, level = 0")
}

/// The place, the finest level and the sampler of a texture.
type TextureRecord<'a> = (String, &'a ImageRecord, GlSampler);

fn record<'a>(reader: &mut DrawReader<'a>, name: &str) -> Result<Option<TextureRecord<'a>>, SceneError> {
    let dump = reader.dump;
    let unit = unit(dump, name).ok_or_else(|| {
        SceneError::at(format!("/uniforms/{name}"), "is no whole number").expected("the number of a texture unit")
    })?;
    let key = texture_key(unit);
    let Some(record) = dump.textures.get(&key) else {
        reader.warn(format!("texture `{name}` is not in the dump (`{key}`): drawn without it"));
        return Ok(None);
    };
    let state = dump.parameters.0.get(&format!("GL_TEXTURE{unit}")).and_then(|unit| unit.get("GL_TEXTURE_2D"));
    let word = |field: &str| state.and_then(|state| state.get(field)).and_then(Value::as_str).unwrap_or_default();
    warn_of_state(reader, name, record, state);
    let mut wrap = [0; 2];
    for (mode, field) in wrap.iter_mut().zip(["GL_TEXTURE_WRAP_S", "GL_TEXTURE_WRAP_T"]) {
        *mode = match word(field) {
            "" | "GL_REPEAT" => 10497,
            "GL_MIRRORED_REPEAT" => 33648,
            "GL_CLAMP_TO_EDGE" => 33071,
            other => {
                reader.warn(format!("texture `{name}`: {other} is drawn as GL_CLAMP_TO_EDGE"));
                33071
            }
        };
    }
    let mag_filter = if word("GL_TEXTURE_MAG_FILTER") == "GL_NEAREST" { 9728 } else { 9729 };
    let min_filter = match word("GL_TEXTURE_MIN_FILTER") {
        "GL_NEAREST" => 9728,
        "GL_LINEAR" => 9729,
        "GL_NEAREST_MIPMAP_NEAREST" => 9984,
        "GL_LINEAR_MIPMAP_NEAREST" => 9985,
        "GL_NEAREST_MIPMAP_LINEAR" => 9986,
        _ => 9987,
    };
    Ok(Some((format!("/textures/{key}"), record, GlSampler { mag_filter, min_filter, wrap })))
}

/// Warns of the state of a texture that the devices do not have.
fn warn_of_state(reader: &mut DrawReader<'_>, name: &str, record: &ImageRecord, state: Option<&Value>) {
    let field = |field: &str| state.and_then(|state| state.get(field));
    for (channel, usual) in [("R", "GL_RED"), ("G", "GL_GREEN"), ("B", "GL_BLUE"), ("A", "GL_ALPHA")] {
        let swizzle = format!("GL_TEXTURE_SWIZZLE_{channel}");
        if let Some(other) = field(&swizzle).and_then(Value::as_str).filter(|other| *other != usual) {
            reader.warn(format!("texture `{name}`: {swizzle} = {other} is left out"));
        }
    }
    if let Some(level) = field("GL_TEXTURE_BASE_LEVEL").and_then(Value::as_f64).filter(|level| *level != 0.0) {
        reader.warn(format!("texture `{name}`: GL_TEXTURE_BASE_LEVEL = {level} is left out: drawn from level 0"));
    }
    let internal = field("GL_TEXTURE_INTERNAL_FORMAT").and_then(Value::as_str).unwrap_or_default();
    if let Some(format) = [&*record.format, internal].iter().find(|format| format.contains("SRGB")) {
        reader.warn(format!("texture `{name}`: {format} is drawn without the conversion from sRGB to linear colours"));
    }
}

/// Returns the base colour: three numbers, a uniform, or the usual colour.
fn base_color(reader: &mut DrawReader<'_>, usual: [f64; 3]) -> Result<[f64; 3], SceneError> {
    let guess = |name: &str| {
        let is_color = ["color", "colour", "albedo", "diffuse"].iter().any(|word| name.contains(word));
        is_color && !["light", "spec", "ambient", "clear", "fog"].iter().any(|word| name.contains(word))
    };
    let color = reader.vector(MapKey::BaseColor, &guess)?.unwrap_or(usual);
    let clamped = color.map(|channel| MapKey::BaseColor.clamped(channel));
    if clamped != color {
        reader.warn(format!("{} = {color:?} is drawn as {clamped:?}", MapKey::BaseColor));
    }
    Ok(clamped)
}

fn lighting(reader: &mut DrawReader<'_>, usual: Lighting) -> Result<Lighting, SceneError> {
    let mut coefficient = |key: MapKey, word: &'static str, usual: f32| {
        let given = reader.number(key, &|name| name.contains(word) && !name.contains("color"))?;
        Ok::<_, SceneError>(given.map_or(usual, |value| reader.clamped(key, value) as f32))
    };
    Ok(Lighting {
        ka: coefficient(MapKey::Ambient, "ambient", usual.ka)?,
        kd: coefficient(MapKey::Diffuse, "diffuse", usual.kd)?,
        ks: coefficient(MapKey::Specular, "specular", usual.ks)?,
        n: coefficient(MapKey::Shininess, "shininess", usual.n)?,
    })
}
