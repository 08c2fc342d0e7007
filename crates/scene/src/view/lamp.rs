//! Lights of a view, in double precision.

use crate::camera::turn;
use basrelief_signals::{Light, LightKind};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A light in double precision.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum LightSource {
    /// Unit direction towards it.
    Directional(DVec3),
    /// Place.
    Point(DVec3),
}

/// How far the light turns, where the user does not say.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum LightOrbit {
    /// Turned by this angle over all frames \[degrees\].
    Degrees(f64),
    /// With the camera: the model turns under a fixed light.
    WithCamera,
}

impl LightSource {
    /// Returns the light turned around the vertical axis through `centre`.
    pub(super) fn turned(self, degrees: f64, centre: DVec3) -> Self {
        match self {
            _ if degrees == 0.0 => self,
            Self::Directional(to_light) => Self::Directional(turn(degrees).transform_vector3(to_light)),
            Self::Point(place) => Self::Point(centre + turn(degrees).transform_vector3(place - centre)),
        }
    }

    /// Returns the light as a frame describes it.
    pub(super) fn light(self, intensity: f64) -> Light {
        let kind = match self {
            Self::Directional(to_light) => LightKind::Directional { to_light: to_light.as_vec3().to_array() },
            Self::Point(place) => LightKind::Point { position: place.as_vec3().to_array() },
        };
        Light { kind, intensity: intensity as f32 }
    }
}
