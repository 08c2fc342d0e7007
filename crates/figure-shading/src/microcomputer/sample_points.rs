//! Process 22: brightness at the sample points (Figure 6).

use crate::setting::normal_of;
use crate::{Clamp, Registers, Setting};
use basrelief_signals::Polygon;

/// Red, green and blue of each sample point: first ambient and diffuse; then (steps 80 to 83) the specular term, where
/// circuit (50) does not add it and it is not negligible.
pub(crate) fn brightness(polygon: &Polygon, setting: &Setting, registers: Registers, clamp: Clamp) -> Vec<[f32; 3]> {
    let points = polygon.vertices.iter().map(|vertex| {
        let normal = normal_of(vertex.normal);
        let reflected = setting.ambient_and_diffuse(normal, clamp);
        let specular = if registers.adds_specular_at_sample_points() { setting.specular(normal) } else { 0.0 };
        std::array::from_fn(|i| setting.color[i] * vertex.color[i] * reflected + specular)
    });
    points.collect()
}
