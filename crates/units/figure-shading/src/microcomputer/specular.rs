//! Process 17: specular-negligible decision, for the specular register (18).

use super::Microcomputer;
use super::limits::{STEPS, SpecularLimits, limit};
use super::state::CpuProcess;
use crate::ObjectIllumination;
use crate::cpu::CpuOperations;
use crate::local_memory::{LIGHT, LIGHTS, PolygonBuffer};
use basrelief_kernel::OperatorCounts;
use glam::Vec3;

/// Per light: the largest negligible power, threshold / (number of lights * Ks * Is).
const LARGEST_POWER: CpuOperations = CpuOperations { load: 3, store: 1, divide: 1, multiply: 2, ..CpuOperations::NONE };
/// Per light and step of the search: the middle, and a comparison of its power. The power is extra.
const STEP: CpuOperations = CpuOperations { add: 1, multiply: 1, compare: 1, ..CpuOperations::NONE };
/// Per sample point and light: N.H, and a comparison with the largest so far.
const POINT: CpuOperations = CpuOperations { load: 3, compare: 1, ..CpuOperations::of(OperatorCounts::INNER_PRODUCT) };
/// Per light: H and its limit, compared.
const OF_LIGHT: CpuOperations = CpuOperations { load: 4, compare: 1, ..CpuOperations::NONE };
/// Per sample point, if normals are normalised: its part of their sum, its product with the sum's direction, and a comparison
/// with the smallest so far.
const SHORTEST_POINT: CpuOperations = CpuOperations {
    load: 6,
    compare: 1,
    ..CpuOperations::of(OperatorCounts::INNER_PRODUCT.and(OperatorCounts { add: 3, ..OperatorCounts::NONE }))
};
/// Per polygon, if normals are normalised: the sum's direction.
const SHORTEST: CpuOperations = CpuOperations::of(OperatorCounts::NORMALIZE);
/// Per light, if normals are normalised: N.H divided by the smallest product.
const SHORTEST_OF_LIGHT: CpuOperations = CpuOperations { divide: 1, compare: 1, ..CpuOperations::NONE };

/// Returns true if the specular term stays below the threshold on the whole polygon, by a bound on N.H.
///
/// A weighted sum of the normals has N.H at most max(N_i.H), and length at least min(M.N_i), for M the direction of their sum. So
/// N.H <= max(0, max(N_i.H)), divided by min(M.N_i) if normals are normalised. In that case a highlight may peak inside although
/// all sample points are dark. If that minimum is not positive, no bound exists. (It is limited to 1, so that the bound also
/// holds at the sample points.)
fn is_negligible(normals: &[Vec3], illumination: &ObjectIllumination, renormalise: bool, limits: &SpecularLimits) -> bool {
    let shortest = if renormalise { shortest_sum(normals) } else { 1.0 };
    if shortest <= 0.0 {
        return false;
    }
    illumination.lights.iter().zip(&limits.largest).all(|(light, limit)| {
        let largest = normals.iter().fold(0.0, |c: f32, n| c.max(n.dot(light.halfway)));
        (largest / shortest).min(1.0) <= *limit
    })
}

/// Returns a lower bound of the length of any weighted mean of the normals, at most 1.
fn shortest_sum(normals: &[Vec3]) -> f32 {
    let middle = normals.iter().sum::<Vec3>().normalize_or_zero();
    normals.iter().fold(1.0, |s: f32, n| s.min(n.dot(middle)))
}

impl Microcomputer {
    /// Computes the limits if Ks, n or Is have changed. Returns the cycles.
    pub(super) fn set_limits(&mut self) -> u64 {
        let config = &self.short_cuts.specular_negligible;
        let ObjectIllumination { lighting, lights, .. } = &*self.state.illumination;
        let wanted = Some((lighting.ks, lighting.n, lights.iter().map(|light| light.intensity).collect()));
        if !config.enabled || self.state.limits.found_for == wanted {
            return 0;
        }
        let (count, share) = (lights.len() as u64, config.threshold / lights.len() as f32);
        let largest = lights.iter().map(|light| limit(lighting, light.intensity, share, &self.power)).collect();
        let step = STEP.and(CpuOperations { multiply: self.power.bound_multiplications(lighting.n), ..CpuOperations::NONE });
        self.state.limits = SpecularLimits { found_for: wanted, largest };
        self.fetch(LIGHTS, LIGHT * count);
        self.store_numbers(LIGHTS, LIGHT * count);
        self.spend(CpuProcess::Specular, LARGEST_POWER.and(step.times(u64::from(STEPS))).times(count))
    }

    /// Runs process 17.
    pub(super) fn judge_specular(&mut self, normals: &[Vec3], buffer: PolygonBuffer) -> (bool, u64) {
        if !self.short_cuts.specular_negligible.enabled {
            return (true, 0);
        }
        let renormalise = self.shading.renormalise;
        let negligible = is_negligible(normals, &self.state.illumination, renormalise, &self.state.limits);
        self.state.counters.specular_negligible += u64::from(negligible);
        let (points, lights) = (normals.len() as u64, self.state.illumination.lights.len() as u64);
        let mut operations = POINT.times(points).and(OF_LIGHT).times(lights);
        if renormalise {
            operations = operations.and(SHORTEST_POINT.times(points)).and(SHORTEST).and(SHORTEST_OF_LIGHT.times(lights));
        }
        self.fetch(buffer.normals(), 3 * points);
        self.fetch(LIGHTS, LIGHT * lights);
        (!negligible, self.run(CpuProcess::Specular, operations))
    }
}
