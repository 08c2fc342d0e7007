//! Cycle breakdown of each unit.

use super::markup::{Html, breakable, el, el_text, text};
use super::svg::{BarPart, bar, percent_of};
use super::table::with_cells;
use crate::bottleneck::{Stall, largest_stall, stalls};
use crate::model::{Report, Unit};
use crate::text::sections::cause;
use crate::text::table::Align::{Left, Right};

/// Classes of the states of a unit, and their names in the legend.
pub(super) const STATES: [(&str, &str); 5] = [
    ("busy", "busy"),
    ("memory", "waiting for memory"),
    ("starved", "starved (input FIFO empty)"),
    ("blocked", "blocked (output FIFO full)"),
    ("done", "done"),
];

/// Legend of colours.
pub(super) fn legend<'a>(entries: impl IntoIterator<Item = (&'a str, &'a str)>) -> Html {
    let entries = entries.into_iter().map(|(class, meaning)| {
        let swatch = el("span", &[("class", &format!("swatch {class}")), ("aria-hidden", "true")], []);
        el("li", &[], [swatch, text(meaning)])
    });
    el("ul", &[("class", "legend")], entries)
}

/// Parts of the cycle breakdown of a unit, and their sum.
pub(super) fn breakdown_parts(report: &Report, unit: &Unit) -> (Vec<BarPart>, u64) {
    let whole = report.breakdown_cycles();
    let after = report.cycles.as_ref().map_or(0, |cycles| cycles.total.saturating_sub(whole));
    let waited = |class| {
        let of = move |wait: &Stall<'_>| match wait {
            Stall::Memory(_) => class == "memory",
            Stall::Starved(_) => class == "starved",
            Stall::Blocked(_) => class == "blocked",
        };
        stalls(unit).filter(move |(wait, n)| *n > 0 && of(wait)).map(move |(wait, n)| (class, cause(wait), n))
    };
    let parts = std::iter::once(("busy", "busy".to_owned(), unit.busy))
        .chain(["memory", "starved", "blocked"].into_iter().flat_map(waited))
        .chain([("done", "done".to_owned(), unit.done.saturating_sub(after))]);
    (parts.filter(|(.., n)| *n > 0).collect(), whole)
}

/// A bar per unit.
pub(super) fn units(report: &Report) -> Html {
    let Some(units) = &report.units else { return Html::default() };
    let rows: Vec<Vec<Html>> = units.iter().map(|(name, unit)| row(report, name, unit)).collect();
    let base = if report.breakdown_cycles() == report.frame_cycles() { "render cycles" } else { "all cycles of the run" };
    let columns = [("unit", Left), ("", Left), ("busy", Right), ("main stall", Left), ("share", Right)];
    let table = with_cells(&format!("Units, in the order of the block diagram, by {base}"), &columns, rows);
    [legend(STATES), el("div", &[("class", "bars")], [table])].into_iter().collect()
}

fn row(report: &Report, name: &str, unit: &Unit) -> Vec<Html> {
    let (parts, whole) = breakdown_parts(report, unit);
    let wait = largest_stall(unit);
    let numeral = unit.numeral.map_or(Html::default(), |n| el_text("span", "quiet", format!(" ({n})")));
    vec![
        [text(name), numeral].into_iter().collect(),
        bar(&parts, whole),
        text(percent_of(unit.busy, whole)),
        breakable(wait.map_or(String::new(), |(wait, _)| cause(wait))),
        text(wait.map_or(String::new(), |(_, n)| percent_of(n, whole))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    /// A unit such as the video output works after the last frame. The breakdowns of all units then cover all cycles.
    #[test]
    fn breakdowns_of_all_units_have_the_same_base() {
        let mut report = samples::balanced();
        let total = samples::TOTAL;
        report.cycles.as_mut().unwrap().drain = 1_000;
        for (done_of_last, base) in [(1_000, total - 1_000), (999, total), (0, total)] {
            let units = report.units.as_mut().unwrap();
            let last = units.len() - 1;
            for (at, unit) in units.values_mut().enumerate() {
                let done = if at == last { done_of_last } else { 5_000 };
                (unit.busy, unit.done) = (unit.busy + unit.done - done, done);
            }
            for (name, unit) in report.units.as_ref().unwrap() {
                let (parts, whole) = breakdown_parts(&report, unit);
                assert_eq!((whole, parts.iter().map(|(.., cycles)| cycles).sum()), (base, base), "{name}, {done_of_last}");
            }
        }
    }
}
