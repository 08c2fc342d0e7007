//! What limits a run, as it was measured: a sentence, and a table.

use super::table::{Align, Table};
use crate::model::{Limit, PathPart, PathPolygon, PathPolygons, Report};
use crate::number::{about, percent, thousands};
use Align::{Left, Right};

/// Most rows of the table.
const ROWS: usize = 8;
/// Most parts of the critical path in its sentence.
const PARTS: usize = 4;
/// What is worth a word beside the first \[share of the cycles\].
const WORTH: f64 = 0.01;

/// The first two in words, and what helps most together; none where nothing was measured.
pub(super) fn sentence(report: &Report) -> Option<String> {
    let limits = report.limits.as_ref()?;
    let total = report.frame_cycles();
    let share = |limit: &Limit| limit.saved as f64 / total.max(1) as f64;
    let (pairs, singles): (Vec<&Limit>, Vec<&Limit>) = limits.iter().partition(|limit| is_pair(limit));
    let says = |limit: &Limit| format!("{} with {} saves {}", limit.resource, limit.what, about(share(limit)));
    let Some(first) = singles.first().or(pairs.first()) else {
        let same = "it takes as many cycles with any unit, FIFO, memory or cache made ideal";
        return Some(format!("Nothing limits this run by itself: {same}."));
    };
    // Another way to better the same thing says nothing new.
    let second = singles.iter().skip(1).find(|l| l.resource != first.resource && share(l) >= WORTH);
    let pair = pairs.first().filter(|pair| share(pair) >= share(first) + WORTH);
    let more: String = second.into_iter().chain(pair).map(|limit| format!("; {}", says(limit))).collect();
    Some(format!("What limits this run: {} of the cycles{more}.", says(first)))
}

/// The first parts of the critical path; none where it is not known.
pub(super) fn path(report: &Report) -> Option<String> {
    let path = report.critical_path.as_ref()?;
    let parts: Vec<String> = path.parts.iter().take(PARTS).map(|part| part_text(part, path.cycles)).collect();
    let polygons = path.polygons.as_ref().map_or(String::new(), |polygons| by_polygon(polygons, path.cycles));
    Some(format!("Critical path, one of several that may be as long: {}.{polygons}", parts.join(", ")))
}

/// The polygons with most of the path, in a sentence.
pub(crate) fn by_polygon(polygons: &PathPolygons, total: u64) -> String {
    let part = |PathPolygon { frame, polygon, cycles, .. }: &PathPolygon| {
        format!("polygon {polygon} of frame {frame} ({})", about(*cycles as f64 / total.max(1) as f64))
    };
    let parts: Vec<String> = polygons.listed.iter().take(PARTS).map(part).collect();
    if parts.is_empty() { String::new() } else { format!(" Most of it is for {}.", parts.join(", ")) }
}

fn part_text(PathPart { resource, what, cycles, .. }: &PathPart, total: u64) -> String {
    let share = about(*cycles as f64 / total.max(1) as f64);
    format!("{share} {resource} {what}").replace("  ", " ")
}

fn is_pair(limit: &Limit) -> bool {
    limit.resource.contains(" and ")
}

/// The first few.
pub(super) fn table(report: &Report) -> Table {
    let mut table = Table::new(&[("Made ideal", Left, 0), ("how", Left, 0), ("cycles", Right, 0), ("saved %", Right, 0)]);
    let total = report.frame_cycles();
    for limit in report.limits.iter().flatten().take(ROWS) {
        let Limit { resource, what, cycles, saved, .. } = limit;
        table.row([resource.clone(), what.clone(), thousands(*cycles), percent(*saved, total)]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;
    use crate::text::Style;

    fn limit(resource: &str, what: &str, saved: u64, total: u64) -> Limit {
        let set = vec![format!("ideal.units={resource}")];
        Limit { resource: resource.into(), what: what.into(), set, cycles: total - saved, saved }
    }

    #[test]
    fn the_first_two_stand_in_a_sentence_and_the_rest_in_the_table() {
        let mut report = samples::simulated();
        let total = report.frame_cycles();
        assert_eq!(sentence(&report), None);
        report.limits = Some(vec![]);
        assert!(sentence(&report).unwrap().starts_with("Nothing limits"));
        report.limits = Some(vec![
            limit("search", "a cycle per step", total / 2, total),
            limit("search and reader", "a cycle per step", total / 2, total),
            limit("texels", "no latency", total / 4, total),
        ]);
        let expected =
            "What limits this run: search with a cycle per step saves 50 % of the cycles; texels with no latency saves 25 %.";
        assert_eq!(sentence(&report).unwrap(), expected);
        assert_eq!(table(&report).render(Style::default()).lines().count(), 5);
    }
}
