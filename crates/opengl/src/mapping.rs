//! `--map`: assigns names and values of an application to the properties of a scene.

use basrelief_scene::SceneError;
use std::fmt::{Display, Formatter, Result as FmtResult};
use std::str::FromStr;

/// A property of a draw call that a mapping can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapKey {
    /// Vertex attribute of positions.
    Position,
    /// Vertex attribute of normals.
    Normal,
    /// Vertex attribute of texture coordinates.
    Uv,
    /// Vertex attribute of tangents.
    Tangent,
    /// Vertex attribute of colours.
    Color,
    /// Uniform that is the matrix from object to clip space.
    Mvp,
    /// Sampler of the colour texture.
    Albedo,
    /// Uniform of the base colour, or three numbers.
    BaseColor,
    /// Sampler of the normal map.
    NormalMap,
    /// Sampler of a height map, which becomes a normal map.
    HeightMap,
    /// Height of 1.0 in a height map \[texels\].
    HeightScale,
    /// Space of the normal map: `tangent` or `object`.
    NormalSpace,
    /// Sign of the bitangent `cross(normal, tangent)`: 1 or -1.
    TangentSign,
    /// Uniform of the direction to the light, or three numbers.
    Light,
    /// Three numbers: the direction to the viewer.
    Viewer,
    /// Uniform or number: ambient coefficient.
    Ambient,
    /// Uniform or number: diffuse coefficient.
    Diffuse,
    /// Uniform or number: specular coefficient.
    Specular,
    /// Uniform or number: specular exponent.
    Shininess,
}

impl MapKey {
    /// All keys with their names.
    pub const NAMES: [(&'static str, Self); 19] = [
        ("position", Self::Position),
        ("normal", Self::Normal),
        ("uv", Self::Uv),
        ("tangent", Self::Tangent),
        ("color", Self::Color),
        ("mvp", Self::Mvp),
        ("albedo", Self::Albedo),
        ("base-color", Self::BaseColor),
        ("normal-map", Self::NormalMap),
        ("height-map", Self::HeightMap),
        ("height-scale", Self::HeightScale),
        ("normal-space", Self::NormalSpace),
        ("tangent-sign", Self::TangentSign),
        ("light", Self::Light),
        ("viewer", Self::Viewer),
        ("ambient", Self::Ambient),
        ("diffuse", Self::Diffuse),
        ("specular", Self::Specular),
        ("shininess", Self::Shininess),
    ];
}

impl Display for MapKey {
    fn fmt(&self, f: &mut Formatter<'_>) -> FmtResult {
        let name = Self::NAMES.iter().find(|(_, key)| key == self).map_or("", |(name, _)| name);
        f.pad(name)
    }
}

/// One assignment, for all draw calls or for one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapEntry {
    call: Option<u64>,
    key: MapKey,
    value: String,
}

impl FromStr for MapEntry {
    type Err = String;

    /// Parses `KEY=VALUE`, or `CALL.KEY=VALUE` for one draw call.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected KEY=VALUE or CALL.KEY=VALUE, such as normal-map=NormalMap".to_owned();
        let (key, value) = text.split_once('=').ok_or_else(expected)?;
        let (call, key) = match key.split_once('.') {
            Some((call, key)) => (Some(call.trim().parse().map_err(|_| expected())?), key),
            None => (None, key),
        };
        let found = MapKey::NAMES.iter().find(|(name, _)| *name == key.trim()).map(|(_, key)| *key);
        let names = || MapKey::NAMES.map(|(name, _)| name).join(", ");
        let key = found.ok_or_else(|| format!("`{}` is no key; expected one of {}", key.trim(), names()))?;
        let value = value.trim();
        if !key.accepts(value) {
            return Err(format!("`{value}` is no value of `{key}`; expected {}", key.accepted()));
        }
        Ok(Self { call, key, value: value.into() })
    }
}

impl Display for MapEntry {
    fn fmt(&self, f: &mut Formatter<'_>) -> FmtResult {
        if let Some(call) = self.call {
            write!(f, "{call}.")?;
        }
        write!(f, "{}={}", self.key, self.value)
    }
}

/// All assignments of a command. Later ones replace earlier ones, and those of one call replace those of all.
#[derive(Clone, Debug, Default)]
pub struct Mapping(pub Vec<MapEntry>);

impl Mapping {
    /// Checks that each assignment for one draw call concerns one of these.
    ///
    /// # Errors
    /// The first assignment for another draw call.
    pub(crate) fn check_calls(&self, calls: &[u64]) -> Result<(), SceneError> {
        let is_other = |entry: &&MapEntry| entry.call.is_some_and(|call| !calls.contains(&call));
        let Some(entry) = self.0.iter().find(is_other) else { return Ok(()) };
        let calls = calls.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
        Err(SceneError::at("", format!("--map {entry}: the draw call is not imported"))
            .expected(format!("one of the imported draw calls, {calls}"))
            .cure("call numbers differ from capture to capture"))
    }

    /// Returns the value for a draw call.
    pub(crate) fn get(&self, call: u64, key: MapKey) -> Option<&str> {
        let of = |wanted: Option<u64>| self.0.iter().rev().find(move |entry| entry.key == key && entry.call == wanted);
        of(Some(call)).or_else(|| of(None)).map(|entry| entry.value.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entry_of_a_call_replaces_that_of_all() {
        let entries = ["uv=a", "7.uv=b", "uv=c"].map(|text| text.parse().unwrap());
        let mapping = Mapping(entries.into());
        assert_eq!([7, 8].map(|call| mapping.get(call, MapKey::Uv)), [Some("b"), Some("c")]);
        assert_eq!(mapping.get(7, MapKey::Mvp), None);
    }

    #[test]
    fn mistakes_name_the_keys() {
        assert!("uvw=a".parse::<MapEntry>().unwrap_err().contains("`uvw` is no key; expected one of position, normal"));
        for wrong in ["uv", "x.uv=a", ".uv=a"] {
            assert!(wrong.parse::<MapEntry>().unwrap_err().starts_with("expected KEY=VALUE"), "{wrong}");
        }
    }
}
