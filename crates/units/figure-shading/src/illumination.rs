//! Values that are constant over an object: coefficients and lights, and the brightness formula.

use crate::{SumClamp, power};
use basrelief_shading::LightVector;
use basrelief_signals::{Lighting, ShadingMode};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Mode, Ia, Is, L, H, Ka, Kd, Ks, n. A stored brightness is valid until one of them changes (Figure 7).
///
/// The patent has one light. Here the terms of several lights are added, and each further light uses process 22, process 17 and
/// circuit (50) once more. Light and viewer are at infinity, or a point light is evaluated at the object's centre, so L and H are
/// constant over an object. Ka and Kd include the surface's colour. Ks does not, because a highlight is white.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectIllumination {
    /// Shading mode.
    pub mode: ShadingMode,
    /// Coefficients Ka, Kd, Ks, n.
    pub lighting: Lighting,
    /// Colour of the surface, without that of its sample points.
    pub color: [f32; 3],
    /// Ambient intensity Ia.
    pub ambient: f32,
    /// L, H and Is of each light.
    pub lights: Vec<LightVector>,
}

impl ObjectIllumination {
    /// Returns `Ka*Ia + Kd * sum of Is*(N.L)`, without colour.
    pub fn ambient_and_diffuse(&self, normal: Vec3, clamp: SumClamp) -> f32 {
        let lit = |light: &LightVector| {
            let cosine = normal.dot(light.to_light);
            light.intensity * if clamp == SumClamp::Vertex { cosine.max(0.0) } else { cosine }
        };
        self.lighting.ka * self.ambient + self.lighting.kd * self.lights.iter().map(lit).sum::<f32>()
    }

    /// Returns `Ks * sum of Is*(N.H)^n` at a sample point.
    pub fn specular(&self, normal: Vec3) -> f32 {
        self.highlight(|light| power(normal.dot(light.halfway).clamp(0.0, 1.0), self.lighting.n))
    }

    /// Returns `Ks * sum of Is*p` for the power p of each light.
    #[inline]
    pub fn highlight(&self, power: impl Fn(&LightVector) -> f32) -> f32 {
        self.lighting.ks * self.lights.iter().map(|light| light.intensity * power(light)).sum::<f32>()
    }
}

/// Returns a normal as the device uses it. Its length is zero if a component is not finite.
pub(crate) fn normal_of(stored: [f32; 3]) -> Vec3 {
    let normal = Vec3::from(stored);
    if normal.is_finite() { normal } else { Vec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn illumination(kd: f32, ks: f32) -> ObjectIllumination {
        let lighting = Lighting { ka: 0.25, kd, ks, n: 2.0 };
        let light = LightVector { to_light: Vec3::Z, halfway: Vec3::new(0.6, 0.0, 0.8), intensity: 0.5 };
        ObjectIllumination { lighting, color: [1.0; 3], ambient: 2.0, lights: vec![light; 2], ..ObjectIllumination::default() }
    }

    // Claim: shade, formula: Ambient counts once, other terms per light. N.H is cut to 0..1 before the power. The only saturation
    // follows the adder (52).
    #[test]
    fn section_2_ambient_counts_once_other_terms_per_light() {
        let s = illumination(0.5, 1.0);
        assert_eq!(s.ambient_and_diffuse(Vec3::Z, SumClamp::Vertex), 0.25 * 2.0 + 0.5);
        assert!((s.specular(Vec3::Z) - 0.64).abs() < 1e-6);
    }

    // Claim: as section_2_ambient_counts_once_other_terms_per_light.
    #[test]
    fn section_2_clamp_and_even_power_keep_far_side_dark() {
        let s = illumination(0.5, 1.0);
        assert_eq!(s.ambient_and_diffuse(-Vec3::Z, SumClamp::Vertex), 0.5);
        assert_eq!(s.ambient_and_diffuse(-Vec3::Z, SumClamp::None), 0.0);
        assert_eq!(s.specular(-Vec3::Z), 0.0);
        assert_eq!(s.specular(Vec3::new(0.6, 0.0, 0.8) * 1.5), 1.0);
    }

    // Claim: as zero_area_and_repeated_points_have_no_dots.
    #[test]
    fn degenerate_normals_count_as_zero() {
        assert_eq!(normal_of([f32::NAN, 0.0, 1.0]), Vec3::ZERO);
        assert_eq!(normal_of([f32::INFINITY, 0.0, 1.0]), Vec3::ZERO);
        assert_eq!(normal_of([0.0; 3]), Vec3::ZERO);
        assert_eq!(illumination(0.5, 1.0).ambient_and_diffuse(Vec3::ZERO, SumClamp::None), 0.5);
    }
}
