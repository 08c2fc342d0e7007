//! Where the cycles of each unit went.

use super::markup::{Html, el, el_text, text};
use super::svg::{Part, bar, share};
use super::table::with_cells;
use crate::bottleneck::{Wait, largest_wait, waits};
use crate::model::{Report, Unit};
use crate::text::sections::cause;
use crate::text::table::Align::{Left, Right};

/// Colours of what a unit does, and what they mean.
pub(super) const STATES: [(&str, &str); 5] = [
    ("busy", "busy"),
    ("memory", "waiting for memory"),
    ("starved", "starved: nothing comes"),
    ("blocked", "blocked: no slot is free"),
    ("done", "done"),
];

/// What colours mean.
pub(super) fn legend<'a>(entries: impl IntoIterator<Item = (&'a str, &'a str)>) -> Html {
    let entries = entries.into_iter().map(|(class, meaning)| {
        let swatch = el("span", &[("class", &format!("swatch {class}")), ("aria-hidden", "true")], []);
        el("li", &[], [swatch, text(meaning)])
    });
    el("ul", &[("class", "legend")], entries)
}

/// Where a unit's cycles went, each cause by itself, and how many there are.
pub(super) fn parts(report: &Report, unit: &Unit) -> (Vec<Part>, u64) {
    let drain = report.drain_of(unit);
    let whole = report.cycles.as_ref().map_or(0, |cycles| cycles.total.saturating_sub(drain));
    let waited = |class| {
        let of = move |wait: &Wait<'_>| match wait {
            Wait::Memory(_) => class == "memory",
            Wait::Starved(_) => class == "starved",
            Wait::Blocked(_) => class == "blocked",
        };
        waits(unit).filter(move |(wait, n)| *n > 0 && of(wait)).map(move |(wait, n)| (class, cause(wait), n))
    };
    let parts = std::iter::once(("busy", "busy".to_owned(), unit.busy))
        .chain(["memory", "starved", "blocked"].into_iter().flat_map(waited))
        .chain([("done", "done".to_owned(), unit.done.saturating_sub(drain))]);
    (parts.filter(|(.., n)| *n > 0).collect(), whole)
}

/// A bar per unit.
pub(super) fn units(report: &Report) -> Html {
    let Some(units) = &report.units else { return Html::default() };
    let rows: Vec<Vec<Html>> = units.iter().map(|(name, unit)| row(report, name, unit)).collect();
    let columns = [("unit", Left), ("cycles of the frames", Left), ("busy", Right), ("waits most", Left), ("share", Right)];
    let table = with_cells("Units, in the order of the block diagram", &columns, rows);
    let drain = report.drain() > 0 && units.values().any(|unit| report.drain_of(unit) == 0);
    let note = "A unit that works on behind the last frame, as one that shows it, has all cycles of the run in its bar.";
    let note = if drain { el_text("p", "quiet", note) } else { Html::default() };
    [legend(STATES), el("div", &[("class", "bars")], [table]), note].into_iter().collect()
}

fn row(report: &Report, name: &str, unit: &Unit) -> Vec<Html> {
    let (parts, whole) = parts(report, unit);
    let wait = largest_wait(unit);
    let numeral = unit.numeral.map_or(Html::default(), |n| el_text("span", "quiet", format!(" ({n})")));
    vec![
        [text(name), numeral].into_iter().collect(),
        bar(&parts, whole),
        text(share(unit.busy, whole)),
        text(wait.map_or(String::new(), |(wait, _)| cause(wait))),
        text(wait.map_or(String::new(), |(_, n)| share(n, whole))),
    ]
}
