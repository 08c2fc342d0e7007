//! Values that each key of a mapping accepts.

use crate::mapping::MapKey;
use glam::DVec3;

/// Value of a mapping that stands for no value of the application.
pub(crate) const NONE: &str = "none";

/// Range of the coefficients of light, and of the channels of a colour.
const COEFFICIENT: [f64; 2] = [0.0, 1.0];

/// Range of the specular exponent.
const EXPONENT: [f64; 2] = [1.0, 1000.0];

impl MapKey {
    /// Describes the values that the key accepts.
    #[must_use]
    pub const fn accepted(self) -> &'static str {
        match self {
            Self::Position => "a vertex attribute",
            Self::Normal | Self::Tangent | Self::Color => "`none` or a vertex attribute of 3 or 4 numbers",
            Self::Uv => "`none` or a vertex attribute of 2 to 4 numbers",
            Self::Mvp => "a uniform that is a 4 x 4 matrix",
            Self::Albedo | Self::NormalMap | Self::HeightMap => "`none` or a sampler",
            Self::BaseColor => "`none`, three numbers from 0 to 1 such as 1:0.5:0, or a uniform of 3 or 4 numbers",
            Self::HeightScale => "a number",
            Self::NormalSpace => "`tangent` or `object`",
            Self::TangentSign => "1 or -1",
            Self::Light => "`none`, three numbers such as 1:2:3 that are not all 0, or a uniform of 3 or 4 numbers",
            Self::Viewer => "three numbers such as 1:2:3 that are not all 0",
            Self::Ambient | Self::Diffuse | Self::Specular => "`none`, a number from 0 to 1, or a uniform that is a number",
            Self::Shininess => "`none`, a number from 1 to 1000, or a uniform that is a number",
        }
    }

    /// Returns false for a value that the key accepts in no dump. Names are checked by the import of a draw call.
    pub(crate) fn accepts(self, value: &str) -> bool {
        let number = value.parse::<f64>().ok();
        let has_numbers = number.is_some() || value.contains(':');
        let within = |number: f64, [low, high]: [f64; 2]| (low..=high).contains(&number);
        let is_direction = || three(value).map(DVec3::from).and_then(DVec3::try_normalize).is_some();
        let is_color = || three(value).is_some_and(|numbers| numbers.iter().all(|channel| within(*channel, COEFFICIENT)));
        let is_number = |range| number.is_some_and(|number| within(number, range));
        match self {
            Self::Position | Self::Mvp => value != NONE,
            Self::HeightScale => number.is_some_and(f64::is_finite),
            Self::NormalSpace => matches!(value, "tangent" | "object"),
            Self::TangentSign => number.is_some_and(|number| number.abs() == 1.0),
            Self::Viewer => is_direction(),
            Self::Light => !has_numbers || is_direction(),
            Self::BaseColor => !has_numbers || is_color(),
            Self::Ambient | Self::Diffuse | Self::Specular => !has_numbers || is_number(COEFFICIENT),
            Self::Shininess => !has_numbers || is_number(EXPONENT),
            _ => true,
        }
    }

    /// Returns the number of the application within the range of the key.
    pub(crate) const fn clamped(self, number: f64) -> f64 {
        let [low, high] = if matches!(self, Self::Shininess) { EXPONENT } else { COEFFICIENT };
        number.clamp(low, high)
    }
}

/// Returns three numbers that are separated by colons.
pub(crate) fn three(value: &str) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = value.split(':').map(|number| number.trim().parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok().filter(|numbers: &[f64; 3]| numbers.iter().all(|number| number.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::MapEntry;

    #[test]
    fn numbers_are_separated_by_colons() {
        assert_eq!(three("1:-2.5: 3"), Some([1.0, -2.5, 3.0]));
        assert_eq!([three("1:2"), three("1:2:x"), three("1:2:inf")], [None; 3]);
    }

    #[test]
    fn value_that_no_dump_allows_is_an_error() {
        for wrong in [
            "viewer=none",
            "viewer=0:0:0",
            "viewer=eye",
            "normal-space=none",
            "position=none",
            "mvp=none",
            "light=20:20",
            "light=5",
            "light=0:0:0",
            "base-color=2:0:0",
            "ambient=nan",
            "specular=1:2:3",
            "shininess=-1",
            "height-scale=x",
            "7.tangent-sign=2",
            "tangent-sign=0",
        ] {
            let error = wrong.parse::<MapEntry>().unwrap_err();
            let key =
                MapKey::NAMES.iter().find(|(name, _)| wrong.trim_start_matches("7.").split('=').next() == Some(name)).unwrap().1;
            assert!(error.ends_with(&format!("; expected {}", key.accepted())), "{wrong}: {error}");
        }
    }

    #[test]
    fn value_that_a_dump_may_allow_is_accepted() {
        for right in ["light=none", "light=sun", "light=0:0:-1", "ambient=none", "ambient=1", "base-color=tint", "shininess=1000"]
        {
            assert!(right.parse::<MapEntry>().is_ok(), "{right}");
        }
        for right in ["height-scale=-2.5", "tangent-sign=-1", "viewer=1:2:3", "normal-space=object", "mvp=m", "uv=none"] {
            assert!(right.parse::<MapEntry>().is_ok(), "{right}");
        }
    }
}
