//! The parts of a state dump that an import reads.

use crate::draw::DrawCall;
use crate::vertices::VertexColumns;
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt::{Formatter, Result as FmtResult};

/// State of OpenGL behind a draw call, as `apitrace replay -D CALL` writes it. `draw` is an addition of `basrelief capture`.
#[derive(Deserialize)]
pub(crate) struct GlDump {
    pub draw: Option<DrawCall>,
    #[serde(default)]
    pub parameters: GlParameters,
    /// Source texts by type of shader.
    #[serde(default)]
    pub shaders: BTreeMap<String, String>,
    #[serde(default)]
    pub uniforms: BTreeMap<String, Value>,
    #[serde(default)]
    pub buffers: GlBuffers,
    #[serde(default)]
    pub textures: BTreeMap<String, ImageRecord>,
    #[serde(default)]
    pub framebuffer: BTreeMap<String, ImageRecord>,
}

/// Parameters by name.
///
/// A texture unit has two members of the same name for each kind of texture: the switch of the fixed function, then the state of the
/// bound texture. The switch becomes the member `enabled` of the state.
#[derive(Default)]
pub(crate) struct GlParameters(pub BTreeMap<String, Value>);

impl<'de> Deserialize<'de> for GlParameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ParametersVisitor;
        impl<'de> Visitor<'de> for ParametersVisitor {
            type Value = GlParameters;
            fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
                f.write_str("an object of parameters")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<GlParameters, A::Error> {
                let mut result = BTreeMap::new();
                while let Some(name) = map.next_key::<String>()? {
                    let is_unit =
                        name.strip_prefix("GL_TEXTURE").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
                    let value = if is_unit { map.next_value::<TextureUnit>()?.0.into() } else { map.next_value()? };
                    result.insert(name, value);
                }
                Ok(GlParameters(result))
            }
        }
        deserializer.deserialize_map(ParametersVisitor)
    }
}

/// Members of a texture unit.
struct TextureUnit(Map<String, Value>);

impl<'de> Deserialize<'de> for TextureUnit {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct UnitVisitor;
        impl<'de> Visitor<'de> for UnitVisitor {
            type Value = TextureUnit;
            fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
                f.write_str("an object of the state of a texture unit")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<TextureUnit, A::Error> {
                let mut result = Map::new();
                while let Some((name, mut value)) = map.next_entry::<String, Value>()? {
                    if let (Some(switch), Value::Object(state)) = (result.remove(&name), &mut value) {
                        state.insert("enabled".into(), switch);
                    }
                    result.insert(name, value);
                }
                Ok(TextureUnit(result))
            }
        }
        deserializer.deserialize_map(UnitVisitor)
    }
}

/// Contents of buffers.
#[derive(Default, Deserialize)]
pub(crate) struct GlBuffers {
    /// Generic attributes of the first vertices in the bound buffers.
    #[serde(default)]
    pub vertices: VertexColumns,
}

/// A picture: a texture level or a part of the frame buffer.
#[derive(Deserialize)]
pub(crate) struct ImageRecord {
    #[serde(rename = "__width__")]
    pub width: u32,
    #[serde(rename = "__height__")]
    pub height: u32,
    #[serde(rename = "__depth__", default = "one")]
    pub depth: u32,
    /// Internal format, such as `GL_RGB8`.
    #[serde(rename = "__format__", default)]
    pub format: String,
    /// PNG or PFM in base64, possibly with line ends.
    #[serde(rename = "__data__")]
    pub data: String,
}

fn one() -> u32 {
    1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn switch_of_a_texture_is_kept_beside_its_state() {
        let text =
            r#"{"GL_TEXTURE1": {"GL_TEXTURE_2D": "GL_TRUE", "GL_TEXTURE_2D": {"a": 1}, "GL_TEXTURE_3D": "GL_FALSE"}, "b": 2}"#;
        let GlParameters(found) = serde_json::from_str(text).unwrap();
        let unit = serde_json::json!({"GL_TEXTURE_2D": {"a": 1, "enabled": "GL_TRUE"}, "GL_TEXTURE_3D": "GL_FALSE"});
        assert_eq!((&found["GL_TEXTURE1"], &found["b"]), (&unit, &Value::from(2)));
    }
}
