//! Measured bottlenecks: a sentence and a table.

use super::table::{Align, Table};
use crate::model::{FULLY_PIPELINED, PathPart, PathPolygon, PathPolygons, RelaxedCycles, Report, UNBOUNDED_FIFO};
use crate::number::{percent, percent_in_words, thousands};
use Align::{Left, Right};

/// Maximum number of rows of the table.
const ROWS: usize = 8;
/// Maximum number of parts of the critical path in its sentence.
const PARTS: usize = 4;
/// Smallest second saving that the sentence mentions \[share of the cycles\].
const WORTH: f64 = 0.01;

/// The two largest savings, and the pair that saves most together. Returns `None` if nothing was measured.
pub(super) fn sentence(report: &Report) -> Option<String> {
    let limits = report.limits.as_ref()?;
    let total = report.frame_cycles();
    let share = |limit: &RelaxedCycles| limit.saved as f64 / total.max(1) as f64;
    let (pairs, singles): (Vec<&RelaxedCycles>, Vec<&RelaxedCycles>) = limits.iter().partition(|limit| is_pair(limit));
    let Some(first) = singles.first().or(pairs.first()) else {
        return Some("No single bottleneck: relaxing any one unit, FIFO, memory or cache saves no cycles.".into());
    };
    // A second relaxation of the same resource adds no information.
    let second = singles.iter().skip(1).find(|l| l.resource != first.resource && share(l) >= WORTH);
    let pair = pairs.first().filter(|pair| share(pair) >= share(first) + WORTH);
    let more: String = second
        .into_iter()
        .chain(pair)
        .map(|limit| format!(" {} {}.", relaxation_in_words(limit), percent_in_words(share(limit))))
        .collect();
    Some(format!(
        "Bottleneck: {}. {} {} of the cycles.{more}",
        quoted(&first.resource),
        relaxed_it(first),
        percent_in_words(share(first))
    ))
}

/// Start of the sentence about the saving of a resource that the sentence before names.
fn relaxed_it(limit: &RelaxedCycles) -> String {
    let subject = if is_pair(limit) { "both" } else { "it" };
    match limit.what.as_str() {
        FULLY_PIPELINED => format!("Fully pipelined (II = 1) {subject} would save"),
        UNBOUNDED_FIFO if !is_pair(limit) => "An unbounded FIFO would save".into(),
        other => format!("With {other} {subject} would save"),
    }
}

/// Start of the sentence about the saving of a resource.
fn relaxation_in_words(limit: &RelaxedCycles) -> String {
    let name = quoted(&limit.resource);
    match limit.what.as_str() {
        what if is_pair(limit) => format!("{name} together ({what}) would save"),
        UNBOUNDED_FIFO => format!("An unbounded {name} FIFO would save"),
        FULLY_PIPELINED => format!("{name} fully pipelined (II = 1) would save"),
        other => format!("{name} with {other} would save"),
    }
}

/// Names in code quotes.
fn quoted(resource: &str) -> String {
    format!("`{}`", resource.replace(" and ", "` and `"))
}

/// The first parts of the critical path; none where it is not known.
pub(super) fn path(report: &Report) -> Option<String> {
    let path = report.critical_path.as_ref()?;
    let parts: Vec<String> = path.parts.iter().take(PARTS).map(|part| part_text(part, path.cycles)).collect();
    let polygons = path.polygons.as_ref().map_or(String::new(), |polygons| by_polygon(polygons, path.cycles));
    Some(format!("Critical path (others may tie): {}.{polygons}", parts.join(", ")))
}

/// The polygons with most of the path, in a sentence.
pub(crate) fn by_polygon(polygons: &PathPolygons, total: u64) -> String {
    let part = |PathPolygon { frame, polygon, cycles, .. }: &PathPolygon| {
        format!("polygon {polygon} of frame {frame} ({})", percent_in_words(*cycles as f64 / total.max(1) as f64))
    };
    let parts: Vec<String> = polygons.listed.iter().take(PARTS).map(part).collect();
    if parts.is_empty() { String::new() } else { format!(" Most of it is for {}.", parts.join(", ")) }
}

fn part_text(PathPart { resource, what, cycles, .. }: &PathPart, total: u64) -> String {
    let share = percent_in_words(*cycles as f64 / total.max(1) as f64);
    format!("{share} {resource} {what}").replace("  ", " ")
}

fn is_pair(limit: &RelaxedCycles) -> bool {
    limit.resource.contains(" and ")
}

/// The first few.
pub(super) fn table(report: &Report) -> Table {
    let mut table =
        Table::new(&[("Relaxed resource", Left, 0), ("relaxation", Left, 0), ("cycles", Right, 0), ("saved %", Right, 0)]);
    let total = report.frame_cycles();
    for limit in report.limits.iter().flatten().take(ROWS) {
        let RelaxedCycles { resource, what, cycles, saved, .. } = limit;
        table.row([resource.clone(), what.clone(), thousands(*cycles), percent(*saved, total)]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;
    use crate::text::TextStyle;

    fn limit(resource: &str, what: &str, saved: u64, total: u64) -> RelaxedCycles {
        let set = vec![format!("ideal.units={resource}")];
        RelaxedCycles { resource: resource.into(), what: what.into(), set, cycles: total - saved, saved }
    }

    #[test]
    fn two_savings_in_sentence_others_in_table() {
        let mut report = samples::simulated();
        let total = report.frame_cycles();
        assert_eq!(sentence(&report), None);
        report.limits = Some(vec![]);
        assert!(sentence(&report).unwrap().starts_with("No single bottleneck"));
        report.limits = Some(vec![
            limit("search", FULLY_PIPELINED, total / 2, total),
            limit("search and reader", FULLY_PIPELINED, total * 3 / 4, total),
            limit("texels", UNBOUNDED_FIFO, total / 4, total),
        ]);
        let expected = "Bottleneck: `search`. Fully pipelined (II = 1) it would save 50 % of the cycles. An unbounded `texels` FIFO \
                        would save 25 %. `search` and `reader` together (fully pipelined (II = 1)) would save 75 %.";
        assert_eq!(sentence(&report).unwrap(), expected);
        assert_eq!(table(&report).render(TextStyle::default()).lines().count(), 5);
    }
}
