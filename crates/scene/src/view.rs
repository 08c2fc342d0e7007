//! Frames of a scene from the view options of the user and the hints of the model.

use crate::SceneError;
use crate::camera::{AUTO_VIEW, View, Viewpoint, WorldBounds, check_camera, direction, rows, turn, turn_around};
use basrelief_signals::{Camera, Frame, Light, LightKind, MAX_PICTURE_PIXELS, ShadingSettings};
use glam::{DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Default direction to the light (assumed); normalised.
const DEFAULT_LIGHT: [f64; 3] = [0.4, 0.8, 0.45];

/// Maximum number of pixels per side: coordinates of fragments have 16 bits, and a frame buffer must fit in memory.
const MAX_SIDE: u32 = 16_384;

/// Range of [zoom factors](ViewOptions::zoom).
pub const ZOOM: RangeInclusive<f64> = 0.01..=100.0;

/// Maximum number of frames of one scene.
pub(crate) const MAX_FRAMES: u32 = 1_000_000;

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

impl OwnView {
    /// Checks that all options are in range for any model.
    ///
    /// # Errors
    /// An option out of range, with its place among the views.
    pub fn check(views: &[Self]) -> Result<(), SceneError> {
        let nothing = WorldBounds { low: DVec3::ZERO, high: DVec3::ZERO };
        let options = ViewOptions { size: [1; 2], views: views.to_vec(), ..ViewOptions::default() };
        ViewHints::still(nothing, None, vec![]).frames(&options).map(drop)
    }
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
    fn of(&self, own: &OwnView) -> Self {
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

/// A view, and the lights with their intensities.
type ResolvedView = (View, Vec<(LightSource, f64)>);

/// View hints of a model or a demo.
pub(crate) struct ViewHints {
    /// Around all vertices, in the world.
    pub bounds: WorldBounds,
    /// The model's camera.
    pub camera: Option<Viewpoint>,
    /// The model's lights, with their intensities.
    pub lamps: Vec<(LightSource, f64)>,
    /// Frames, where the user does not say.
    pub frames: u32,
    /// Orbit of the camera over all frames \[degrees\], where the user does not say.
    pub orbit: f64,
    /// Orbit of the light, where the user does not say.
    pub light_orbit: LightOrbit,
    /// How the figure shading device shades the frames.
    pub shading: ShadingSettings,
}

impl ViewHints {
    /// The hints of a model without animation.
    pub(crate) fn still(bounds: WorldBounds, camera: Option<Viewpoint>, lamps: Vec<(LightSource, f64)>) -> Self {
        Self {
            bounds,
            camera,
            lamps,
            frames: 1,
            orbit: 0.0,
            light_orbit: LightOrbit::Degrees(0.0),
            shading: ShadingSettings::default(),
        }
    }

    /// All frames, in order.
    pub(crate) fn frames(&self, options: &ViewOptions) -> Result<Vec<Arc<Frame>>, SceneError> {
        let [width, height] = options.size;
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(SceneError::at("size", format!("{width}x{height}")).expected(format!("1..={MAX_SIDE} pixels per side")));
        }
        if u64::from(width) * u64::from(height) > MAX_PICTURE_PIXELS {
            let expected = format!("at most {MAX_PICTURE_PIXELS} pixels");
            return Err(SceneError::at("size", format!("{width}x{height}")).expected(expected));
        }
        let frame = |(index, (view, lamps)): (u32, ResolvedView)| {
            Arc::new(Frame {
                index,
                width,
                height,
                camera: self.camera(view, &lamps),
                lights: lights(&lamps),
                textures: Vec::new(),
                shading: self.shading,
            })
        };
        if options.views.is_empty() { self.along_orbits(options, frame) } else { self.each_view(options, frame) }
    }

    /// Number of frames of these options.
    pub(crate) fn count(&self, options: &ViewOptions) -> usize {
        if options.views.is_empty() { options.frames.unwrap_or(self.frames) as usize } else { options.views.len() }
    }

    /// Frame k of n has turned by k n-ths.
    fn along_orbits(
        &self,
        options: &ViewOptions,
        frame: impl Fn((u32, ResolvedView)) -> Arc<Frame>,
    ) -> Result<Vec<Arc<Frame>>, SceneError> {
        let count = options.frames.unwrap_or(self.frames);
        if !(1..=MAX_FRAMES).contains(&count) {
            return Err(SceneError::at("frames", count.to_string()).expected(format!("1..={MAX_FRAMES}")));
        }
        let (first, turns) = (self.first(options)?, self.turns(options, 1.0)?);
        check_orbits(options, count)?;
        let part = |index| f64::from(index) / f64::from(count);
        Ok((0..count).map(|index| frame((index, self.turned_on(&first, turns.map(|by| part(index) * by))))).collect())
    }

    /// Returns a frame for each listed view.
    fn each_view(
        &self,
        options: &ViewOptions,
        frame: impl Fn((u32, ResolvedView)) -> Arc<Frame>,
    ) -> Result<Vec<Arc<Frame>>, SceneError> {
        if options.views.len() > MAX_FRAMES as usize {
            return Err(SceneError::at("/views", options.views.len().to_string()).expected(format!("1..={MAX_FRAMES}")));
        }
        let seen = |(index, own): (u32, &OwnView)| -> Result<Arc<Frame>, SceneError> {
            let options = options.of(own);
            let seen = self.first(&options).and_then(|first| Ok(self.turned_on(&first, self.turns(&options, 0.0)?)));
            seen.map(|seen| frame((index, seen))).map_err(|e| e.below(&format!("/views/{index}")))
        };
        (0..).zip(&options.views).map(seen).collect()
    }

    /// View and lights before anything turns.
    fn first(&self, options: &ViewOptions) -> Result<ResolvedView, SceneError> {
        Ok((self.zoom(self.turn(self.first_view(options)?, options)?, options)?, self.first_lamps(options)?))
    }

    /// Angles of camera and light: those of the options, or `share` of the model's own orbits.
    fn turns(&self, options: &ViewOptions, share: f64) -> Result<[f64; 2], SceneError> {
        let orbit = finite(options.orbit_degrees.unwrap_or(share * self.orbit), "orbit")?;
        let own_light_orbit = match self.light_orbit {
            LightOrbit::Degrees(degrees) => share * degrees,
            LightOrbit::WithCamera => orbit,
        };
        Ok([orbit, finite(options.light_orbit_degrees.unwrap_or(own_light_orbit), "light_orbit")?])
    }

    /// Returns the view and the lights after these turns.
    fn turned_on(&self, (view, lamps): &ResolvedView, [orbit, light_orbit]: [f64; 2]) -> ResolvedView {
        (self.orbit(*view, orbit), lamps.iter().map(|(lamp, i)| (self.turn_lamp(*lamp, light_orbit), *i)).collect())
    }

    fn first_view(&self, options: &ViewOptions) -> Result<View, SceneError> {
        if let Some(camera) = &options.camera {
            let camera = check_camera(camera).map_err(|e| e.below("/camera"))?;
            let view_projection = DMat4::from_cols_array(&camera.view_projection).transpose();
            return Ok(View { view_projection, to_viewer: DVec3::from_array(camera.to_viewer) });
        }
        let [width, height] = options.size.map(f64::from);
        let viewpoint = self.camera.unwrap_or_else(|| Viewpoint::framing(&self.bounds, AUTO_VIEW));
        Ok(viewpoint.view(width / height, self.bounds.centre()))
    }

    fn first_lamps(&self, options: &ViewOptions) -> Result<Vec<(LightSource, f64)>, SceneError> {
        if let Some(light) = options.light {
            return Ok(vec![(LightSource::Directional(direction(light, "light")?), 1.0)]);
        }
        if let Some(camera) = &options.camera {
            return Ok(vec![(LightSource::Directional(direction(camera.to_light, "/camera/to_light")?), 1.0)]);
        }
        if self.lamps.is_empty() {
            return Ok(vec![(LightSource::Directional(direction(DEFAULT_LIGHT, "light")?), 1.0)]);
        }
        Ok(self.lamps.clone())
    }

    /// The camera turned around the vertical axis through the centre.
    fn orbit(&self, view: View, degrees: f64) -> View {
        if degrees == 0.0 { view } else { self.turned(view, turn(degrees)) }
    }

    /// The camera turned about the centre: the world turned the other way.
    fn turned(&self, view: View, turn: DMat4) -> View {
        let centre = self.bounds.centre();
        let world = DMat4::from_translation(centre) * turn.transpose() * DMat4::from_translation(-centre);
        View { view_projection: view.view_projection * world, to_viewer: turn.transform_vector3(view.to_viewer) }
    }

    fn turn(&self, view: View, options: &ViewOptions) -> Result<View, SceneError> {
        let Some([around, up]) = options.turn else { return Ok(view) };
        let view = self.orbit(view, finite(around, "turn")?);
        let right = DVec3::Y.cross(view.to_viewer).normalize_or(DVec3::X);
        Ok(self.turned(view, turn_around(right, -finite(up, "turn")?)))
    }

    fn zoom(&self, view: View, options: &ViewOptions) -> Result<View, SceneError> {
        let Some(zoom) = options.zoom else { return Ok(view) };
        if !ZOOM.contains(&zoom) {
            let expected = format!("a number from {} to {}", ZOOM.start(), ZOOM.end());
            return Err(SceneError::at("zoom", zoom.to_string()).expected(expected));
        }
        let larger = DMat4::from_diagonal(DVec4::new(zoom, zoom, 1.0, 1.0));
        Ok(View { view_projection: larger * view.view_projection, ..view })
    }

    fn turn_lamp(&self, lamp: LightSource, degrees: f64) -> LightSource {
        let centre = self.bounds.centre();
        match lamp {
            _ if degrees == 0.0 => lamp,
            LightSource::Directional(to_light) => LightSource::Directional(turn(degrees).transform_vector3(to_light)),
            LightSource::Point(p) => LightSource::Point(centre + turn(degrees).transform_vector3(p - centre)),
        }
    }

    /// The view as reported; a point light is seen from the model's centre.
    fn camera(&self, view: View, lamps: &[(LightSource, f64)]) -> Camera {
        let to_light = match lamps.first() {
            Some((LightSource::Directional(to_light), _)) => *to_light,
            Some((LightSource::Point(p), _)) => (*p - self.bounds.centre()).normalize_or(DVec3::Y),
            None => DVec3::Y,
        };
        Camera {
            view_projection: rows(view.view_projection),
            to_light: to_light.to_array(),
            to_viewer: view.to_viewer.to_array(),
        }
    }
}

/// Refuses an orbit of the user over a single frame, which would show nothing of it.
fn check_orbits(options: &ViewOptions, frames: u32) -> Result<(), SceneError> {
    let orbits = [("orbit", options.orbit_degrees), ("light_orbit", options.light_orbit_degrees)];
    let given = orbits.into_iter().find_map(|(name, degrees)| Some((name, degrees.filter(|degrees| *degrees != 0.0)?)));
    match given {
        Some((name, degrees)) if frames == 1 => Err(SceneError::at(name, degrees.to_string())
            .expected("0 with a single frame, since frame 0 is not turned")
            .cure("set `frames` to 2 or more, or use `turn`")),
        _ => Ok(()),
    }
}

fn finite(degrees: f64, name: &str) -> Result<f64, SceneError> {
    if degrees.is_finite() {
        Ok(degrees)
    } else {
        Err(SceneError::at(name, degrees.to_string()).expected("a finite angle in degrees"))
    }
}

fn lights(lamps: &[(LightSource, f64)]) -> Vec<Light> {
    let kind = |lamp: LightSource| match lamp {
        LightSource::Directional(to_light) => LightKind::Directional { to_light: to_light.as_vec3().to_array() },
        LightSource::Point(position) => LightKind::Point { position: position.as_vec3().to_array() },
    };
    lamps.iter().map(|(lamp, intensity)| Light { kind: kind(*lamp), intensity: *intensity as f32 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;

    fn hints(lamps: Vec<(LightSource, f64)>) -> ViewHints {
        ViewHints::still(WorldBounds { low: DVec3::new(1., 0., 0.), high: DVec3::new(3., 2., 2.) }, None, lamps)
    }

    #[test]
    fn frame_k_of_n_turns_by_k_nths_of_the_angle() {
        let options = ViewOptions { orbit_degrees: Some(360.0), frames: Some(4), ..ViewOptions::default() };
        let frames = hints(vec![]).frames(&options).unwrap();
        let azimuth = |f: &Frame| libm::atan2(f.camera.to_viewer[0], f.camera.to_viewer[2]).to_degrees();
        for (k, frame) in frames.iter().enumerate() {
            let expected = [30.0, 120.0, -150.0, -60.0][k];
            assert!((azimuth(frame) - expected).abs() < 1e-9, "{}", azimuth(frame));
            let centre = DMat4::from_cols_array(&frame.camera.view_projection).transpose() * DVec4::new(2., 1., 1., 1.);
            assert!(centre.x.abs() < 1e-9 && centre.y.abs() < 1e-9, "the centre stays in the middle");
        }
        // Looking from the other side mirrors left and right of the model.
        let x = |f: &Frame| (DMat4::from_cols_array(&f.camera.view_projection).transpose() * DVec4::new(3., 1., 1., 1.)).x;
        assert!((x(&frames[0]) + x(&frames[2])).abs() < 1e-9);
    }

    #[test]
    fn camera_turns_around_and_then_up() {
        let seen = |around, up| {
            let options = ViewOptions { turn: Some([around, up]), ..ViewOptions::default() };
            let [x, y, z] = hints(vec![]).frames(&options).unwrap()[0].camera.to_viewer;
            [libm::atan2(x, z).to_degrees(), libm::asin(y).to_degrees()]
        };
        for (around, up) in [(0.0, 0.0), (50.0, 0.0), (0.0, 30.0), (-75.0, 40.0), (90.0, -60.0)] {
            let [azimuth, elevation] = seen(around, up);
            assert!((azimuth - 30.0 - around).abs() < 1e-9 && (elevation - 20.0 - up).abs() < 1e-9, "{azimuth} {elevation}");
        }
    }

    #[test]
    fn zoom_keeps_the_centre_of_the_picture() {
        let place = |zoom, point: DVec3| {
            let options = ViewOptions { zoom, ..ViewOptions::default() };
            let camera = hints(vec![]).frames(&options).unwrap()[0].camera;
            let clip = DMat4::from_cols_array(&camera.view_projection).transpose() * point.extend(1.0);
            [clip.x / clip.w, clip.y / clip.w, clip.z / clip.w]
        };
        let corner = DVec3::new(3.0, 0.5, 0.0);
        let ([x, y, z], near) = (place(None, corner), place(Some(2.0), corner));
        assert_eq!(near, [2.0 * x, 2.0 * y, z]);
        assert!(place(Some(2.0), DVec3::new(2.0, 1.0, 1.0))[0].abs() < 1e-12);
    }

    #[test]
    fn light_turns_with_its_own_orbit() {
        let options = ViewOptions {
            light: Some([0., 0., 5.]),
            light_orbit_degrees: Some(180.0),
            frames: Some(2),
            ..ViewOptions::default()
        };
        let frames = hints(vec![]).frames(&options).unwrap();
        assert_eq!(frames[0].camera.to_light, [0., 0., 1.]);
        let turned = DVec3::from_array(frames[1].camera.to_light);
        assert!((turned - DVec3::X).length() < 1e-12, "{turned:?}");
        assert_eq!(frames[0].camera.view_projection, frames[1].camera.view_projection);
    }

    // Claim: defer, views: A file of views gives the frames of equal command-line options. An error names its place.
    #[test]
    fn own_views_equal_the_same_options() {
        let turning = ViewHints { frames: 4, orbit: 360.0, light_orbit: LightOrbit::WithCamera, ..hints(vec![]) };
        let own = |orbit_degrees| OwnView { orbit_degrees, ..OwnView::default() };
        let lit = OwnView { light: Some([0., 0., 2.]), light_orbit_degrees: Some(90.0), zoom: Some(2.0), ..own(None) };
        let options = ViewOptions { turn: Some([10.0, 5.0]), ..ViewOptions::default() };
        let views = vec![own(None), own(Some(90.0)), own(Some(180.0)), own(Some(270.0)), lit];
        let seen = turning.frames(&ViewOptions { views, frames: Some(9), orbit_degrees: Some(1.0), ..options.clone() }).unwrap();
        assert_eq!(seen.len(), 5);
        assert_eq!(seen[..4], turning.frames(&options).unwrap(), "the model's orbit, step by step");
        let to_light = DVec3::from_array(seen[4].camera.to_light);
        assert!((to_light - DVec3::X).length() < 1e-12, "{to_light:?}");
        let larger = turning.frames(&ViewOptions { zoom: Some(2.0), frames: Some(1), ..options }).unwrap();
        assert_eq!(seen[4].camera.view_projection, larger[0].camera.view_projection);
    }

    #[test]
    fn invalid_view_is_named_by_its_place() {
        let refused = |own: OwnView| OwnView::check(&[OwnView::default(), own]).unwrap_err().to_string();
        let d = OwnView::default;
        assert!(refused(OwnView { zoom: Some(0.0), ..d() }).starts_with("/views/1/zoom: 0; expected a number from 0.01 to 100"));
        assert!(refused(OwnView { turn: Some([0.0, f64::NAN]), ..d() }).starts_with("/views/1/turn: NaN; expected"));
        assert!(refused(OwnView { orbit_degrees: Some(f64::INFINITY), ..d() }).starts_with("/views/1/orbit: inf; expected"));
        assert!(refused(OwnView { light: Some([0.0; 3]), ..d() }).starts_with("/views/1/light: "));
        let flat = Camera { view_projection: [0.0; 16], to_light: [1., 0., 0.], to_viewer: [0., 0., 1.] };
        assert!(refused(OwnView { camera: Some(flat), ..d() }).starts_with("/views/1/camera/view_projection: "));
        assert!(OwnView::check(&[d()]).is_ok());
    }

    #[test]
    fn light_follows_orbiting_camera() {
        let turning = ViewHints { frames: 4, orbit: 360.0, light_orbit: LightOrbit::WithCamera, ..hints(vec![]) };
        let seen_by_the_camera = |options: ViewOptions| {
            let frames = turning.frames(&options).unwrap();
            let angle = |v: [f64; 3]| libm::atan2(v[0], v[2]).to_degrees();
            frames.iter().map(|f| (angle(f.camera.to_light) - angle(f.camera.to_viewer)).rem_euclid(360.0).round()).collect()
        };
        let own: Vec<f64> = seen_by_the_camera(ViewOptions::default());
        assert_eq!(own, [own[0]; 4]);
        assert_eq!(seen_by_the_camera(ViewOptions { orbit_degrees: Some(90.0), ..ViewOptions::default() }), own);
        let standing: Vec<f64> = seen_by_the_camera(ViewOptions { light_orbit_degrees: Some(0.0), ..ViewOptions::default() });
        assert_ne!(standing[1], own[1]);
    }

    #[test]
    fn light_option_precedes_camera_file_and_model() {
        let camera = Camera { view_projection: rows(DMat4::IDENTITY), to_light: [1., 0., 0.], to_viewer: [0., 0., 1.] };
        let lamps = vec![(LightSource::Point(DVec3::new(2., 11., 1.)), 0.5), (LightSource::Directional(DVec3::Z), 1.0)];
        let first = |options: ViewOptions| hints(lamps.clone()).frames(&options).unwrap()[0].clone();
        let own = first(ViewOptions::default());
        assert_eq!((own.lights.len(), own.camera.to_light), (2, [0., 1., 0.]));
        let file = ViewOptions { camera: Some(camera), ..ViewOptions::default() };
        assert_eq!(first(file.clone()).camera, camera);
        let user = first(ViewOptions { light: Some([0., -2., 0.]), ..file });
        assert_eq!((user.lights.len(), user.camera.to_light), (1, [0., -1., 0.]));
    }

    #[test]
    fn options_out_of_range_are_refused() {
        let refuses = |options: ViewOptions| hints(vec![]).frames(&options).unwrap_err();
        let d = ViewOptions::default;
        refuses(ViewOptions { size: [0, 4], ..d() });
        refuses(ViewOptions { size: [4, 100_000], ..d() });
        refuses(ViewOptions { turn: Some([0.0, f64::NAN]), ..d() });
        refuses(ViewOptions { zoom: Some(0.0), ..d() });
        refuses(ViewOptions { zoom: Some(f64::NAN), ..d() });
        refuses(ViewOptions { size: [16_384, 16_384], ..d() });
        refuses(ViewOptions { frames: Some(0), ..d() });
        refuses(ViewOptions { light: Some([0.0; 3]), ..d() });
        refuses(ViewOptions { light: Some([f64::NAN; 3]), ..d() });
        refuses(ViewOptions { orbit_degrees: Some(f64::INFINITY), ..d() });
    }

    #[test]
    fn orbit_over_single_frame_is_refused() {
        let frames = |options: ViewOptions| hints(vec![]).frames(&options);
        let orbit = ViewOptions { orbit_degrees: Some(6.0), ..ViewOptions::default() };
        let light = ViewOptions { light_orbit_degrees: Some(-6.0), ..ViewOptions::default() };
        assert!(frames(orbit.clone()).unwrap_err().to_string().starts_with("orbit: 6; expected 0 with a single frame"));
        assert!(frames(light).unwrap_err().to_string().starts_with("light_orbit: -6; expected"));
        assert!(frames(ViewOptions { frames: Some(2), ..orbit }).is_ok());
        assert!(frames(ViewOptions { orbit_degrees: Some(0.0), ..ViewOptions::default() }).is_ok());
    }

    #[test]
    fn model_camera_is_used() {
        let lens = Projection::Orthographic { half_height: 1.0, near: 0.1, far: 10.0 };
        let mut s = hints(vec![]);
        s.camera = Viewpoint::placed(DMat4::from_translation(DVec3::new(0., 0., 5.)), lens);
        let frame = &s.frames(&ViewOptions { size: [200, 100], ..ViewOptions::default() }).unwrap()[0];
        assert_eq!(frame.camera.to_viewer, [0., 0., 1.]);
        let clip = DMat4::from_cols_array(&frame.camera.view_projection).transpose() * DVec4::new(2., 1., 0., 1.);
        assert_eq!((clip.x, clip.y, clip.w), (1.0, 1.0, 1.0), "twice as wide as high");
    }
}
