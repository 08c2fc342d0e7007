//! Comparison of two runs: attributes the difference in cycles to the parameters that the user changed.
//!
//! A *cause* is a parameter with different values that the user of one run has set. Values that follow from it, such as the timings of a
//! memory part, change with it. A *mixture* is run A with some causes as in B.
//!
//! - The effect of a cause *alone* is the change of the cycles of A if only this cause is as in B.
//! - The *share* of a cause is its Shapley value: its mean effect over all orders in which the causes can change. Shares add up to the
//!   whole difference. They need a mixture of every subset of the causes, so they are measured for up to [`FEW`] causes.
//! - The interaction is the difference beyond the sum of all effects alone.
//!
//! Timing parameters need a resimulation. Mixtures of several work parameters need a run, except that those with all work parameters
//! as in A or as in B have a recording already.

use super::mixtures::Mixtures;
use super::recorded_run::{Cause, ExplainOptions, RecordedRun};
use basrelief_machines::MachineConfig;
use basrelief_parameters::{Effect, Parameter};
use basrelief_report::compare::WORK;
use basrelief_report::{CauseShare, MeasuredCauses};

/// Largest number of causes with measured shares.
const FEW: usize = 4;

/// Explains the difference in cycles of `b` against `a`. Returns `None` if the machines are different.
pub fn explain(a: &RecordedRun, b: &RecordedRun, options: &ExplainOptions<'_>) -> Option<MeasuredCauses> {
    if a.config().machine().name != b.config().machine().name {
        return None;
    }
    let same_input = a.recording.result.input.sha256 == b.recording.result.input.sha256;
    let runs = options.input.filter(|_| same_input);
    let causes = separable(a, b, changed(a, b), &|| runs.is_some_and(|open| open().is_some()));
    let wanted = wanted_subsets(causes.len());
    let mixtures = Mixtures::measure(a, b, &causes, &wanted, &ExplainOptions { input: runs, ..*options });
    let total = b.cycles as i64 - a.cycles as i64;
    let shares = mixtures.shapley_values();
    let cause_share = |(n, cause): (usize, &Cause)| {
        let alone = mixtures.get(1 << n);
        CauseShare {
            parameter: cause.name.clone(),
            derived: alone.map_or(vec![], |alone| alone.derived.clone()),
            set: cause.set.iter().map(|(key, value)| format!("{key}={value}")).collect(),
            needs_run: alone.is_some_and(|alone| alone.needed_run),
            cycles: alone.map(|alone| alone.cycles),
            by: alone.map(|alone| alone.cycles as i64 - a.cycles as i64),
            share: shares.as_ref().map(|shares| shares[n]),
        }
    };
    let mut shares: Vec<CauseShare> = causes.iter().enumerate().map(cause_share).collect();
    // The sort is stable: ties keep the order of the block diagram, and causes that are not measured come last.
    shares.sort_by_key(|share| std::cmp::Reverse(share.by.map(i64::unsigned_abs)));
    let alone: i64 = shares.iter().filter_map(|share| share.by).sum();
    Some(MeasuredCauses { shares, together: total - alone })
}

/// Returns the parameters that differ and that the user of one run has set, in the order of the block diagram. Values of B that do not
/// follow from these, for example defaults of another build, come last.
fn changed(a: &RecordedRun, b: &RecordedRun) -> Vec<Cause> {
    let given = |key: &str| [a, b].iter().any(|run| run.recording.overrides.contains(key));
    let of_b = b.config().parameters();
    let differing = |here: &MachineConfig| {
        let all: Vec<Parameter> = here
            .parameters()
            .into_iter()
            .zip(&of_b)
            .filter(|(here, b)| here.default != b.default)
            .map(|(_, b)| b.clone())
            .collect();
        all
    };
    let given: Vec<Parameter> = differing(a.config()).into_iter().filter(|b| given(&b.key)).collect();
    let settings: Vec<(String, String)> = given.iter().map(|b| (b.key.clone(), b.as_option())).collect();
    let rest = a.recording.config_with(&settings).map(|all| differing(&all)).unwrap_or_default();
    let causes = given.into_iter().chain(rest).filter(|b| b.effect != Effect::Cost);
    causes
        .map(|b| Cause { name: b.key.clone(), set: vec![(b.key.clone(), b.as_option())], is_work: b.effect == Effect::Work })
        .collect()
}

/// Joins the work parameters if they cannot be measured one by one, because the machine must not run or the inputs differ. If the work
/// differs although no work parameter does, for example because of another input, that is a cause of its own.
fn separable(a: &RecordedRun, b: &RecordedRun, causes: Vec<Cause>, may_run: &dyn Fn() -> bool) -> Vec<Cause> {
    let (work, timing): (Vec<Cause>, Vec<Cause>) = causes.into_iter().partition(|cause| cause.is_work);
    let differs = !work.is_empty() || a.recording.work != b.recording.work;
    let one_by_one = work.len() == 1 || !work.is_empty() && may_run();
    let same_input = a.recording.result.input.sha256 == b.recording.result.input.sha256;
    match (differs, one_by_one && same_input) {
        (false, _) => timing,
        (true, true) => work.into_iter().chain(timing).collect(),
        (true, false) => {
            let set: Vec<_> = work.into_iter().flat_map(|cause| cause.set).collect();
            let joined = Cause { name: WORK.into(), set, is_work: true };
            [joined].into_iter().chain(timing).collect()
        }
    }
}

/// Returns the subsets of the causes to measure, as bit masks: all of a few causes, and otherwise each cause alone.
fn wanted_subsets(causes: usize) -> Vec<u64> {
    if causes <= FEW { (0..1 << causes).collect() } else { (0..causes.min(63)).map(|n| 1 << n).collect() }
}
