//! Comparison of the methods of a machine at the same error bound.

use crate::analysis::ablation::{complete, machine_names};
use crate::observer::Observer;
use crate::options::{AnalysisPolicy, RunOptions};
use crate::run::result::{RunError, RunResult};
use basrelief_machines::{MachineConfig, MachineSpec, MethodNumber, MethodSpec, MethodSpecs, for_machine};
use basrelief_report::Report;
use basrelief_report::methods::{MethodComparison, MethodResult, figure};

/// MethodRuns the machine with each of its methods. If a method has a number, bisection over functional runs finds the number with the least
/// work whose measured error is within the configured bound. A later number that happens to be within the bound again is not found.
/// `run` performs one run of the same input with the given options and observer.
///
/// # Errors
/// A machine without methods, a run without time, a run that does not finish, and all errors of `run`.
pub fn compare_methods<E: From<RunError>>(
    settings: &RunOptions,
    observer: &mut dyn Observer,
    run: impl FnMut(&RunOptions, &mut dyn Observer) -> Result<RunResult, E>,
) -> Result<MethodComparison, E> {
    for_machine!(&settings.config, config => MethodRuns { settings, config, observer, run }.compare())
}

struct MethodRuns<'a, S, R> {
    settings: &'a RunOptions,
    config: &'a S,
    observer: &'a mut dyn Observer,
    run: R,
}

impl<S: MachineSpec, E: From<RunError>, R: FnMut(&RunOptions, &mut dyn Observer) -> Result<RunResult, E>> MethodRuns<'_, S, R>
where
    MachineConfig: From<S>,
{
    fn compare(mut self) -> Result<MethodComparison, E> {
        let no_methods = || RunError::NoMethods(S::NAME, machine_names(|machine| machine.has_methods));
        let specs = S::METHODS.ok_or_else(no_methods)?;
        let mut table: Option<MethodComparison> = None;
        for method in specs.methods {
            // Two pixels of a line are at most as far apart as the picture is wide.
            let limit = table.as_ref().map_or(1, |table| table.size.width).clamp(1, 16_384);
            let number = self.largest_number(&specs, method, limit)?;
            let (report, method) = self.run_method(method, number)?;
            table.get_or_insert_with(|| MethodComparison::of(&report, (specs.bound)(self.config))).methods.push(method);
        }
        table.ok_or_else(|| no_methods().into())
    }

    fn configured(&self, method: &MethodSpec<S>, number: u32) -> RunOptions {
        let mut config = self.config.clone();
        (method.set)(&mut config, number);
        RunOptions {
            config: config.into(),
            aux_outputs: vec![],
            bottlenecks: AnalysisPolicy::Never,
            recording: AnalysisPolicy::Never,
            ..self.settings.clone()
        }
    }

    fn run_method(&mut self, method: &MethodSpec<S>, number: u32) -> Result<(Report, MethodResult), E> {
        let name = (method.name)(number);
        let settings = self.configured(method, number);
        let report = complete(&name, (self.run)(&settings, self.observer)?)?;
        let method = MethodResult::of(name, (method.settings)(number), &report);
        Ok((report, method))
    }

    /// Finds the number of a method, 1 to `limit`; 0 if it has none.
    fn largest_number(&mut self, specs: &MethodSpecs<S>, method: &MethodSpec<S>, limit: u32) -> Result<u32, E> {
        let bound = (specs.bound)(self.config);
        let mut keeps = |number: u32| {
            let settings = RunOptions { engine: None, exact: false, ..self.configured(method, number) };
            let run = (self.run)(&settings, self.observer)?;
            Ok(figure(&run.report, specs.error) <= bound)
        };
        match method.number {
            MethodNumber::Absent => Ok(0),
            MethodNumber::Largest => last_true(1, limit, keeps),
            MethodNumber::Smallest => {
                last_true(0, limit - 1, |number| keeps(number).map(|keeps| !keeps)).map(|number| number + 1)
            }
        }
    }
}

/// Returns the last number up to `limit` with a property, by doubling and then bisection. Assumes that `first` has the property.
fn last_true<E>(first: u32, limit: u32, mut has: impl FnMut(u32) -> Result<bool, E>) -> Result<u32, E> {
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
    fn last_number_with_a_property_is_found_in_few_steps() {
        for (first, limit) in [(0, 700), (1, 700), (1, 1), (0, 0)] {
            for end in first..=limit {
                let mut asked = 0;
                let found = last_true(first, limit, |n| {
                    asked += 1;
                    assert!(n > first && n <= limit);
                    Ok::<_, ()>(n <= end)
                });
                assert_eq!(found, Ok(end));
                assert!(asked <= 20);
            }
        }
        assert_eq!(last_true(1, 9, |_| Err("no")), Err("no"));
    }
}
