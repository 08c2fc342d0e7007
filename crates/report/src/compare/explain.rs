//! The change of time and cycles, and its causes, in words.

use super::comparison::{CauseShare, MeasuredCauses, WORK};
use super::time::Clocks;
use crate::area::NO_AREA;
use crate::model::Report;
use crate::number::{change_in_words, real, signed, thousands};

/// Causes below this share of the cycles of A are merged \[1/1000\].
const TOLD: u64 = 1;
/// Cure if nothing was measured.
const UNMEASURED: &str = "To measure the causes, keep the recording of both runs beside their reports: a short run without \
                          `--no-bottlenecks` keeps it, `--recording DIR/run.recording` keeps that of any run.";

pub(super) fn explain(a: &Report, b: &Report, equal: bool, explained: Option<&MeasuredCauses>) -> String {
    if equal {
        return "The reports are equal, host figures aside.".into();
    }
    let mut sentences = vec![];
    let is_one_machine = a.machine == b.machine;
    if !is_one_machine {
        sentences.push(format!(
            "The machines differ: A is {}, B is {}. Units and figures with the same name may mean different things. Each machine has draw \
             commands of its own, so the hashes of the inputs do not tell if the model is the same.",
            a.machine, b.machine
        ));
    } else if inputs_differ(a, b) {
        sentences.push("The inputs differ.".to_owned());
    }
    let mut unfinished = [("A", a), ("B", b)].into_iter().filter(|(_, report)| !report.outcome.is_complete()).peekable();
    let can_measure = is_one_machine && unfinished.peek().is_none();
    sentences.extend(unfinished.map(|(name, report)| {
        format!("{name} did not finish ({}). Its figures cover only the part that ran.", report.outcome.kind.name())
    }));
    sentences.push(match (&a.cycles, &b.cycles) {
        (Some(_), Some(_)) => {
            let why = explained.map(|explained| causes_in_words(explained, a.frame_cycles()));
            let terms = [a, b].map(Report::cycles_term);
            let term = if terms[0] == terms[1] { terms[0] } else { "cycles" };
            let cycles = cycles([a.frame_cycles(), b.frame_cycles()], term, why, can_measure);
            Clocks::of(a, b).sentences(a, b).into_iter().chain([cycles]).collect::<Vec<_>>().join(" ")
        }
        (None, None) => "Both runs are functional: they have no timing.".into(),
        _ => "One run is functional: there are no cycles to compare.".into(),
    });
    sentences.extend([("A", a), ("B", b)].into_iter().filter_map(|(name, report)| {
        let parts = report.warnings.iter().find_map(|warning| warning.strip_prefix(NO_AREA))?;
        Some(format!("The area of {name} has no meaning{parts}."))
    }));
    sentences.join(" ")
}

/// Returns true if the inputs are known to differ. A run that was cut short does not know its input to the end.
fn inputs_differ(a: &Report, b: &Report) -> bool {
    a.input.sha256 != b.input.sha256 && ![a, b].iter().any(|report| report.input.sha256.is_empty())
}

fn cycles([before, after]: [u64; 2], term: &str, why: Option<String>, can_measure: bool) -> String {
    let delta = i128::from(after) - i128::from(before);
    let relative = if before == 0 { String::new() } else { format!(" ({})", change_in_words(delta as f64 / before as f64)) };
    let head = match delta {
        0 => format!("Both runs take {} {term}", thousands(after)),
        1 | -1 => format!("B takes 1 {} {}{relative}", term.trim_end_matches('s'), if delta > 0 { "more" } else { "less" }),
        _ => format!("B takes {} {} {term}{relative}", real(delta.abs() as f64), more_or_fewer(delta)),
    };
    match why {
        Some(why) => format!("{head}{why}."),
        None if delta == 0 || !can_measure => format!("{head}."),
        None => format!("{head}. {UNMEASURED}"),
    }
}

fn more_or_fewer(delta: i128) -> &'static str {
    if delta > 0 { "more" } else { "fewer" }
}

/// The cause in words.
pub(crate) fn cause_name(share: &CauseShare) -> String {
    let keys: Vec<&str> = share.set.iter().filter_map(|set| Some(set.split_once('=')?.0)).collect();
    match (share.parameter.as_str(), keys.is_empty()) {
        (WORK, true) => "input".into(),
        (WORK, false) => format!("work parameters ({})", keys.join(", ")),
        (parameter, _) => parameter.into(),
    }
}

/// The causes, the largest first: the end of the sentence, or a sentence of its own.
fn causes_in_words(explained: &MeasuredCauses, before: u64) -> String {
    let inseparable: Vec<String> = explained.shares.iter().filter(|share| share.by.is_none()).map(cause_name).collect();
    let counts = explained.shares.iter().filter_map(|share| Some((cause_name(share), share.by.filter(|by| *by != 0)?)));
    let counts: Vec<(String, i64)> = counts.collect();
    if let ([(name, _)], 0, true) = (&*counts, explained.together, inseparable.is_empty()) {
        return format!(", all due to {name}");
    }
    let is_listed = |by: i64| by.unsigned_abs().saturating_mul(1000) >= before.saturating_mul(TOLD);
    // If all causes are small, all are listed.
    let (listed, small): (Vec<_>, Vec<_>) = match counts.iter().any(|(_, by)| is_listed(*by)) {
        true => counts.into_iter().partition(|(_, by)| is_listed(*by)),
        false => (counts, vec![]),
    };
    let mut other: i64 = small.iter().map(|(_, by)| by).sum();
    let cycles = |name: &str, by: i64| format!("{name}: {}", signed(by as f64));
    let mut parts: Vec<String> = listed.iter().map(|(name, by)| cycles(name, *by)).collect();
    let left = explained.together;
    if !inseparable.is_empty() {
        let names = inseparable.join(" and ");
        parts.push(if left == 0 { format!("{names}: not separable") } else { cycles(&format!("{names} (not separable)"), left) });
    } else if is_listed(left) || parts.is_empty() && left != 0 {
        parts.push(cycles("interaction", left));
    } else {
        other += left;
    }
    if other != 0 {
        parts.push(cycles("other", other));
    }
    if parts.is_empty() { String::new() } else { format!(". Causes, each alone: {}", parts.join("; ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::compare;
    use crate::samples;

    /// The sentence about a run of 1,000,000 cycles and one of 400,000.
    fn sentence(shares: &[(&str, Option<i64>)], together: i64) -> String {
        let share = |(parameter, by): &(&str, Option<i64>)| CauseShare {
            parameter: (*parameter).into(),
            derived: vec![],
            set: vec![format!("{}=1", if *parameter == WORK { "a.b" } else { parameter })],
            needs_run: false,
            cycles: by.map(|by| (1_000_000 + by) as u64),
            by: *by,
            share: None,
        };
        let (a, b) = samples::before_and_after();
        compare(&a, &b, Some(MeasuredCauses { shares: shares.iter().map(share).collect(), together })).explanation
    }

    #[test]
    fn causes_are_sorted_and_small_ones_merged() {
        let two = [("memory.graphics", Some(-500_000)), (WORK, Some(-80_000))];
        let head = "B takes 600,000 fewer render cycles (-60 %). Causes, each alone: memory.graphics: -500,000; work parameters \
                    (a.b): -80,000";
        assert_eq!(sentence(&two, -20_000), format!("{head}; interaction: -20,000."));
        assert_eq!(sentence(&two, 0), format!("{head}."));
        let more = [two.as_slice(), &[("fifo.a", Some(-999)), ("fifo.b", Some(99)), ("fifo.c", Some(0))]].concat();
        assert_eq!(sentence(&more, -19_100), format!("{head}; interaction: -19,100; other: -900."));
        assert_eq!(sentence(&more, 10), format!("{head}; other: -890."));
    }

    #[test]
    fn incomplete_run_is_named_first() {
        let (a, mut b) = samples::before_and_after();
        b.outcome.kind = crate::model::OutcomeKind::Limit;
        let first = "B did not finish (limit). Its figures cover only the part that ran. B takes 600,000 fewer cycles (-60 %).";
        assert_eq!(compare(&a, &b, None).explanation, first);
    }

    #[test]
    fn single_cause_needs_no_list() {
        let short = "B takes 600,000 fewer render cycles (-60 %), all due to memory.graphics.";
        assert_eq!(sentence(&[("memory.graphics", Some(-600_000))], 0), short);
        assert_eq!(sentence(&[("memory.graphics", Some(-600_000)), ("fifo.a", Some(0))], 0), short);
        assert!(
            sentence(&[("fifo.a", Some(0)), ("fifo.b", Some(0))], -600_000)
                .ends_with("%). Causes, each alone: interaction: -600,000.")
        );
        let small = sentence(&[("fifo.a", Some(-9)), ("fifo.b", Some(7))], 2);
        assert!(small.ends_with("%). Causes, each alone: fifo.a: -9; fifo.b: +7; other: +2."), "{small}");
    }

    #[test]
    fn inseparable_causes_share_the_rest() {
        let shares = [("fifo.a", Some(-500_000)), ("memory.graphics", None), (WORK, None)];
        let end = "memory.graphics and work parameters (a.b) (not separable): -100,000.";
        assert!(sentence(&shares, -100_000).ends_with(&format!("fifo.a: -500,000; {end}")));
        assert!(sentence(&shares[..2], 0).ends_with("fifo.a: -500,000; memory.graphics: not separable."));
    }

    #[test]
    fn missing_recording_reports_difference_and_cure() {
        let (a, b) = samples::before_and_after();
        let explanation = compare(&a, &b, None).explanation;
        assert!(explanation.starts_with("B takes 600,000 fewer render cycles (-60 %). To measure the causes, "), "{explanation}");
        assert!(compare(&b, &a, None).explanation.starts_with("B takes 600,000 more render cycles (+150 %). "));
    }

    #[test]
    fn incomparable_runs_are_reported() {
        let (a, mut b) = (samples::balanced(), samples::functional());
        assert!(compare(&a, &b, None).explanation.contains("there are no cycles to compare"));
        let other = compare(&a, &samples::with_routes(), None).explanation;
        assert!(other.starts_with("The machines differ: A is bump, B is shade."), "{other}");
        assert!(!other.contains("The inputs differ"), "{other}");
        assert!(!other.contains("tape"), "{other}");
        b.input.sha256 = "cd".repeat(32);
        let functional = samples::functional();
        assert!(compare(&functional, &b, None).explanation.starts_with("The inputs differ. Both runs are functional"));
        b.input.sha256.clear();
        assert!(compare(&functional, &b, None).explanation.starts_with("Both runs are functional"));
    }
}
