//! Process 22: brightness at the sample points (Figure 6).

use super::Microcomputer;
use super::state::CpuProcess;
use crate::cpu::CpuOperations;
use crate::illumination::normal_of;
use crate::local_memory::{LIGHT, LIGHTS, PolygonBuffer};
use crate::power::multiplications;
use crate::{ObjectIllumination, ShadingRegisters, SumClamp};
use basrelief_kernel::OperatorCounts;
use basrelief_signals::Polygon;

/// Per sample point: its normal, Kd, Ka*Ia, the surface's colour.
const POINT: CpuOperations =
    CpuOperations { load: 3, store: 3, ..CpuOperations::of(OperatorCounts { multiply: 4, add: 1, ..OperatorCounts::NONE }) };
/// Per sample point with a colour: that colour.
const COLOR: CpuOperations = CpuOperations { load: 3, multiply: 3, ..CpuOperations::NONE };
/// Per sample point and light: N.L, clamped at 0, times Is, summed.
const DIFFUSE: CpuOperations = CpuOperations {
    load: 4,
    compare: 1,
    ..CpuOperations::of(OperatorCounts::INNER_PRODUCT.and(OperatorCounts { multiply: 1, add: 1, ..OperatorCounts::NONE }))
};
/// Step 83, per sample point and light: N.H, clamped to 0..=1, times Is, summed. The power is extra.
const SPECULAR: CpuOperations = CpuOperations { load: 3, compare: 2, ..DIFFUSE };
/// Step 83, per sample point: product with Ks, added to each component.
const HIGHLIGHT: CpuOperations = CpuOperations { multiply: 1, add: 3, ..CpuOperations::NONE };

/// Returns red, green and blue of each sample point: first ambient and diffuse, then (steps 80 to 83) the specular term. The
/// latter is left out if circuit (50) adds it or if it is negligible.
fn brightness(
    polygon: &Polygon,
    illumination: &ObjectIllumination,
    registers: ShadingRegisters,
    clamp: SumClamp,
) -> Vec<[f32; 3]> {
    let points = polygon.vertices.iter().map(|vertex| {
        let normal = normal_of(vertex.normal);
        let reflected = illumination.ambient_and_diffuse(normal, clamp);
        let specular = if registers.adds_specular_at_sample_points() { illumination.specular(normal) } else { 0.0 };
        std::array::from_fn(|i| illumination.color[i] * vertex.color[i] * reflected + specular)
    });
    points.collect()
}

impl Microcomputer {
    /// Returns the brightness of the sample points, and its cycles.
    pub(super) fn sample_points(
        &mut self,
        polygon: &Polygon,
        registers: ShadingRegisters,
        buffer: PolygonBuffer,
    ) -> (Vec<[f32; 3]>, u64) {
        let (points, lights) = (polygon.vertices.len() as u64, self.state.illumination.lights.len() as u64);
        let is_colored = polygon.vertices.iter().any(|v| v.color != [1.0; 4]);
        let mut operations = POINT.and(DIFFUSE.times(lights));
        if is_colored {
            operations = operations.and(COLOR);
            self.fetch(buffer.colors(), 3 * points);
        }
        if registers.adds_specular_at_sample_points() {
            let power = CpuOperations { multiply: multiplications(self.state.illumination.lighting.n), ..CpuOperations::NONE };
            operations = operations.and(SPECULAR.and(power).times(lights)).and(HIGHLIGHT);
        }
        self.fetch(buffer.normals(), 3 * points);
        self.fetch(LIGHTS, LIGHT * lights);
        self.store_numbers(buffer.brightness(), 3 * points);
        let cycles = self.run(CpuProcess::Brightness, operations.times(points));
        (brightness(polygon, &self.state.illumination, registers, self.shading.clamp), cycles)
    }
}
