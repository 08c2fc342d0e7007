//! Cameras: a model's own, one that frames the model, and camera files.

use crate::SceneError;
use crate::gltf::parse::json_error;
use basrelief_signals::Camera;
use glam::{DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};

/// View of the automatic camera: azimuth from +z towards +x, elevation, vertical field of view \[degrees\].
pub(crate) const AUTO_VIEW: [f64; 3] = [30.0, 20.0, 35.0];

const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// Box around a model in the world, sides parallel to the axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WorldBounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl WorldBounds {
    /// Returns the box around these points, or an empty box at the origin if there are none.
    pub(crate) fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let low_high = points.fold(None, |bounds: Option<(DVec3, DVec3)>, p| {
            let (low, high) = bounds.unwrap_or((p, p));
            Some((low.min(p), high.max(p)))
        });
        let (low, high) = low_high.unwrap_or_default();
        Self { low, high }
    }

    pub(crate) fn centre(&self) -> DVec3 {
        (self.low + self.high) / 2.0
    }

    /// Diagonal; 2 for a single point.
    pub(crate) fn size(&self) -> f64 {
        2.0 * self.radius()
    }

    /// Half the diagonal; 1 for a single point, so that it can be looked at.
    fn radius(&self) -> f64 {
        let radius = (self.high - self.low).length() / 2.0;
        if radius > 0.0 { radius } else { 1.0 }
    }
}

/// Projection of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Projection {
    /// Vertical field of view \[radians\], distances of the planes; `far` may be infinite.
    Perspective { field: f64, near: f64, far: f64 },
    /// Half the height of the view, distances of the planes.
    Orthographic { half_height: f64, near: f64, far: f64 },
}

impl Projection {
    /// Clip from view coordinates, OpenGL depth range.
    fn projection(self, aspect: f64) -> DMat4 {
        let rows = match self {
            Self::Perspective { field, near, far } => {
                let s = 1.0 / libm::tan(field / 2.0);
                let (a, b) = if far.is_finite() {
                    ((far + near) / (near - far), 2.0 * far * near / (near - far))
                } else {
                    (-1.0, -2.0 * near)
                };
                [[s / aspect, 0., 0., 0.], [0., s, 0., 0.], [0., 0., a, b], [0., 0., -1., 0.]]
            }
            Self::Orthographic { half_height: h, near, far } => [
                [1.0 / (h * aspect), 0., 0., 0.],
                [0., 1.0 / h, 0., 0.],
                [0., 0., 2.0 / (near - far), (far + near) / (near - far)],
                [0., 0., 0., 1.],
            ],
        };
        DMat4::from_cols_array_2d(&rows).transpose()
    }
}

/// A camera in the world, not yet bound to a picture's size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Viewpoint {
    pub eye: DVec3,
    /// Unit vectors to the right, up, and back towards the viewer.
    pub axes: [DVec3; 3],
    pub lens: Projection,
}

/// A view-projection matrix and the direction to the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub view_projection: DMat4,
    pub to_viewer: DVec3,
}

impl Viewpoint {
    /// A camera at `eye` whose view axis goes through `target`, upright; `None` where it would look straight up or down.
    pub(crate) fn looking_at(eye: DVec3, target: DVec3, lens: Projection) -> Option<Self> {
        let back = (eye - target).try_normalize()?;
        let right = DVec3::Y.cross(back).try_normalize()?;
        Some(Self { eye, axes: [right, back.cross(right), back], lens })
    }

    /// A camera placed by a node; glTF ignores the node's scale. A mirrored camera keeps its axes up and back.
    pub(crate) fn placed(world: DMat4, lens: Projection) -> Option<Self> {
        let back = world.z_axis.truncate().try_normalize()?;
        let x = world.x_axis.truncate();
        let right = (x - back * back.dot(x)).try_normalize()?;
        let is_mirrored = back.cross(right).dot(world.y_axis.truncate()) < 0.0;
        let right = if is_mirrored { -right } else { right };
        Some(Self { eye: world.w_axis.truncate(), axes: [right, back.cross(right), back], lens })
    }

    /// A camera that frames the box.
    pub(crate) fn framing(bounds: &WorldBounds, [azimuth, elevation, field]: [f64; 3]) -> Self {
        let (a, e, field) = (azimuth * RADIANS, elevation * RADIANS, field * RADIANS);
        let back = DVec3::new(libm::sin(a) * libm::cos(e), libm::sin(e), libm::cos(a) * libm::cos(e));
        let radius = bounds.radius();
        let distance = radius / libm::sin(field / 2.0) * 1.02;
        let near = (distance - radius * 1.05).max(distance * 0.01);
        let lens = Projection::Perspective { field, near, far: distance + radius * 1.05 };
        let right = DVec3::Y.cross(back).normalize_or(DVec3::X);
        Self { eye: bounds.centre() + back * distance, axes: [right, back.cross(right), back], lens }
    }

    /// The view of a picture with this ratio of width to height. The viewer at infinity stands in the direction of the
    /// eye as seen from the model's centre, or along the view axis of an orthographic camera.
    pub(crate) fn view(&self, aspect: f64, centre: DVec3) -> View {
        let [right, up, back] = self.axes;
        let row = |axis: DVec3| axis.extend(-axis.dot(self.eye));
        let world_to_view = DMat4::from_cols(row(right), row(up), row(back), DVec4::W).transpose();
        let to_viewer = match self.lens {
            Projection::Perspective { .. } => (self.eye - centre).normalize_or(back),
            Projection::Orthographic { .. } => back,
        };
        View { view_projection: self.lens.projection(aspect) * world_to_view, to_viewer }
    }
}

/// Rotation around the vertical axis that brings +z towards +x.
pub(crate) fn turn(degrees: f64) -> DMat4 {
    let angle = degrees % 360.0 * RADIANS;
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let rows = [[cos, 0., sin, 0.], [0., 1., 0., 0.], [-sin, 0., cos, 0.], [0., 0., 0., 1.]];
    DMat4::from_cols_array_2d(&rows).transpose()
}

/// Rotation around an axis of length 1, counter-clockwise as seen from its tip.
pub(crate) fn turn_around(axis: DVec3, degrees: f64) -> DMat4 {
    let angle = degrees % 360.0 * RADIANS;
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let turned = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|v| turned(v).extend(0.0));
    DMat4::from_cols(x, y, z, DVec4::W)
}

/// Row-major, as in [`Camera`].
pub(crate) fn rows(matrix: DMat4) -> [f64; 16] {
    matrix.transpose().to_cols_array()
}

/// Reads a camera file: a JSON object with the keys `view_projection` (16 numbers, row-major, clip = M \[x y z 1\]^T),
/// `to_light` and `to_viewer` (directions in world space; they need not have length 1). `file` is for messages.
///
/// # Errors
/// Not JSON, a key missing, unknown or of the wrong type, a matrix that flattens space, a direction of length 0.
pub fn read_camera(text: &str, file: &str) -> Result<Camera, SceneError> {
    let camera: Camera = basrelief_input::from_str(text).map_err(|e| {
        json_error(&e).in_file(file).expected("{\"view_projection\": [16 numbers], \"to_light\": [3], \"to_viewer\": [3]}")
    })?;
    check_camera(&camera).map_err(|e| e.in_file(file))
}

/// A camera file that [`read_camera`] reads back to the bit.
pub fn write_camera(camera: &Camera) -> String {
    // Plain numbers always serialize.
    serde_json::to_string_pretty(camera).unwrap_or_default() + "\n"
}

/// Checks the numbers of a camera and makes its directions unit.
pub(crate) fn check_camera(camera: &Camera) -> Result<Camera, SceneError> {
    let determinant = DMat4::from_cols_array(&camera.view_projection).determinant();
    if !(determinant.is_finite() && determinant != 0.0) {
        return Err(SceneError::at("/view_projection", format!("matrix of determinant {determinant}"))
            .expected("16 finite numbers that do not flatten space")
            .cure("write it row by row: clip = M [x y z 1]^T"));
    }
    Ok(Camera {
        view_projection: camera.view_projection,
        to_light: direction(camera.to_light, "/to_light")?.to_array(),
        to_viewer: direction(camera.to_viewer, "/to_viewer")?.to_array(),
    })
}

/// A unit vector; one that is unit already stays as it is, to the bit.
pub(crate) fn direction(v: [f64; 3], place: &str) -> Result<DVec3, SceneError> {
    let vector = DVec3::from_array(v);
    if (vector.length_squared() - 1.0).abs() <= 4.0 * f64::EPSILON {
        return Ok(vector);
    }
    vector.try_normalize().ok_or_else(|| {
        SceneError::at(place, format!("{v:?} is no direction")).expected("three finite numbers of ordinary size, not all 0")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit_box() -> WorldBounds {
        WorldBounds { low: DVec3::splat(-1.0), high: DVec3::splat(1.0) }
    }

    /// Numbers that an independent implementation of the same recipe gave for a cube of side 2, 640 x 480.
    #[test]
    fn automatic_camera_has_expected_position() {
        let view = Viewpoint::framing(&unit_box(), AUTO_VIEW).view(640.0 / 480.0, DVec3::ZERO);
        #[rustfmt::skip]
        let expected = [
            2.0600112520179215, 0.0, -1.1893480508862047, 0.0,
            -0.5423746544376059, 2.9803242319036527, -0.9394204582235463, 0.0,
            -1.5178361403353204, -1.10489435115111, -2.62896931262502, 1.8186533479473255,
            -0.46984631039295416, -0.3420201433256687, -0.8137976813493738, 5.87515048473533,
        ];
        for (got, expected) in rows(view.view_projection).into_iter().zip(expected) {
            assert!((got - expected).abs() < 1e-14, "{got} {expected}");
        }
        let to_viewer = DVec3::new(0.46984631039295416, 0.3420201433256687, 0.8137976813493738);
        assert!((view.to_viewer - to_viewer).length() < 1e-15);
    }

    #[test]
    fn depth_runs_from_minus_one_near_to_one_far() {
        let depth = |lens: Projection, z: f64| {
            let clip = lens.projection(1.5) * DVec4::new(0.0, 0.0, -z, 1.0);
            clip.z / clip.w
        };
        let perspective = Projection::Perspective { field: 1.0, near: 0.5, far: 20.0 };
        let orthographic = Projection::Orthographic { half_height: 2.0, near: 0.5, far: 20.0 };
        for lens in [perspective, orthographic] {
            assert!((depth(lens, 0.5) + 1.0).abs() < 1e-12 && (depth(lens, 20.0) - 1.0).abs() < 1e-12);
        }
        let endless = Projection::Perspective { field: 1.0, near: 0.5, far: f64::INFINITY };
        assert!((depth(endless, 0.5) + 1.0).abs() < 1e-12 && (depth(endless, 1e12) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn mirrored_camera_keeps_its_axes_up_and_back() {
        let lens = Projection::Perspective { field: 1.0, near: 0.5, far: 20.0 };
        let node = DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0)) * turn(30.0);
        for mirror in [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, 1.0, -1.0)] {
            let world = DMat4::from_scale(mirror) * node;
            let [right, up, back] = Viewpoint::placed(world, lens).unwrap().axes;
            assert!((up - DVec3::Y).length() < 1e-15 && (back - world.z_axis.truncate()).length() < 1e-15, "{mirror}");
            assert!((right.cross(up) - back).length() < 1e-15, "{mirror}");
        }
    }

    #[test]
    fn single_point_can_be_viewed() {
        let bounds = WorldBounds::around(std::iter::once(DVec3::splat(5.0)));
        let view = Viewpoint::framing(&bounds, AUTO_VIEW).view(1.0, bounds.centre());
        assert!(view.view_projection.is_finite());
    }

    #[test]
    fn mistakes_in_camera_files_are_named() {
        let says = |text: &str, part: &str| {
            let e = read_camera(text, "cam.json").unwrap_err().to_string();
            assert!(e.starts_with("cam.json: ") && e.contains(part), "{e}");
        };
        let file = |m: &str, l: &str| format!("{{\"view_projection\": [{m}], \"to_light\": [{l}], \"to_viewer\": [0, 0, 2]}}");
        let identity = "1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1";
        assert_eq!(read_camera(&file(identity, "3,0,0"), "c").unwrap().to_light, [1.0, 0.0, 0.0]);
        says(&file("1,2,3", "1,0,0"), "/view_projection");
        says(&file(&["0"; 16].join(","), "1,0,0"), "determinant 0");
        says(&file(identity, "0,0,0"), "/to_light: [0.0, 0.0, 0.0] is no direction");
        says(&file(identity, "1e300,1e300,1e300"), "is no direction; expected three finite numbers of ordinary size, not all 0");
        says(&file(identity, "1e400,0,0"), "number out of range");
        says("{\"viewproj\": []}", "unknown field `viewproj`");
        says("{}", "missing field `view_projection`");
        says(&format!("[[{identity}], [1,0,0], [0,0,1]]"), "a list stands here, expected an object");
        says("", "not valid JSON");
        says(&(file(identity, "1,0,0") + "x"), "trailing");
    }

    proptest! {
        #[test]
        fn written_camera_reads_back_to_the_bit(
            m in prop::array::uniform16(0.1f64..10.0), l in prop::array::uniform3(0.1f64..1.0), v in prop::array::uniform3(0.1f64..1.0)
        ) {
            let unit = |d: [f64; 3]| DVec3::from_array(d).normalize().to_array();
            let camera = Camera { view_projection: m, to_light: unit(l), to_viewer: unit(v) };
            prop_assume!(DMat4::from_cols_array(&m).determinant() != 0.0);
            prop_assert_eq!(read_camera(&write_camera(&camera), "c").unwrap(), camera);
        }
    }
}
