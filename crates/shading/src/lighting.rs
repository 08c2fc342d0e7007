//! The lighting formula: `ka + kd * sum i max(N.L, 0)` and `ks * sum i max(N.H, 0)^n` (assumed: ambient + Lambert + Blinn-Phong;
//! the patent states only that light type and position decide the brightness of a normal).

use basrelief_signals::MapInline as _;
use basrelief_signals::{Frame, LightKind, Lighting};
use glam::Vec3;
use wide::f32x4;

/// A light prepared for the formula. It is constant over an object, because light and viewer are at infinity or the light is
/// evaluated at the object's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LightVector {
    /// Unit vector towards the light, world space. Zero if a point light lies in the object's centre.
    pub to_light: Vec3,
    /// Unit vector halfway between light and viewer. Zero if they are opposite.
    pub halfway: Vec3,
    /// Factor of the diffuse and specular terms.
    pub intensity: f32,
}

/// Converts a colour of components 0..=1 to 8 bits each. Values saturate, halves round up, and NaN becomes black.
#[inline]
pub fn saturated(color: [f32; 3]) -> [u8; 3] {
    // The conversion saturates at both ends. (`map` would be a call.)
    let [red, green, blue] = color;
    let bits = |c: f32| (c * 255.0 + 0.5) as u8;
    [bits(red), bits(green), bits(blue)]
}

/// Computes [`saturated`] for four colours side by side. Returns their bytes by component.
#[inline(always)]
pub fn saturated_beside(color: [f32x4; 3]) -> [[i32; 4]; 3] {
    color.map_inline(|c| {
        let steps = c * 255.0 + 0.5;
        // NaN compares as not above 0.
        let positive = steps.simd_gt(f32x4::ZERO).select(steps, f32x4::ZERO);
        positive.fast_min(f32x4::splat(255.0)).fast_trunc_int().to_array()
    })
}

/// Returns the frame's lights as seen from `centre` (world space), where point lights are evaluated.
pub fn light_vectors(frame: &Frame, centre: [f32; 3]) -> Vec<LightVector> {
    let to_viewer = Vec3::from(frame.camera.to_viewer.map(|c| c as f32));
    let vector = |kind: LightKind| match kind {
        LightKind::Directional { to_light } => Vec3::from(to_light),
        LightKind::Point { position } => Vec3::from(position) - Vec3::from(centre),
    };
    let light = |kind, intensity| {
        let to_light = vector(kind).normalize_or_zero();
        LightVector { to_light, halfway: (to_light + to_viewer).normalize_or_zero(), intensity }
    };
    frame.lights.iter().map(|l| light(l.kind, l.intensity)).collect()
}

/// Returns the brightness of a surface with this unit normal: `[ambient + diffuse, specular]`, not clamped above.
///
/// The specular term does not test whether the light is in front of the surface, and neither does the formula of the
/// reference image.
pub fn brightness(unit_normal: Vec3, lighting: &Lighting, lights: &[LightVector]) -> [f32; 2] {
    let mut diffuse = 0.0;
    let mut specular = 0.0;
    for light in lights {
        diffuse += light.intensity * unit_normal.dot(light.to_light).max(0.0);
        specular += light.intensity * power(unit_normal.dot(light.halfway), lighting.n);
    }
    [lighting.ka + lighting.kd * diffuse, lighting.ks * specular]
}

/// Computes `max(x, 0)^n`. Most reference normals face away from a highlight, so a branch for zero pays off.
fn power(x: f32, n: f32) -> f32 {
    if x > 0.0 { libm::powf(x, n) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::{Camera, Light};

    #[test]
    fn colours_side_by_side_saturate_like_one() {
        let values =
            [f32::NAN, f32::NEG_INFINITY, -0.0, 0.001_960_784_2, 0.001_960_784_4, 0.5, 0.998, 1.0, 1.01, f32::INFINITY, 1e30];
        for value in values {
            let [beside, ..] = saturated_beside([f32x4::new([0.0, value, 1.0, value]); 3]);
            let [alone, ..] = saturated([value; 3]).map(i32::from);
            assert_eq!(beside, [0, alone, 255, alone], "{value}");
        }
    }

    fn frame(kinds: &[LightKind]) -> Frame {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
        let lights = kinds.iter().map(|&kind| Light { kind, intensity: 1.0 }).collect();
        Frame { index: 0, width: 1, height: 1, camera, lights, textures: Vec::new(), shading: Default::default() }
    }

    #[test]
    fn surface_facing_light_and_viewer_has_full_terms() {
        let lights = light_vectors(&frame(&[LightKind::Directional { to_light: [0.0, 0.0, 1.0] }]), [0.0; 3]);
        let lighting = Lighting::default();
        assert_eq!(brightness(Vec3::Z, &lighting, &lights), [lighting.ka + lighting.kd, lighting.ks]);
        assert_eq!(brightness(-Vec3::Z, &lighting, &lights), [lighting.ka, 0.0]);
    }

    #[test]
    fn ambient_counts_once_and_lights_add() {
        let one = LightKind::Directional { to_light: [0.6, 0.0, 0.8] };
        let lighting = Lighting { ka: 0.25, kd: 0.5, ks: 0.5, n: 2.0 };
        let at = |kinds: &[LightKind]| brightness(Vec3::Z, &lighting, &light_vectors(&frame(kinds), [0.0; 3]));
        let (single, double) = (at(&[one]), at(&[one, one]));
        assert!((double[0] - 0.25 - 2.0 * (single[0] - 0.25)).abs() < 1e-6);
        assert!((double[1] - 2.0 * single[1]).abs() < 1e-6);
        // N.H = cos(half the angle): H = (0.6, 0, 1.8) / |..|, squared 3.24 / 3.6.
        assert!((single[1] - 0.5 * 3.24 / 3.6).abs() < 1e-6);
    }

    #[test]
    fn point_light_is_evaluated_at_object_centre() {
        let kinds = [LightKind::Point { position: [1.0, 2.0, 7.0] }];
        assert_eq!(light_vectors(&frame(&kinds), [1.0, 2.0, 3.0])[0].to_light, Vec3::Z);
        assert_eq!(light_vectors(&frame(&kinds), [1.0, 2.0, 7.0])[0].to_light, Vec3::ZERO);
    }

    #[test]
    fn opposite_light_gives_neither_highlight_nor_nan() {
        let lights = light_vectors(&frame(&[LightKind::Directional { to_light: [0.0, 0.0, -1.0] }]), [0.0; 3]);
        assert_eq!(brightness(Vec3::X, &Lighting::default(), &lights), [0.1, 0.0]);
    }
}
