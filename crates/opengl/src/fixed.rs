//! Material and light of the fixed function, from the parameters of a dump.

use crate::calls::POSITION;
use crate::dump::GlDump;
use crate::mapping::MapKey;
use crate::matrix::matrix;
use crate::reader::DrawReader;
use crate::state::{Parameters, is_on};
use basrelief_signals::Lighting;
use glam::{DMat4, DVec3, DVec4};
use serde_json::Value;

/// Largest deviation of a colour that is no warning: two steps of 8 bits.
const DEVIATION: f64 = 2.0 / 255.0;

/// Returns true if the fixed function computes the positions.
pub(crate) fn has_fixed_vertices(dump: &GlDump) -> bool {
    let has_position = dump.draw.as_ref().is_some_and(|draw| draw.attributes.contains_key(POSITION));
    has_position && !dump.shaders.contains_key("GL_VERTEX_SHADER")
}

/// Returns true if the fixed function computes positions and colours.
pub(crate) fn is_fixed(dump: &GlDump) -> bool {
    has_fixed_vertices(dump) && dump.shaders.is_empty()
}

/// Returns the names of the texture units that are on.
pub(crate) fn texture_units(dump: &GlDump) -> Vec<String> {
    let is_used = |name: &String| texture_state(dump, name).and_then(|state| state.get("enabled")).is_some_and(is_on);
    (0..8).map(|unit| format!("GL_TEXTURE{unit}")).filter(is_used).collect()
}

fn texture_state<'a>(dump: &'a GlDump, unit: &str) -> Option<&'a Value> {
    Parameters(dump).value(unit)?.get("GL_TEXTURE_2D")
}

/// Returns true if vertex colours reach the picture.
pub(crate) fn shows_vertex_colors(dump: &GlDump) -> bool {
    let parameters = Parameters(dump);
    let is_material = parameters.flag("GL_COLOR_MATERIAL")
        && matches!(
            parameters.word("GL_COLOR_MATERIAL_PARAMETER", "GL_AMBIENT_AND_DIFFUSE"),
            "GL_AMBIENT_AND_DIFFUSE" | "GL_DIFFUSE"
        );
    !texture_replaces(dump) && (is_material || !parameters.flag("GL_LIGHTING"))
}

/// Returns true if the texture replaces the light.
fn texture_replaces(dump: &GlDump) -> bool {
    let is_replacing = |unit: &String| matches!(texture_mode(dump, unit), "GL_REPLACE" | "GL_DECAL");
    texture_units(dump).first().is_some_and(is_replacing)
}

fn texture_mode<'a>(dump: &'a GlDump, unit: &str) -> &'a str {
    let environment = Parameters(dump).value(unit).and_then(|unit| unit.get("GL_TEXTURE_ENV"));
    environment.and_then(|environment| environment.get("GL_TEXTURE_ENV_MODE")).and_then(Value::as_str).unwrap_or("GL_MODULATE")
}

/// Returns a colour or position of a light or material.
fn vector(object: Option<&Value>, field: &str, initial: [f64; 4]) -> DVec4 {
    let list = object.and_then(|object| object.get(field)).and_then(Value::as_array);
    let numbers: Option<Vec<f64>> = list.and_then(|list| list.iter().map(Value::as_f64).collect());
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .filter(|numbers: &[f64; 4]| numbers.iter().all(|n| n.is_finite()))
        .unwrap_or(initial)
        .into()
}

fn color(object: Option<&Value>, field: &str, initial: [f64; 4]) -> DVec3 {
    vector(object, field, initial).truncate().max(DVec3::ZERO)
}

/// Returns the lights that are on, with their names. Dumps leave out the others.
fn lights(dump: &GlDump) -> Vec<(String, &Value)> {
    if !Parameters(dump).flag("GL_LIGHTING") {
        return Vec::new();
    }
    let light = |number| {
        let name = format!("GL_LIGHT{number}");
        Parameters(dump).value(&name).filter(|light| light.is_object()).map(|light| (name, light))
    };
    (0..8).filter_map(light).collect()
}

/// Returns the direction to the first light, in the space behind the model-view matrix; `None` without a light.
pub(crate) fn to_light(reader: &mut DrawReader<'_>, centre: DVec3) -> Option<DVec3> {
    let (name, light) = lights(reader.dump).into_iter().next()?;
    let position = vector(Some(light), "GL_POSITION", [0.0, 0.0, 1.0, 0.0]);
    let model_view = Parameters(reader.dump).value("GL_MODELVIEW_MATRIX").and_then(matrix).unwrap_or(DMat4::IDENTITY);
    let direction = if position.w == 0.0 {
        position.truncate()
    } else {
        reader.warn(format!("{name} is a point: drawn as a direction, from the middle of the object"));
        position.truncate() / position.w - model_view.transform_point3(centre)
    };
    if light.get("GL_SPOT_CUTOFF").and_then(Value::as_f64).is_some_and(|angle| angle < 180.0) {
        reader.warn(format!("{name} is a spotlight: drawn without its cone"));
    }
    reader.note(format!("light = {name}"));
    direction.try_normalize()
}

/// Material of the fixed function.
pub(crate) struct FixedMaterial {
    /// Diffuse colour under the first light, 0..=1.
    pub base_color: [f64; 3],
    /// Coefficients of the base colour.
    pub lighting: Lighting,
}

impl FixedMaterial {
    /// Material that no light changes.
    pub const UNLIT: Self = Self { base_color: [1.0; 3], lighting: Lighting { ka: 1.0, kd: 0.0, ks: 0.0, n: 1.0 } };
}

/// Returns the material. Parts that the lighting formula does not have are warnings.
pub(crate) fn material(reader: &mut DrawReader<'_>) -> FixedMaterial {
    warn_of_textures(reader);
    let dump = reader.dump;
    if !Parameters(dump).flag("GL_LIGHTING") || texture_replaces(dump) {
        return FixedMaterial::UNLIT;
    }
    let lights = lights(dump);
    for (name, _) in lights.iter().skip(1) {
        reader.warn(format!("{name} is left out: there is one light"));
    }
    let light = lights.first().map(|(_, light)| *light);
    let is_first = lights.first().is_some_and(|(name, _)| name == "GL_LIGHT0");
    let full = if is_first { [1.0; 4] } else { [0.0; 4] };
    let surface = Parameters(dump).value("GL_FRONT");
    let [mut ambient, mut diffuse] =
        [("GL_AMBIENT", [0.2; 4]), ("GL_DIFFUSE", [0.8; 4])].map(|(name, usual)| color(surface, name, usual));
    if shows_vertex_colors(dump) {
        diffuse = DVec3::ONE;
        if Parameters(dump).word("GL_COLOR_MATERIAL_PARAMETER", "GL_AMBIENT_AND_DIFFUSE") == "GL_AMBIENT_AND_DIFFUSE" {
            ambient = DVec3::ONE;
        }
    } else if Parameters(dump).flag("GL_COLOR_MATERIAL") {
        reader.warn("vertex colours are another part of the material than its diffuse colour: left out");
    }
    let around = Parameters(dump).numbers("GL_LIGHT_MODEL_AMBIENT").unwrap_or([0.2, 0.2, 0.2, 1.0]);
    let around = DVec4::from(around).truncate() + light.map_or(DVec3::ZERO, |light| color(Some(light), "GL_AMBIENT", [0.0; 4]));
    ambient = ambient * around + color(surface, "GL_EMISSION", [0.0; 4]);
    diffuse *= light.map_or(DVec3::ZERO, |light| color(Some(light), "GL_DIFFUSE", full));
    let specular =
        color(surface, "GL_SPECULAR", [0.0; 4]) * light.map_or(DVec3::ZERO, |light| color(Some(light), "GL_SPECULAR", full));
    let (base, kd) = if diffuse == DVec3::ZERO { (ambient, 0.0) } else { (diffuse, 1.0) };
    let base = base.min(DVec3::ONE);
    let lighting = Lighting {
        ka: share(reader, "ambient", ambient, base),
        kd,
        ks: share(reader, "specular", specular, base),
        n: exponent(reader, surface, specular),
    };
    FixedMaterial { base_color: base.to_array(), lighting }
}

/// Returns the specular exponent. Without highlights it has no effect, so it is no warning.
fn exponent(reader: &mut DrawReader<'_>, surface: Option<&Value>, specular: DVec3) -> f32 {
    let shininess = surface.and_then(|surface| surface.get("GL_SHININESS")).and_then(Value::as_f64).unwrap_or_default();
    let key = MapKey::Shininess;
    (if specular == DVec3::ZERO { key.clamped(shininess) } else { reader.clamped(key, shininess) }) as f32
}

/// Returns the coefficient of the base colour that is nearest to a colour.
fn share(reader: &mut DrawReader<'_>, part: &str, color: DVec3, base: DVec3) -> f32 {
    let share = if base == DVec3::ZERO { 0.0 } else { (color.dot(base) / base.length_squared()).clamp(0.0, 1.0) };
    if (base * share - color).abs().max_element() > DEVIATION {
        reader.warn(format!("the {part} colour {color} is drawn as {share:.2} times the base colour {base}"));
    }
    share as f32
}

fn warn_of_textures(reader: &mut DrawReader<'_>) {
    let dump = reader.dump;
    let Some(unit) = texture_units(dump).into_iter().next() else { return };
    let mode = texture_mode(dump, &unit);
    if !matches!(mode, "GL_MODULATE" | "GL_REPLACE" | "GL_DECAL") {
        reader.warn(format!("{unit} is combined by {mode}: drawn as GL_MODULATE"));
    }
    let parameters = Parameters(dump);
    if parameters.flag("GL_TEXTURE_GEN_S") || parameters.flag("GL_TEXTURE_GEN_T") {
        reader.warn("texture coordinates that OpenGL generates are left out");
    }
    if parameters.value("GL_TEXTURE_MATRIX").and_then(matrix).is_some_and(|matrix| matrix != DMat4::IDENTITY) {
        reader.warn("the texture matrix is left out");
    }
}
