//! What explains the change of the cycles, in a sentence.

use super::comparison::{Explained, Share, WORK};
use crate::model::Report;
use crate::number::{real, signed, thousands};

/// Shares below this part of A's cycles are told as one \[1/1000\].
const TOLD: u64 = 1;
/// What to do where nothing was measured.
const UNMEASURED: &str = "What explains it can be measured where both runs have their tape beside the report: `--out DIR` leaves it \
                          there if the run is short and its limits are measured, `--tape DIR/run.tape` however long it is.";

pub(super) fn explain(a: &Report, b: &Report, (equal, explained): (bool, Option<&Explained>)) -> String {
    if equal {
        return "The reports are equal, host figures aside.".into();
    }
    let mut sentences = vec![];
    let is_one_machine = a.machine == b.machine;
    if !is_one_machine {
        sentences.push(format!(
            "The machines differ: A is {}, B is {}; units and figures of one name need not mean the same.",
            a.machine, b.machine
        ));
    }
    // A run that was cut short does not know its input to the end.
    if a.input.sha256 != b.input.sha256 && ![a, b].iter().any(|r| r.input.sha256.is_empty()) {
        sentences.push("The inputs differ.".to_owned());
    }
    sentences.push(match (&a.cycles, &b.cycles) {
        (Some(_), Some(_)) => {
            let why = explained.map(|explained| why(explained, a.frame_cycles()));
            cycles((a.frame_cycles(), b.frame_cycles()), why, is_one_machine)
        }
        (None, None) => "Both runs are functional: they have no time.".into(),
        _ => "One of the runs is functional: there are no cycles to compare.".into(),
    });
    sentences.join(" ")
}

fn cycles((before, after): (u64, u64), why: Option<String>, is_one_machine: bool) -> String {
    let delta = i128::from(after) - i128::from(before);
    let relative = if before == 0 { String::new() } else { format!(" ({})", percent(delta as f64 / before as f64)) };
    let head = match delta {
        0 => format!("Both runs take {} cycles", thousands(after)),
        _ => format!("B takes {} cycles {}{relative}", real(delta.abs() as f64), more(delta)),
    };
    match why {
        Some(why) => format!("{head}{why}."),
        None if delta == 0 || !is_one_machine => format!("{head}."),
        None => format!("{head}. {UNMEASURED}"),
    }
}

fn more(delta: i128) -> &'static str {
    if delta > 0 { "more" } else { "fewer" }
}

fn percent(share: f64) -> String {
    format!("{} %", signed((1000.0 * share).round() / 10.0))
}

/// So many cycles.
fn by(delta: i64) -> String {
    format!("{} {}", thousands(delta.unsigned_abs()), more(delta.into()))
}

/// The group in words.
fn named(share: &Share) -> &str {
    if share.group == WORK { "what the units do" } else { &share.group }
}

/// The end of the sentence: the shares, the largest first.
fn why(explained: &Explained, before: u64) -> String {
    let apart: Vec<&str> = explained.shares.iter().filter(|share| share.by.is_none()).map(named).collect();
    let counts = explained.shares.iter().filter_map(|share| Some((named(share), share.by.filter(|by| *by != 0)?)));
    let counts: Vec<(&str, i64)> = counts.collect();
    if let ([(name, _)], 0, true) = (&*counts, explained.together, apart.is_empty()) {
        return format!(", all through {name}");
    }
    let is_told = |by: i64| by.unsigned_abs().saturating_mul(1000) >= before.saturating_mul(TOLD);
    // Where all are small, the rest would be all.
    let (told, small): (Vec<_>, Vec<_>) = match counts.iter().any(|(_, by)| is_told(*by)) {
        true => counts.into_iter().partition(|(_, by)| is_told(*by)),
        false => (counts, vec![]),
    };
    let mut rest: i64 = small.iter().map(|(_, by)| by).sum();
    let told: Vec<String> = told.into_iter().map(|(name, delta)| format!("{} through {name}", by(delta))).collect();
    let mut parts = if told.is_empty() { vec![] } else { vec![told.join(", ")] };
    match (&*apart, explained.together) {
        ([], together) if is_told(together) || parts.is_empty() && together != 0 => {
            parts.push(format!("{} only together", by(together)));
        }
        ([], together) => rest += together,
        (apart, 0) => parts.push(format!("{} cannot be timed apart", apart.join(" and "))),
        (apart, left) => parts.push(format!("{} through {}, which cannot be timed apart", by(left), apart.join(" and "))),
    }
    if rest != 0 {
        parts.push(format!("{} through the rest", by(rest)));
    }
    if parts.is_empty() { String::new() } else { format!(": {}", parts.join("; ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::compare;
    use crate::samples;

    /// The sentence about a run of 1,000,000 cycles and one of 400,000.
    fn sentence(shares: &[(&str, Option<i64>)], together: i64) -> String {
        let share = |(group, by): &(&str, Option<i64>)| {
            let cycles = by.map(|by| (400_000 - by) as u64);
            Share { group: (*group).into(), set: vec![], cycles, by: *by }
        };
        let (a, b) = samples::before_and_after();
        compare(&a, &b, Some(Explained { shares: shares.iter().map(share).collect(), together })).explanation
    }

    #[test]
    fn shares_are_told_the_largest_first_and_small_ones_as_the_rest() {
        let two = [("memory.graphics", Some(-500_000)), (WORK, Some(-80_000))];
        let head =
            "B takes 600,000 cycles fewer (-60 %): 500,000 fewer through memory.graphics, 80,000 fewer through what the units do";
        assert_eq!(sentence(&two, -20_000), format!("{head}; 20,000 fewer only together."));
        assert_eq!(sentence(&two, 0), format!("{head}."));
        let more = [two.as_slice(), &[("fifo.a", Some(-999)), ("fifo.b", Some(99)), ("fifo.c", Some(0))]].concat();
        assert_eq!(sentence(&more, -19_100), format!("{head}; 19,100 fewer only together; 900 fewer through the rest."));
        assert_eq!(sentence(&more, 10), format!("{head}; 890 fewer through the rest."));
    }

    #[test]
    fn one_share_needs_no_list() {
        let short = "B takes 600,000 cycles fewer (-60 %), all through memory.graphics.";
        assert_eq!(sentence(&[("memory.graphics", Some(-600_000))], 0), short);
        assert_eq!(sentence(&[("memory.graphics", Some(-600_000)), ("fifo.a", Some(0))], 0), short);
        assert!(sentence(&[("fifo.a", Some(0)), ("fifo.b", Some(0))], -600_000).ends_with("%): 600,000 fewer only together."));
        let small = sentence(&[("fifo.a", Some(-9)), ("fifo.b", Some(7))], 2);
        assert!(small.ends_with("%): 9 fewer through fifo.a, 7 more through fifo.b; 2 more through the rest."), "{small}");
    }

    #[test]
    fn what_cannot_be_timed_apart_is_named_and_has_what_is_left() {
        let shares = [("fifo.a", Some(-500_000)), ("memory.graphics", None), (WORK, None)];
        let end = "memory.graphics and what the units do, which cannot be timed apart.";
        assert!(sentence(&shares, -100_000).ends_with(&format!("fifo.a; 100,000 fewer through {end}")));
        assert!(sentence(&shares[..2], 0).ends_with("fifo.a; memory.graphics cannot be timed apart."));
    }

    #[test]
    fn without_a_tape_the_difference_is_told_and_what_would_explain_it() {
        let (a, b) = samples::before_and_after();
        let told = compare(&a, &b, None).explanation;
        assert!(told.starts_with("B takes 600,000 cycles fewer (-60 %). What explains it can be measured where "), "{told}");
        assert!(compare(&b, &a, None).explanation.starts_with("B takes 600,000 cycles more (+150 %). "));
    }

    #[test]
    fn what_cannot_be_compared_is_said() {
        let (a, mut b) = (samples::balanced(), samples::functional());
        assert!(compare(&a, &b, None).explanation.contains("there are no cycles to compare"));
        let other = compare(&a, &samples::with_routes(), None).explanation;
        assert!(other.starts_with("The machines differ: A is bump, B is shade;"), "{other}");
        assert!(!other.contains("tape"), "{other}");
        b.input.sha256 = "cd".repeat(32);
        let functional = samples::functional();
        assert!(compare(&functional, &b, None).explanation.starts_with("The inputs differ. Both runs are functional"));
        b.input.sha256.clear();
        assert!(compare(&functional, &b, None).explanation.starts_with("Both runs are functional"));
    }
}
