//! View options of the user.

use basrelief_signals::Camera;
#[cfg(doc)]
use basrelief_signals::MAX_PICTURE_PIXELS;
use std::ops::RangeInclusive;

/// Range of [zoom factors](ViewOptions::zoom).
pub const ZOOM: RangeInclusive<f64> = 0.01..=100.0;

/// One of several views. Missing options are those of the surrounding [`ViewOptions`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnView {
    /// As [`ViewOptions::camera`].
    pub camera: Option<Camera>,
    /// As [`ViewOptions::turn`].
    pub turn: Option<[f64; 2]>,
    /// As [`ViewOptions::zoom`].
    pub zoom: Option<f64>,
    /// How far the camera has turned by now around the vertical axis through the model's centre \[degrees\].
    pub orbit_degrees: Option<f64>,
    /// As [`ViewOptions::light`].
    pub light: Option<[f64; 3]>,
    /// How far the light has turned by now \[degrees\].
    pub light_orbit_degrees: Option<f64>,
}

/// View options of the user. The default leaves everything to the model.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewOptions {
    /// Width and height of the picture \[pixels\], each 1..=16384, together at most [`MAX_PICTURE_PIXELS`].
    pub size: [u32; 2],
    /// Replaces the camera and the lights of the model.
    pub camera: Option<Camera>,
    /// From where the camera looks, beside where it would otherwise: turned about the model's centre by an angle around the
    /// vertical axis, then by one upwards \[degrees\].
    pub turn: Option<[f64; 2]>,
    /// How much larger all is seen, around the middle of the picture, 0.01..=100.
    pub zoom: Option<f64>,
    /// The camera turns by this angle around the vertical axis through the model's centre, over all frames \[degrees\];
    /// `None` leaves it to the model.
    pub orbit_degrees: Option<f64>,
    /// Number of frames, 1..=1000000; `None` leaves it to the model.
    pub frames: Option<u32>,
    /// Direction to a light at infinity that replaces all others; need not have length 1.
    pub light: Option<[f64; 3]>,
    /// The light turns by this angle around the vertical axis, over all frames \[degrees\]; `None` leaves it to the
    /// model.
    pub light_orbit_degrees: Option<f64>,
    /// A frame for each of these views, in place of `frames` and of both orbits; may be empty.
    pub views: Vec<OwnView>,
}

impl ViewOptions {
    /// Returns these options with the fields of one view.
    pub(super) fn of(&self, own: &OwnView) -> Self {
        Self {
            size: self.size,
            camera: own.camera.or(self.camera),
            turn: own.turn.or(self.turn),
            zoom: own.zoom.or(self.zoom),
            orbit_degrees: own.orbit_degrees,
            frames: None,
            light: own.light.or(self.light),
            light_orbit_degrees: own.light_orbit_degrees,
            views: vec![],
        }
    }
}

impl Default for ViewOptions {
    fn default() -> Self {
        let (camera, turn, zoom, orbit_degrees, frames) = (None, None, None, None, None);
        let (light, light_orbit_degrees, views) = (None, None, vec![]);
        Self { size: [640, 480], camera, turn, zoom, orbit_degrees, frames, light, light_orbit_degrees, views }
    }
}
