//! Largest N.H whose specular term is negligible, for process 17.

use crate::PowerFunction;
use basrelief_signals::Lighting;
use serde::{Deserialize, Serialize};

/// Steps of the search for a limit: to 2^-24, the resolution of N.H.
pub(super) const STEPS: u32 = 24;
/// Limit of a light whose term is never negligible.
const NEVER: f32 = -1.0;

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
    pub(super) found_for: Option<(f32, f32, Vec<f32>)>,
    /// Largest N.H, in the order of the lights.
    pub(super) largest: Vec<f32>,
}

/// Returns the largest N.H in 0..=1 at which a light's term stays below `share`.
pub(super) fn limit(lighting: &Lighting, intensity: f32, share: f32, power: &PowerFunction) -> f32 {
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
