//! Extras of this project in a glTF document.

use basrelief_signals::{Lighting, Object, ShadingSettings};
use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, Visitor};
use std::fmt::{Display, Formatter, Result as FmtResult};
use std::ops::RangeInclusive;

/// Content of `extras.basrelief` of a node, a material or a scene. Other extras belong to other programs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BasreliefExtras {
    /// Number of reference normals of the object.
    pub entries: Option<u32>,
    /// Levels by which its table and CLUT are coarser.
    pub bias: Option<u8>,
    /// Whether the object is a bump target.
    pub bump: Option<bool>,
    /// How the figure shading device shades the object, or a scene's frames.
    pub shading: ShadingSettings,
    /// Lighting coefficients of a material.
    pub lighting: Option<Lighting>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OwnExtras {
    entries: Option<u32>,
    bias: Option<u8>,
    bump: Option<bool>,
    #[serde(default)]
    shading: ShadingSettings,
    lighting: Option<Lighting>,
}

impl OwnExtras {
    /// Returns the name and the range of the first number out of range.
    fn fault(&self) -> Option<String> {
        fn outside<T: PartialOrd + Display>(name: &str, value: Option<T>, range: &RangeInclusive<T>) -> Option<String> {
            let value = value.filter(|value| !range.contains(value))?;
            Some(format!("`{name}` is {value}, expected {}..={}", range.start(), range.end()))
        }
        let shading = || {
            let (name, value) = self.shading.out_of_range()?;
            Some(format!("`shading.{name}` is {value}, expected 0..={}", ShadingSettings::MAX_INTENSITY))
        };
        (outside("entries", self.entries, &Object::ENTRIES))
            .or_else(|| outside("bias", self.bias, &Object::BIAS))
            .or_else(|| self.lighting.and_then(faulty_coefficient).map(str::to_owned))
            .or_else(shading)
    }
}

/// Returns the name and the range of the first coefficient out of range.
fn faulty_coefficient(Lighting { ka, kd, ks, n }: Lighting) -> Option<&'static str> {
    let shares =
        [("`lighting.ka` is not in 0..=1", ka), ("`lighting.kd` is not in 0..=1", kd), ("`lighting.ks` is not in 0..=1", ks)];
    let share = shares.into_iter().find(|(_, value)| !(0.0..=1.0).contains(value)).map(|(text, _)| text);
    share.or_else(|| (!(1.0..=1000.0).contains(&n)).then_some("`lighting.n` is not in 1..=1000"))
}

impl<'de> Deserialize<'de> for BasreliefExtras {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ExtrasVisitor)
    }
}

/// Extras may be of any type; only an object can hold ours.
struct ExtrasVisitor;

impl<'de> Visitor<'de> for ExtrasVisitor {
    type Value = BasreliefExtras;

    fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
        f.write_str("any value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<BasreliefExtras, A::Error> {
        let mut extras = BasreliefExtras::default();
        while let Some(key) = map.next_key::<String>()? {
            if key == "basrelief" {
                let own: OwnExtras = map.next_value()?;
                if let Some(fault) = own.fault() {
                    return Err(A::Error::custom(fault));
                }
                let OwnExtras { entries, bias, bump, shading, lighting } = own;
                extras = BasreliefExtras { entries, bias, bump, shading, lighting };
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(extras)
    }

    fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut list: A) -> Result<BasreliefExtras, A::Error> {
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(BasreliefExtras::default())
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<BasreliefExtras, E> {
        Ok(BasreliefExtras::default())
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<BasreliefExtras, E> {
        Ok(BasreliefExtras::default())
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<BasreliefExtras, E> {
        Ok(BasreliefExtras::default())
    }

    fn visit_f64<E: Error>(self, _: f64) -> Result<BasreliefExtras, E> {
        Ok(BasreliefExtras::default())
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<BasreliefExtras, E> {
        Ok(BasreliefExtras::default())
    }

    fn visit_unit<E: Error>(self) -> Result<BasreliefExtras, E> {
        Ok(BasreliefExtras::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::ShadingMode;

    #[test]
    fn extras_may_be_anything() {
        for other in ["1", "-1", "1.5", "\"x\"", "null", "[1, {}]", "true", "{\"a\": {}}"] {
            assert_eq!(serde_json::from_str::<BasreliefExtras>(other).unwrap(), BasreliefExtras::default(), "{other}");
        }
        let ours = serde_json::from_str::<BasreliefExtras>(r#"{"x": [], "basrelief": {"entries": 64, "bump": false}}"#).unwrap();
        assert_eq!(ours, BasreliefExtras { entries: Some(64), bump: Some(false), ..BasreliefExtras::default() });
        assert!(serde_json::from_str::<BasreliefExtras>(r#"{"basrelief": {"entires": 64}}"#).is_err());
    }

    #[test]
    fn entries_and_bias_out_of_range_are_errors() {
        let read = |ours: &str| serde_json::from_str::<BasreliefExtras>(&format!(r#"{{"basrelief": {ours}}}"#));
        assert!(read(r#"{"entries": 65536, "bias": 7}"#).is_ok() && read(r#"{"entries": 1, "bias": 0}"#).is_ok());
        for (wrong, message) in [
            (r#"{"entries": 0}"#, "`entries` is 0, expected 1..=65536"),
            (r#"{"entries": 65537}"#, "`entries` is 65537, expected 1..=65536"),
            (r#"{"bias": 8}"#, "`bias` is 8, expected 0..=7"),
        ] {
            let error = read(wrong).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }

    #[test]
    fn extras_set_lighting_of_material_within_range() {
        let read =
            |lighting: &str| serde_json::from_str::<BasreliefExtras>(&format!(r#"{{"basrelief": {{"lighting": {lighting}}}}}"#));
        let lighting = Lighting { ka: 0.1, kd: 0.5, ks: 0.0, n: 100.0 };
        let extras = BasreliefExtras { lighting: Some(lighting), ..BasreliefExtras::default() };
        assert_eq!(read(r#"{"ka": 0.1, "kd": 0.5, "ks": 0, "n": 100}"#).unwrap(), extras);
        for (wrong, named) in [
            (r#"{"ka": 0.1, "kd": 0.5, "ks": 0}"#, "missing field `n`"),
            (r#"{"ka": 0.1, "kd": 1.5, "ks": 0, "n": 2}"#, "lighting.kd"),
            (r#"{"ka": 0.1, "kd": 0.5, "ks": 0, "n": 0.5}"#, "lighting.n"),
        ] {
            let error = read(wrong).unwrap_err().to_string();
            assert!(error.contains(named), "{error}");
        }
    }

    #[test]
    fn extras_set_shading_of_object() {
        let read =
            |shading: &str| serde_json::from_str::<BasreliefExtras>(&format!(r#"{{"basrelief": {{"shading": {shading}}}}}"#));
        let shading = ShadingSettings { mode: Some(ShadingMode::Polyhedron), ia: None, is: Some(0.5) };
        assert_eq!(
            read(r#"{"mode": "polyhedron", "is": 0.5}"#).unwrap(),
            BasreliefExtras { shading, ..BasreliefExtras::default() }
        );
        for wrong in [r#"{"ia": 17}"#, r#"{"is": -1}"#, r#"{"mode": "flat"}"#, r#"{"n": 2}"#] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
