//! Measured bottlenecks: sentences and tables.

use super::table::{Align, Table};
use crate::model::{
    Bottlenecks, FULLY_PIPELINED, NO_DISPLAY, PathPart, PathPolygon, PathPolygons, RelaxedCycles, RelaxedSet, Report,
    UNBOUNDED_FIFO,
};
use crate::number::{decimal, percent, percent_in_words, thousands};
use crate::work::work;
use Align::{Left, Right};

/// Maximum number of rows of the table.
const ROWS: usize = 8;
/// Maximum number of parts of the critical path in its sentence.
const PARTS: usize = 4;
/// Smallest second saving that the sentence mentions \[share of the cycles\].
const WORTH: f64 = 0.01;

/// The bound of the run: the group of resources that is saturated together, or the two largest savings. Returns `None` if nothing was
/// measured.
pub(super) fn sentence(report: &Report) -> Option<String> {
    let bottlenecks = report.bottlenecks.as_ref()?;
    match &bottlenecks.balanced {
        Some(balanced) => Some(balanced_in_words(balanced, bottlenecks, report)),
        None => Some(single_in_words(&bottlenecks.single, report)),
    }
}

fn balanced_in_words(balanced: &RelaxedSet, bottlenecks: &Bottlenecks, report: &Report) -> String {
    let total = report.frame_cycles();
    let names: Vec<String> = balanced.relaxed.iter().map(|name| format!("`{name}`")).collect();
    let (last, first) = names.split_last().map_or((String::new(), vec![]), |(last, first)| (last.clone(), first.to_vec()));
    let alone = match bottlenecks.single.first() {
        Some(best) if best.saved > 0 => {
            let share = percent_in_words(best.saved as f64 / total.max(1) as f64);
            format!("at most {share} (`{}`)", best.resource)
        }
        _ => "none".into(),
    };
    let now = rate(report, total).map_or(String::new(), |rate| format!(" at {rate}"));
    let then = rate(report, balanced.cycles).map_or(String::new(), |rate| format!(" and reach {rate}"));
    format!(
        "Bottleneck: balanced across {} and {last}{now}. Relaxed together they would save {} of the cycles{then}; one resource alone \
         saves {alone}.",
        first.join(", "),
        percent_in_words(balanced.saved),
    )
}

/// Work per cycle, such as `0.67 fragments per cycle`; `None` if the machine counts no work.
pub(super) fn rate(report: &Report, cycles: u64) -> Option<String> {
    let work = work(report);
    (work.count > 0 && cycles > 0).then(|| format!("{} {}s per cycle", decimal(work.count as f64 / cycles as f64, 2), work.one))
}

fn single_in_words(singles: &[RelaxedCycles], report: &Report) -> String {
    let total = report.frame_cycles();
    let share = |limit: &RelaxedCycles| limit.saved as f64 / total.max(1) as f64;
    let Some(first) = singles.first() else {
        return "No single bottleneck: relaxing any one unit, FIFO, memory or cache saves no cycles.".into();
    };
    // A second relaxation of the same resource adds no information.
    let second = singles.iter().skip(1).find(|l| l.resource != first.resource && share(l) >= WORTH);
    let more =
        second.map_or(String::new(), |limit| format!(" {} {}.", relaxation_in_words(limit), percent_in_words(share(limit))));
    format!("Bottleneck: `{}`. {} {} of the cycles.{more}", first.resource, relaxed_it(first), percent_in_words(share(first)))
}

/// Start of the sentence about the saving of a resource that the sentence before names.
fn relaxed_it(limit: &RelaxedCycles) -> String {
    match limit.what.as_str() {
        FULLY_PIPELINED => "Fully pipelined (II = 1) it would save".into(),
        UNBOUNDED_FIFO => "An unbounded FIFO would save".into(),
        NO_DISPLAY => "Without it, the run would save".into(),
        other => format!("With {other} it would save"),
    }
}

/// Start of the sentence about the saving of a resource.
fn relaxation_in_words(limit: &RelaxedCycles) -> String {
    let name = &limit.resource;
    match limit.what.as_str() {
        UNBOUNDED_FIFO => format!("An unbounded `{name}` would save"),
        FULLY_PIPELINED => format!("`{name}` fully pipelined (II = 1) would save"),
        NO_DISPLAY => format!("The run without `{name}` would save"),
        other => format!("`{name}` with {other} would save"),
    }
}

/// A rung of the ladder for display.
pub(crate) struct LadderRow<'a> {
    /// Resources that this rung relaxes; empty for the run itself.
    pub(crate) added: &'a [String],
    /// True if the rung relaxes all other resources.
    pub(crate) relaxes_all: bool,
    pub(crate) set: &'a [String],
    pub(crate) cycles: u64,
    /// Render cycles of the rung before it.
    pub(crate) before: u64,
    /// Work per cycle; empty if the machine counts no work.
    pub(crate) rate: String,
}

impl LadderRow<'_> {
    /// Name of the row: the added resources.
    pub(crate) fn name(&self) -> String {
        match self.added {
            [] => "as simulated".into(),
            [_, _, ..] if self.relaxes_all => "+ all other resources".into(),
            added => format!("+ {}", added.join(", ")),
        }
    }
}

/// The run and the rungs of its ladder, in order; empty without a ladder.
pub(crate) fn ladder(report: &Report) -> Vec<LadderRow<'_>> {
    let total = report.frame_cycles();
    let rungs: &[RelaxedSet] = report.bottlenecks.as_ref().map_or(&[], |of| &of.ladder);
    let row = |added, relaxes_all, set, cycles, before| LadderRow {
        added,
        relaxes_all,
        set,
        cycles,
        before,
        rate: rate(report, cycles).and_then(|rate| Some(rate.split_once(' ')?.0.to_owned())).unwrap_or_default(),
    };
    let mut rows = vec![];
    let (mut known, mut before) = (0, total);
    for rung in rungs {
        let added = rung.relaxed.get(known..).unwrap_or_default();
        rows.push(row(added, rung.relaxes_all, rung.set.as_slice(), rung.cycles, before));
        (known, before) = (rung.relaxed.len(), rung.cycles);
    }
    if !rows.is_empty() {
        rows.insert(0, row(&[], false, &[], total, total));
    }
    rows
}

/// The ladder in one line: each rung with the share saved up to it.
pub(super) fn ladder_line(report: &Report) -> Option<String> {
    let total = report.frame_cycles();
    let rows = ladder(report);
    let last = rows.last()?;
    let saved = |row: &LadderRow<'_>| percent_in_words(total.saturating_sub(row.cycles) as f64 / total.max(1) as f64);
    let rungs: Vec<String> = rows.iter().skip(1).map(|row| format!("{} {}", row.name(), saved(row))).collect();
    let peak = rate(report, last.cycles).map_or(String::new(), |rate| format!(" Peak: {rate}."));
    Some(format!("Bottleneck ladder, saved so far: {}.{peak}", rungs.join("; ")))
}

/// The ladder, a row per rung.
pub(super) fn ladder_table(report: &Report) -> Table {
    let of = work(report).one;
    let title = format!("{of}s/cycle");
    let mut table =
        Table::new(&[("Bottleneck ladder", Left, 0), ("cycles", Right, 0), ("saved %", Right, 0), (title.as_str(), Right, 0)]);
    let total = report.frame_cycles();
    for row in ladder(report) {
        table.row([row.name(), thousands(row.cycles), percent(total.saturating_sub(row.cycles), total), row.rate.clone()]);
    }
    table
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
        format!("polygon {polygon} of frame {} ({})", frame + 1, percent_in_words(*cycles as f64 / total.max(1) as f64))
    };
    let parts: Vec<String> = polygons.listed.iter().take(PARTS).map(part).collect();
    if polygons.elsewhere > total / 2 {
        return format!(" Of it, {} belongs to no polygon.", percent_in_words(polygons.elsewhere as f64 / total as f64));
    }
    if parts.is_empty() { String::new() } else { format!(" Most of it is for {}.", parts.join(", ")) }
}

fn part_text(PathPart { resource, what, cycles, .. }: &PathPart, total: u64) -> String {
    let share = percent_in_words(*cycles as f64 / total.max(1) as f64);
    format!("{share} {resource} {what}").replace("  ", " ")
}

/// The first few.
pub(super) fn table(report: &Report) -> Table {
    let mut table =
        Table::new(&[("Relaxed resource", Left, 0), ("relaxation", Left, 0), ("cycles", Right, 0), ("saved %", Right, 0)]);
    let total = report.frame_cycles();
    for limit in report.bottlenecks.iter().flat_map(|of| &of.single).take(ROWS) {
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

    fn single(list: Vec<RelaxedCycles>) -> Option<Bottlenecks> {
        Some(Bottlenecks { single: list, ..Bottlenecks::default() })
    }

    #[test]
    fn two_savings_in_sentence_others_in_table() {
        let mut report = samples::simulated();
        let total = report.frame_cycles();
        assert_eq!(sentence(&report), None);
        report.bottlenecks = single(vec![]);
        assert!(sentence(&report).unwrap().starts_with("No single bottleneck"));
        report.bottlenecks = single(vec![
            limit("search", FULLY_PIPELINED, total / 2, total),
            limit("fifo.texels", UNBOUNDED_FIFO, total / 4, total),
            limit("reader", FULLY_PIPELINED, total / 8, total),
        ]);
        let expected = "Bottleneck: `search`. Fully pipelined (II = 1) it would save 50 % of the cycles. An unbounded `fifo.texels` \
                        would save 25 %.";
        assert_eq!(sentence(&report).unwrap(), expected);
        assert_eq!(table(&report).render(TextStyle::default()).lines().count(), 5);
    }

    #[test]
    fn balanced_bound_names_all_resources_and_rates() {
        let mut report = samples::balanced();
        let total = report.frame_cycles();
        let rung = |names: &[&str], saved: f64| RelaxedSet {
            relaxed: names.iter().map(|name| (*name).to_owned()).collect(),
            set: vec![format!("ideal.units={}", names.join(","))],
            cycles: ((1.0 - saved) * total as f64) as u64,
            saved,
            relaxes_all: names.len() > 4,
        };
        let ladder = [&["a"][..], &["a", "b", "c"], &["a", "b", "c", "d"], &["a", "b", "c", "d", "e", "f"]];
        let ladder = ladder.into_iter().zip([0.0, 0.5, 0.75, 0.8]).map(|(names, saved)| rung(names, saved)).collect();
        let one = limit("a", FULLY_PIPELINED, total / 50, total);
        report.bottlenecks = Some(Bottlenecks { balanced: Some(rung(&["a", "b"], 0.5)), ladder, single: vec![one] });
        let text = sentence(&report).unwrap();
        let fragments = work(&report).count as f64;
        let (now, then) = (fragments / total as f64, fragments / (total / 2) as f64);
        let expected = format!(
            "Bottleneck: balanced across `a` and `b` at {now:.2} fragments per cycle. Relaxed together they would save 50 % of the \
             cycles and reach {then:.2} fragments per cycle; one resource alone saves at most 2 % (`a`)."
        );
        assert_eq!(text, expected);
        let line = ladder_line(&report).unwrap();
        assert!(
            line.starts_with(
                "Bottleneck ladder, saved so far: + a 0 %; + b, c 50 %; + d 75 %; + all other resources 80 %. Peak: "
            ),
            "{line}"
        );
        assert_eq!(ladder_table(&report).rows().len(), 5);
    }
}
