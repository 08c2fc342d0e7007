//! Frames of a scene from the view options of the user and the hints of the model.

use crate::SceneError;
use crate::camera::{AUTO_VIEW, View, Viewpoint, WorldBounds, check_camera, direction, rows, turn, turn_around};
use basrelief_signals::{Camera, Frame, MAX_PICTURE_PIXELS, ShadingSettings};
use glam::{DMat4, DVec3, DVec4};
use std::sync::Arc;

mod lamp;
mod options;

pub(crate) use lamp::{LightOrbit, LightSource};
pub use options::{OwnView, ViewOptions, ZOOM};

/// Default direction to the light (assumed); normalised.
const DEFAULT_LIGHT: [f64; 3] = [0.4, 0.8, 0.45];

/// Maximum number of pixels per side: coordinates of fragments have 16 bits, and a frame buffer must fit in memory.
const MAX_SIDE: u32 = 16_384;

/// Maximum number of frames of one scene.
pub(crate) const MAX_FRAMES: u32 = 1_000_000;

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
                lights: lamps.iter().map(|(lamp, intensity)| lamp.light(*intensity)).collect(),
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
        (self.orbit(*view, orbit), lamps.iter().map(|(lamp, i)| (lamp.turned(light_orbit, self.bounds.centre()), *i)).collect())
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

#[cfg(test)]
mod tests;
