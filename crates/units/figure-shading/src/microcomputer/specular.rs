//! Process 17: specular-negligible decision, for the specular register (18).

use super::Microcomputer;
use super::state::CpuProcess;
use crate::cpu::CpuOperations;
use crate::local_memory::{LIGHT, LIGHTS, PolygonBuffer};
use crate::{ObjectIllumination, PowerFunction};
use basrelief_kernel::{MemoryPorts, OperatorCounts};
use basrelief_signals::Lighting;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Steps of the search for a limit: to 2^-24, the resolution of N.H.
const STEPS: u32 = 24;
/// Limit of a light whose term is never negligible.
const NEVER: f32 = -1.0;

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

/// For each light the largest N.H whose term is negligible, and the key of the search.
///
/// A power grows with its base. Instead of computing a power for each polygon, process 17 compares N.H with the base whose power
/// is just negligible, found once per material. Each of several lights may take an equal share of the threshold. (Rejected:
/// comparing the sum of all terms with the threshold, which saves a little more, but needs a power per light and polygon.)
///
/// The search halves an interval [`STEPS`] times and uses the power of circuit (50), including the rounding of its table.
/// (Rejected: a root by logarithm and exponential. It needs some 40 operations instead of some 200 at n = 50, but only once per
/// material, and a margin for every rounding.)
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpecularLimits {
    /// Key of the search: Ks, n, and Is of each light.
    found_for: Option<(f32, f32, Vec<f32>)>,
    /// Largest N.H, in the order of the lights.
    largest: Vec<f32>,
}

/// Returns the largest N.H in 0..=1 at which a light's term stays below `share`.
fn limit(lighting: &Lighting, intensity: f32, share: f32, power: &PowerFunction) -> f32 {
    let largest = share / (lighting.ks * intensity);
    let is_below = |n_h: f32| power.bound(n_h, lighting.n) < largest;
    if is_below(1.0) {
        return 1.0;
    }
    if !is_below(0.0) {
        return NEVER;
    }
    let (mut below, mut above) = (0.0, 1.0);
    for _ in 0..STEPS {
        let middle = 0.5 * (below + above);
        *if is_below(middle) { &mut below } else { &mut above } = middle;
    }
    below
}

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
    pub(super) fn set_limits(&mut self, traffic: &mut MemoryPorts) -> u64 {
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
        self.port.read(traffic, LIGHTS, LIGHT * count);
        self.port.write(traffic, LIGHTS, LIGHT * count);
        self.spend(CpuProcess::Specular, LARGEST_POWER.and(step.times(u64::from(STEPS))).times(count))
    }

    /// Runs process 17.
    pub(super) fn judge_specular(&mut self, normals: &[Vec3], buffer: PolygonBuffer, traffic: &mut MemoryPorts) -> (bool, u64) {
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
        self.port.read(traffic, buffer.normals(), 3 * points);
        self.port.read(traffic, LIGHTS, LIGHT * lights);
        (!negligible, self.run(CpuProcess::Specular, operations))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NormalInterpolationConfig, PowerMethod, power};
    use basrelief_kernel::Operators;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn limit_decides_like_power(
            n in 1u32..=1000, fraction in prop::sample::select(vec![0f32, 0.5]), ks in 0.0625f32..1.0, is in 0.0625f32..2.0,
            threshold in prop::sample::select(vec![1f32 / 510.0, 0.25, 1.0]), n_h in 0f32..=1.0,
        ) {
            let lighting = Lighting { ks, n: n as f32 + fraction, ..Lighting::default() };
            let by_iteration = PowerFunction::new(&NormalInterpolationConfig::default(), &Operators::default());
            let limit = limit(&lighting, is, threshold, &by_iteration);
            let term = |n_h: f32| ks * is * power(n_h.clamp(0.0, 1.0), lighting.n);
            // Up to rounding, and the width of the last step.
            if term(n_h - 1e-6) >= threshold * 1.0001 {
                prop_assert!(n_h > limit, "{} {}", n_h, limit);
            }
            if term(n_h + 1e-6) < threshold * 0.9999 {
                prop_assert!(n_h <= limit, "{} {}", n_h, limit);
            }
        }
    }

    #[test]
    fn limit_follows_table_rounding() {
        let config = NormalInterpolationConfig {
            power: PowerMethod::Table,
            table_entries: 9,
            table_bits: 3,
            ..NormalInterpolationConfig::default()
        };
        let by_table = PowerFunction::new(&config, &Operators::default());
        let lighting = Lighting { ks: 1.0, n: 20.0, ..Lighting::default() };
        let limit = limit(&lighting, 1.0, 0.5, &by_table);
        let table = by_table.table(20.0);
        assert!(by_table.at(&table, limit, 20.0) < 0.5);
        assert!(by_table.at(&table, limit + 1e-6, 20.0) >= 0.5, "an entry above the power");
    }

    #[test]
    fn zero_ks_is_negligible_and_zero_threshold_never_is() {
        let power = PowerFunction::new(&NormalInterpolationConfig::default(), &Operators::default());
        let lighting = |ks| Lighting { ks, n: 50.0, ..Lighting::default() };
        assert_eq!(limit(&lighting(0.0), 1.0, 1.0 / 510.0, &power), 1.0);
        assert_eq!(limit(&lighting(0.5), 1.0, 0.0, &power), NEVER);
    }
}
