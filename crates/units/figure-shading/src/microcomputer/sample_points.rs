//! Process 22: brightness at the sample points (Figure 6).

use super::Microcomputer;
use super::state::Process;
use crate::illumination::normal_of;
use crate::{Clamp, Illumination, Registers};
use basrelief_signals::Polygon;

/// Red, green and blue of each sample point: first ambient and diffuse; then (steps 80 to 83) the specular term, where
/// circuit (50) does not add it and it is not negligible.
fn brightness(polygon: &Polygon, illumination: &Illumination, registers: Registers, clamp: Clamp) -> Vec<[f32; 3]> {
    let points = polygon.vertices.iter().map(|vertex| {
        let normal = normal_of(vertex.normal);
        let reflected = illumination.ambient_and_diffuse(normal, clamp);
        let specular = if registers.adds_specular_at_sample_points() { illumination.specular(normal) } else { 0.0 };
        std::array::from_fn(|i| illumination.color[i] * vertex.color[i] * reflected + specular)
    });
    points.collect()
}

impl Microcomputer {
    /// Brightness of the sample points, and the cycles that it takes.
    pub(super) fn sample_points(&mut self, polygon: &Polygon, registers: Registers) -> (Vec<[f32; 3]>, u64) {
        let c = &self.config;
        let specular = if registers.adds_specular_at_sample_points() { c.specular_brightness_cycles_per_point } else { 0 };
        let per_point = u64::from(c.brightness_cycles_per_point + specular) * self.state.illumination.lights.len().max(1) as u64;
        let cycles = self.run(Process::Brightness, per_point * polygon.vertices.len() as u64);
        (brightness(polygon, &self.state.illumination, registers, self.shading.clamp), cycles)
    }
}
