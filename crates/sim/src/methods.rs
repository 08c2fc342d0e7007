//! What each method of a machine costs where all keep the same error.

use crate::ablation::complete;
use crate::machines::{MACHINES, MachineConfig, MachineSpec, for_machine};
use crate::observer::Observer;
use crate::outcome::{Run, SessionError};
use crate::settings::{RunOptions, When};
use basrelief_report::Report;
use basrelief_report::methods::{Method, Methods, figure};

/// How a machine can do the same work to the same error. `S` configures it.
#[derive(Clone, Copy, Debug)]
pub struct MethodSpecs<S: 'static> {
    /// The error that every method is to keep within.
    pub bound: fn(&S) -> f64,
    /// The figure that says how large the error of a run was.
    pub error: &'static str,
    /// The methods, in the order of the table; the first has no number.
    pub methods: &'static [MethodSpec<S>],
}

/// A method; one that has a number to choose is given it.
#[derive(Clone, Copy, Debug)]
pub struct MethodSpec<S: 'static> {
    /// In words.
    pub name: fn(u32) -> String,
    /// What makes the machine run like this, as `KEY=VALUE`.
    pub settings: fn(u32) -> Vec<String>,
    /// Does the same to a configuration.
    pub set: fn(&mut S, u32),
    /// Which number it is given.
    pub number: Number,
}

/// The number that a method is given: of those that keep the error within the bound, the one that makes least work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    /// None: the method has no choice.
    Absent,
    /// The largest: a larger one makes less work and errs more.
    Largest,
    /// The smallest: a smaller one makes less work and errs more.
    Smallest,
}

/// Runs the machine by each of its methods, those with a number by the one that makes least work while the measured error stays
/// within the configured bound. That is found by bisection, without time; a number beyond it that happens to keep the bound
/// again is not looked for. `run` makes one run to its end, of the same input under the settings it is given, watched by
/// `observer`.
///
/// # Errors
/// A machine without methods, a run that does not complete or has no time, whatever `run` says.
pub fn compare_methods<E: From<SessionError>>(
    settings: &RunOptions,
    observer: &mut dyn Observer,
    run: impl FnMut(&RunOptions, &mut dyn Observer) -> Result<Run, E>,
) -> Result<Methods, E> {
    for_machine!(&settings.config, config => Runs { settings, config, observer, run }.compare())
}

struct Runs<'a, S, R> {
    settings: &'a RunOptions,
    config: &'a S,
    observer: &'a mut dyn Observer,
    run: R,
}

impl<S: MachineSpec, E: From<SessionError>, R: FnMut(&RunOptions, &mut dyn Observer) -> Result<Run, E>> Runs<'_, S, R>
where
    MachineConfig: From<S>,
{
    fn compare(mut self) -> Result<Methods, E> {
        let no_methods = || {
            let others: Vec<&str> = MACHINES.iter().filter(|m| m.has_methods).map(|m| m.name).collect();
            SessionError::NoMethods(S::NAME, others.join(" or "))
        };
        let specs = S::METHODS.ok_or_else(no_methods)?;
        let mut table: Option<Methods> = None;
        for method in specs.methods {
            // No place of a line is farther from another than the picture is wide.
            let limit = table.as_ref().map_or(1, |table| table.size.width).clamp(1, 16_384);
            let number = self.number(&specs, method, limit)?;
            let (report, method) = self.timed(method, number)?;
            table.get_or_insert_with(|| Methods::of(&report, (specs.bound)(self.config))).methods.push(method);
        }
        table.ok_or_else(|| no_methods().into())
    }

    fn configured(&self, method: &MethodSpec<S>, number: u32) -> RunOptions {
        let mut config = self.config.clone();
        (method.set)(&mut config, number);
        RunOptions { config: config.into(), exhibits: vec![], limits: When::Never, tape: When::Never, ..self.settings.clone() }
    }

    fn timed(&mut self, method: &MethodSpec<S>, number: u32) -> Result<(Report, Method), E> {
        let name = (method.name)(number);
        let settings = self.configured(method, number);
        let report = complete(&name, (self.run)(&settings, self.observer)?)?;
        let method = Method::of(name, (method.settings)(number), &report);
        Ok((report, method))
    }

    /// The number that the method is given, 1 to `limit`; 0 where it has none.
    fn number(&mut self, specs: &MethodSpecs<S>, method: &MethodSpec<S>, limit: u32) -> Result<u32, E> {
        let bound = (specs.bound)(self.config);
        let mut keeps = |number: u32| {
            let settings = RunOptions { engine: None, exact: false, ..self.configured(method, number) };
            let run = (self.run)(&settings, self.observer)?;
            Ok(figure(&run.report, specs.error) <= bound)
        };
        match method.number {
            Number::Absent => Ok(0),
            Number::Largest => last(1, limit, keeps),
            Number::Smallest => last(0, limit - 1, |number| keeps(number).map(|keeps| !keeps)).map(|number| number + 1),
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
