//! Ambient, Lambert and Blinn-Phong, per pixel.

use basrelief_signals::{Frame, Light, LightKind, Lighting};
use glam::DVec3;

/// Lights of a frame as seen from one object, with its material's coefficients.
#[derive(Clone, Debug, Default)]
pub(crate) struct ObjectLight {
    ambient: f64,
    diffuse: f64,
    specular: f64,
    exponent: f64,
    beams: Vec<LightBeam>,
}

#[derive(Clone, Copy, Debug)]
struct LightBeam {
    to_light: DVec3,
    half: DVec3,
    intensity: f64,
}

impl ObjectLight {
    /// Computes the light on an object around `centre` in the given frame.
    pub fn new(frame: &Frame, lighting: &Lighting, centre: [f32; 3]) -> Self {
        let to_viewer = DVec3::from(frame.camera.to_viewer).normalize_or_zero();
        let beam = |light: &Light| {
            let to_light = direction(light, centre);
            LightBeam { to_light, half: (to_light + to_viewer).normalize_or_zero(), intensity: f64::from(light.intensity) }
        };
        Self {
            ambient: f64::from(lighting.ka),
            diffuse: f64::from(lighting.kd),
            specular: f64::from(lighting.ks),
            exponent: f64::from(lighting.n),
            beams: frame.lights.iter().map(beam).collect(),
        }
    }

    /// Returns ambient plus diffuse brightness, and specular brightness, of a surface with this unit normal.
    pub fn on(&self, normal: DVec3) -> (f64, f64) {
        let mut diffuse = 0.0;
        let mut specular = 0.0;
        for beam in &self.beams {
            diffuse += beam.intensity * normal.dot(beam.to_light).max(0.0);
            specular += beam.intensity * raised(normal.dot(beam.half).max(0.0), self.exponent);
        }
        (self.ambient + self.diffuse * diffuse, self.specular * specular)
    }
}

/// Raises a base >= 0 to a power. Whole exponents, the common case, are multiplied out: `libm::pow` for every pixel took a third
/// of the time of a picture.
fn raised(base: f64, exponent: f64) -> f64 {
    let whole = exponent.floor();
    let rest = exponent - whole;
    let mut power = if rest == 0.0 { 1.0 } else { libm::pow(base, rest) };
    let mut square = base;
    let mut bits = whole as u64;
    while bits > 0 {
        if bits & 1 == 1 {
            power *= square;
        }
        square *= square;
        bits >>= 1;
    }
    power
}

fn direction(light: &Light, centre: [f32; 3]) -> DVec3 {
    let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    match light.kind {
        LightKind::Directional { to_light } => wide(to_light).normalize_or_zero(),
        LightKind::Point { position } => (wide(position) - wide(centre)).normalize_or_zero(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::Camera;

    fn frame(lights: Vec<Light>) -> Frame {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
        Frame { index: 0, width: 1, height: 1, camera, lights, textures: Vec::new(), shading: Default::default() }
    }

    #[test]
    fn powers_match_pow() {
        for exponent in [0.0, 1.0, 2.5, 7.0, 32.0, 999.75] {
            for base in [0.0, 0.125, 0.9, 0.9999, 1.0] {
                let expected = libm::pow(base, exponent);
                assert!((raised(base, exponent) - expected).abs() <= 1e-13 * expected, "{base}^{exponent}");
            }
        }
    }

    #[test]
    fn lights_add_and_point_lights_use_object_centre() {
        let lighting = Lighting { ka: 0.25, kd: 0.5, ks: 0.125, n: 2.0 };
        let behind = LightKind::Directional { to_light: [0.0, 0.0, -1.0] };
        let point = LightKind::Point { position: [5.0, 0.0, 9.0] };
        let lights = [(behind, 1.0), (point, 0.5)].map(|(kind, intensity)| Light { kind, intensity });
        let light = ObjectLight::new(&frame(lights.to_vec()), &lighting, [5.0, 0.0, 2.0]);
        assert_eq!(light.on(DVec3::Z), (0.25 + 0.5 * 0.5, 0.125 * 0.5));
        assert_eq!(light.on(DVec3::NEG_Z), (0.25 + 0.5, 0.0));
        let (diffuse, specular) = light.on(DVec3::new(0.6, 0.0, 0.8));
        assert!((diffuse - (0.25 + 0.5 * 0.5 * 0.8)).abs() < 1e-12);
        assert!((specular - 0.125 * 0.5 * 0.64).abs() < 1e-12);
    }
}
