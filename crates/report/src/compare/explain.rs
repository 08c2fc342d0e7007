//! Which unit and cause account for the change of the cycles.

use crate::blame::{Wait, waits};
use crate::model::{Report, Unit};
use crate::text::number::{real, signed};
use crate::text::{cause, number};

/// One cause of one unit and by how many cycles it changed.
struct Part {
    what: String,
    /// Made by the unit itself: work, or its wait for memory.
    own: bool,
    delta: i128,
}

pub(super) fn explain(a: &Report, b: &Report, equal: bool) -> String {
    if equal {
        return "The reports are equal, host figures aside.".into();
    }
    let mut sentences = vec![];
    if a.machine != b.machine {
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
        (Some(_), Some(_)) => cycles(a, b, (a.frame_cycles(), b.frame_cycles())),
        (None, None) => "Both runs are functional: they have no time.".into(),
        _ => "One of the runs is functional: there are no cycles to compare.".into(),
    });
    sentences.join(" ")
}

fn cycles(a: &Report, b: &Report, (before, after): (u64, u64)) -> String {
    let delta = i128::from(after) - i128::from(before);
    if delta == 0 {
        return format!("Both runs take {} cycles.", number::thousands(after));
    }
    let more = if delta > 0 { "more" } else { "fewer" };
    let relative = if before == 0 { String::new() } else { format!(" ({})", percent(delta as f64 / before as f64)) };
    let head = format!("B takes {} cycles {more}{relative}", real(delta.abs() as f64));
    match explaining_unit(a, b, delta) {
        Some((name, parts)) => {
            let list: Vec<String> = parts.iter().take(4).map(|p| format!("{} {}", p.what, signed(p.delta as f64))).collect();
            format!("{head}, mostly through {name}: {}.", list.join(", "))
        }
        None => format!("{head}; no unit that both reports have worked or waited for memory any {} than before.", longer(delta)),
    }
}

fn longer(delta: i128) -> &'static str {
    if delta > 0 { "longer" } else { "shorter" }
}

fn percent(share: f64) -> String {
    format!("{} %", signed((1000.0 * share).round() / 10.0))
}

/// The unit whose own cycles changed most in the direction of `delta`, with all its parts, the largest first.
fn explaining_unit(a: &Report, b: &Report, delta: i128) -> Option<(String, Vec<Part>)> {
    let (before, after) = (a.units.as_ref()?, b.units.as_ref()?);
    let drains = (a.drain(), b.drain());
    let all = after.iter().filter_map(|(name, unit)| Some((name, parts(before.get(name)?, unit, drains))));
    let along = |parts: &[Part]| parts.iter().filter(|p| p.own).map(|p| p.delta).sum::<i128>() * delta.signum();
    let best = all.map(|(name, p)| (along(&p), name, p)).reduce(|best, u| if u.0 > best.0 { u } else { best });
    best.filter(|&(own, ..)| own > 0).map(|(_, name, parts)| (name.clone(), parts))
}

/// How the cycles of a unit changed, cause by cause; over all causes this is the change of the frames' cycles.
fn parts(before: &Unit, after: &Unit, drains: (u64, u64)) -> Vec<Part> {
    let mut parts = vec![];
    let mut add = |what: String, own: bool, before: u64, after: u64| {
        parts.push(Part { what, own, delta: i128::from(after) - i128::from(before) });
    };
    add("busy".into(), true, before.busy, after.busy);
    for (wait, n) in waits(after) {
        add(cause(wait), matches!(wait, Wait::Memory(_)), cycles_of(before, wait).unwrap_or(0), n);
    }
    for (wait, n) in waits(before).filter(|&(wait, _)| cycles_of(after, wait).is_none()) {
        add(cause(wait), matches!(wait, Wait::Memory(_)), n, 0);
    }
    add("done".into(), false, before.done.saturating_sub(drains.0), after.done.saturating_sub(drains.1));
    parts.retain(|p| p.delta != 0);
    parts.sort_by_key(|p| std::cmp::Reverse(p.delta.abs()));
    parts
}

fn cycles_of(unit: &Unit, wait: Wait<'_>) -> Option<u64> {
    match wait {
        Wait::Starved(fifo) => unit.starved.get(fifo),
        Wait::Blocked(fifo) => unit.blocked.get(fifo),
        Wait::Memory(client) => unit.memory.get(client),
    }
    .copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::compare;
    use crate::samples;

    #[test]
    fn the_unit_that_worked_less_explains_the_gain() {
        let (a, b) = samples::before_and_after();
        assert_eq!(
            compare(&a, &b).explanation,
            "B takes 600,000 cycles fewer (-60 %), mostly through replacement: busy -690,000, starved: pseudo_normals \
             +90,000."
        );
        let back = compare(&b, &a).explanation;
        assert!(back.starts_with("B takes 600,000 cycles more (+150 %), mostly through replacement: busy +690,000"));
    }

    #[test]
    fn the_parts_of_every_unit_sum_to_the_change_of_the_total() {
        let (a, b) = samples::before_and_after();
        for (name, after) in b.units.as_ref().unwrap() {
            let sum: i128 = parts(&a.units.as_ref().unwrap()[name], after, (a.drain(), b.drain())).iter().map(|p| p.delta).sum();
            assert_eq!(sum, -600_000, "{name}");
        }
    }

    #[test]
    fn what_cannot_be_compared_is_said() {
        let (a, mut b) = (samples::balanced(), samples::functional());
        assert!(compare(&a, &b).explanation.contains("there are no cycles to compare"));
        let other = compare(&a, &samples::with_routes()).explanation;
        assert!(other.starts_with("The machines differ: A is bump, B is shade;"), "{other}");
        b.input.sha256 = "cd".repeat(32);
        assert!(compare(&samples::functional(), &b).explanation.starts_with("The inputs differ. Both runs are functional"));
        b.input.sha256.clear();
        assert!(compare(&samples::functional(), &b).explanation.starts_with("Both runs are functional"));
    }
}
