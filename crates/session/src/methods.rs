//! What each method of choosing division points costs where all keep the same error.

use crate::ablation::complete;
use crate::machines::MachineConfig;
use crate::observer::Observer;
use crate::outcome::{Run, SessionError};
use crate::settings::RunOptions;
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_report::methods::{Method, Methods, figure};
use basrelief_texel_value_generator::Method as Divide;

/// Runs the machine by each of its methods: adaptive with the configured error bound, exact, and those that divide at fixed
/// places as seldom as the measured largest displacement stays within that bound. How seldom is found by bisection, without
/// time; a rarer division that happens to keep the bound again is not looked for. `run` makes one run to its end, of the same
/// input under the settings it is given, watched by `observer`.
///
/// # Errors
/// A machine without these methods, a run that does not complete or has no time, whatever `run` says.
pub fn compare_methods<E: From<SessionError>>(
    settings: &RunOptions,
    observer: &mut dyn Observer,
    run: impl FnMut(&RunOptions, &mut dyn Observer) -> Result<Run, E>,
) -> Result<Methods, E> {
    let MachineConfig::Texel(config) = &settings.config else {
        return Err(SessionError::NoMethods(settings.config.machine().name).into());
    };
    let mut runs = Runs { settings, config, observer, run };
    let adaptive = runs.timed("adaptive", |c| c.texel.method = Divide::Adaptive, vec!["texel.method=adaptive".into()])?;
    let limit = adaptive.0.size.width.clamp(1, 16_384);
    let mut methods = Methods::of(&adaptive.0, config.texel.error_bound);
    methods.methods.push(adaptive.1);
    for way in FIXED {
        let number = runs.rarest(way, limit)?;
        let settings = (way.settings)(number);
        methods.methods.push(runs.timed(&(way.name)(number), |c| (way.set)(c, number), settings)?.1);
    }
    let exact = runs.timed("exact", |c| c.texel.method = Divide::Exact, vec!["texel.method=exact".into()])?;
    methods.methods.push(exact.1);
    Ok(methods)
}

/// A method that divides at fixed places, by a number.
#[derive(Clone, Copy)]
struct Fixed {
    name: fn(u32) -> String,
    settings: fn(u32) -> Vec<String>,
    set: fn(&mut TexelMachineConfig, u32),
    /// A larger number divides more often.
    more: bool,
}

const FIXED: [Fixed; 3] = [
    Fixed {
        name: |n| if n == 1 { "fixed, every pixel".into() } else { format!("fixed, every {n} pixels") },
        settings: |n| vec!["texel.method=fixed".into(), "texel.points=0".into(), format!("texel.interval={n}")],
        set: |c, n| (c.texel.method, c.texel.points, c.texel.interval) = (Divide::Fixed, 0, n),
        more: false,
    },
    Fixed {
        name: |n| format!("fixed, {n} point{} per line", if n == 1 { "" } else { "s" }),
        settings: |n| vec!["texel.method=fixed".into(), format!("texel.points={n}")],
        set: |c, n| (c.texel.method, c.texel.points) = (Divide::Fixed, n),
        more: true,
    },
    Fixed {
        name: |n| format!("subpolygons of {n} pixels"),
        settings: |n| vec!["texel.method=subpolygon".into(), format!("texel.interval={n}")],
        set: |c, n| (c.texel.method, c.texel.interval) = (Divide::Subpolygon, n),
        more: false,
    },
];

struct Runs<'a, R> {
    settings: &'a RunOptions,
    config: &'a TexelMachineConfig,
    observer: &'a mut dyn Observer,
    run: R,
}

impl<E: From<SessionError>, R: FnMut(&RunOptions, &mut dyn Observer) -> Result<Run, E>> Runs<'_, R> {
    fn configured(&self, change: impl FnOnce(&mut TexelMachineConfig)) -> RunOptions {
        let mut config = self.config.clone();
        change(&mut config);
        RunOptions { config: config.into(), exhibits: vec![], ..self.settings.clone() }
    }

    fn timed(
        &mut self,
        name: &str,
        change: impl FnOnce(&mut TexelMachineConfig),
        set: Vec<String>,
    ) -> Result<(basrelief_report::Report, Method), E> {
        let settings = self.configured(change);
        let report = complete(name, (self.run)(&settings, self.observer)?)?;
        let method = Method::of(name.into(), set, &report);
        Ok((report, method))
    }

    /// The number, 1 to `limit`, that divides most seldom and keeps the bound.
    fn rarest(&mut self, way: Fixed, limit: u32) -> Result<u32, E> {
        let bound = self.config.texel.error_bound;
        let mut keeps = |number: u32| {
            let settings = RunOptions { engine: None, exact: false, ..self.configured(|c| (way.set)(c, number)) };
            let run = (self.run)(&settings, self.observer)?;
            Ok(figure(&run.report, "displacement_largest") <= bound)
        };
        if way.more {
            last(0, limit - 1, |number| keeps(number).map(|keeps| !keeps)).map(|number| number + 1)
        } else {
            last(1, limit, keeps)
        }
    }
}

/// The last number up to `limit` with a property that `first` is taken to have: by doubling, then bisection.
fn last<E>(first: u32, limit: u32, mut has: impl FnMut(u32) -> Result<bool, E>) -> Result<u32, E> {
    let mut low = first;
    let mut high = loop {
        let next = (2 * low).max(low + 1).min(limit);
        if next <= low {
            return Ok(low);
        }
        if !has(next)? {
            break next;
        }
        low = next;
    };
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if has(middle)? { low = middle } else { high = middle }
    }
    Ok(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_number_with_a_property_is_found_in_few_steps() {
        for (first, limit) in [(0, 700), (1, 700), (1, 1), (0, 0)] {
            for end in first..=limit {
                let mut asked = 0;
                let found = last(first, limit, |n| {
                    asked += 1;
                    assert!(n > first && n <= limit);
                    Ok::<_, ()>(n <= end)
                });
                assert_eq!(found, Ok(end));
                assert!(asked <= 20);
            }
        }
        assert_eq!(last(1, 9, |_| Err("no")), Err("no"));
    }
}
