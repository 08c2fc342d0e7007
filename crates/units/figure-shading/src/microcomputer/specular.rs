//! Process 17: whether specular reflection is negligible, for the specular register (18).

use super::Microcomputer;
use super::state::Process;
use crate::{Illumination, Power};
use glam::Vec3;

/// Whether the specular term stays below `threshold` on the whole polygon, by a bound on N.H.
///
/// A weighted sum of the normals has N.H at most max(N_i.H), and length at least min(M.N_i), M being the direction of their
/// sum. So N.H <= max(0, max(N_i.H)), divided by min(M.N_i) where normals are brought to length 1: there a highlight may
/// peak inside although all sample points are dark. Where that minimum is not positive there is no bound. (It is taken as
/// at most 1, so that the bound holds at the sample points, too.)
fn is_negligible(normals: &[Vec3], illumination: &Illumination, renormalise: bool, threshold: f32, power: &Power) -> bool {
    let shortest = if renormalise { shortest_sum(normals) } else { 1.0 };
    if shortest <= 0.0 {
        return false;
    }
    let bound = illumination.highlight(|light| {
        let largest = normals.iter().fold(0.0, |c: f32, n| c.max(n.dot(light.halfway)));
        power.bound((largest / shortest).min(1.0), illumination.lighting.n)
    });
    bound < threshold
}

/// No weighted mean of the normals is shorter than this; at most 1.
fn shortest_sum(normals: &[Vec3]) -> f32 {
    let middle = normals.iter().sum::<Vec3>().normalize_or_zero();
    normals.iter().fold(1.0, |s: f32, n| s.min(n.dot(middle)))
}

impl Microcomputer {
    /// Process 17.
    pub(super) fn judge_specular(&mut self, normals: &[Vec3]) -> (bool, u64) {
        let config = &self.short_cuts.specular_negligible;
        if !config.enabled {
            return (true, 0);
        }
        let negligible =
            is_negligible(normals, &self.state.illumination, self.shading.renormalise, config.threshold, &self.power);
        self.state.counters.specular_negligible += u64::from(negligible);
        let per_light = u64::from(self.config.specular_cycles_per_point) * normals.len() as u64
            + u64::from(self.config.specular_power_cycles);
        (!negligible, self.run(Process::Specular, per_light * self.state.illumination.lights.len() as u64))
    }
}
