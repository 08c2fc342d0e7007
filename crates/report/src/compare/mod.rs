//! The difference of two runs, and its causes.
//!
//! Every figure of report A is compared with the same figure of B. Host figures and derived figures are left out, except the time
//! of a frame. Changes are listed per part of the report, parameters first, the largest absolute change first.
//!
//! **Causes**: stalls only pass on a delay from elsewhere, so they explain nothing. Causes are measured if both runs have recordings:
//! A is resimulated or run again with one changed parameter as in B. The caller passes the resulting cycles; this crate puts them into
//! words.
//!
//! **Time**: cycles of different clocks last differently long. If the clocks differ, times come first, and times are judged instead of
//! cycles.
//!
//! **Regression**: [`Verdict::worst`] is the largest of these, in percent. Improvements do not count.
//! - growth of `cycles.total`, and of any frame; if the clocks differ, growth of `derived.frame_ms`, `derived.time_ms`, and of the time
//!   of any frame;
//! - growth of the moved bytes of any memory client;
//! - loss of quality of the final image and of any frame: PSNR relative to A; SSIM and FLIP, whose scale is 0..1, in hundredths.
//!
//! **Not judged**: [`Verdict::unjudged`] lists counted figures without a percentage. No limit lets them pass.
//! - a figure that A has and B lacks, and fewer frames in B than in A;
//! - a run that did not finish;
//! - a timed run without a clock, if A has one;
//! - growth from 0, and a value that is not finite.

mod comparison;
mod explain;
mod overview;
mod text;
mod time;
mod verdict;

pub(crate) use explain::cause_name;
pub(crate) use text::measured_by;

pub use comparison::{
    CauseShare, Comparison, FigureChange, LargestRegression, MeasuredCauses, SectionChanges, UnjudgedFigure, Verdict, WORK,
};
pub use overview::comparisons_text;

use crate::long_table::{self, FigureRow};
use crate::model::{Figure, Report};
use indexmap::IndexMap;

/// Compares report `b` with report `a`. `explained` holds the measured causes, if any.
pub fn compare(a: &Report, b: &Report, explained: Option<MeasuredCauses>) -> Comparison {
    let mut sections = sections(a, b);
    if let (Some(explained), Some(config)) = (&explained, sections.iter_mut().find(|section| section.table == "config")) {
        changed_parameters_first(config, explained);
    }
    Comparison {
        equal: sections.is_empty(),
        explanation: explain::explain(a, b, sections.is_empty(), explained.as_ref()),
        explained,
        other_input: a.input.sha256 != b.input.sha256 || a.input.sha256.is_empty(),
        verdict: verdict::verdict(a, b, sections.is_empty()),
        sections,
    }
}

type FigureKey = (&'static str, String, &'static str, String);

/// Figures to compare. High-water mark, mean and full cycles stand for the histogram; derived figures follow from the others. Only the
/// time of a frame is kept, because it depends on the clock as well as on cycles.
fn figures(report: &Report) -> IndexMap<FigureKey, Figure> {
    let is_compared = |r: &FigureRow| r.field != "histogram" && (r.table != "derived" || r.name == "frame_ms");
    long_table::rows(report).into_iter().filter(is_compared).map(|r| ((r.table, r.name, r.field, r.key), r.value)).collect()
}

fn sections(a: &Report, b: &Report) -> Vec<SectionChanges> {
    let (mut in_a, mut in_b) = (figures(a), figures(b));
    if a.pictures() != b.pictures() {
        // Pictures of the same number may belong to different frames.
        let is_picture = |(table, _, field, _): &FigureKey| (*table, *field) == ("cycles", "frames");
        in_a.retain(|key, _| !is_picture(key));
        in_b.retain(|key, _| !is_picture(key));
    }
    let mut changes: IndexMap<&'static str, Vec<FigureChange>> = IndexMap::new();
    let mut add = |(table, name, field, key): FigureKey, a: Option<Figure>, b: Option<Figure>| {
        if a != b {
            changes.entry(table).or_default().push(change(table, name, field, key, a, b));
        }
    };
    for (place, a) in in_a {
        let b = in_b.shift_remove(&place);
        add(place, Some(a), b);
    }
    for (place, b) in in_b {
        add(place, None, Some(b));
    }
    let order =
        ["run", "config", "derived", "cycles", "units", "fifos", "memories", "channels", "caches", "figures", "quality", "image"];
    let parts = order.into_iter().filter_map(|table| changes.swap_remove(table).map(|changes| (table, changes)));
    parts.map(|(table, changes)| SectionChanges { table, changes: sorted(table, changes), derived: 0 }).collect()
}

/// Sorts the parameters that the user changed by their effect on the cycles, and places those that follow from them last.
fn changed_parameters_first(config: &mut SectionChanges, explained: &MeasuredCauses) {
    let keys: Vec<&str> =
        explained.shares.iter().flat_map(|share| &share.set).filter_map(|set| Some(set.split_once('=')?.0)).collect();
    let derived = |change: &FigureChange| explained.shares.iter().any(|share| share.derived.contains(&change.name));
    let place = |change: &FigureChange| {
        let changed = keys.iter().position(|key| *key == change.name);
        changed.unwrap_or(if derived(change) { keys.len() + 1 } else { keys.len() })
    };
    config.changes.sort_by_key(place);
    config.derived = config.changes.iter().filter(|change| place(change) > keys.len()).count();
}

/// A unit lacks the stalls that it never had. Elsewhere, what a report lacks is unknown.
fn change(table: &str, name: String, field: &'static str, key: String, a: Option<Figure>, b: Option<Figure>) -> FigureChange {
    let none = if table == "units" { Some(0.0) } else { None };
    let number = |x: &Option<Figure>| x.as_ref().map_or(none, Figure::number);
    let delta = number(&a).zip(number(&b)).map(|(a, b)| b - a);
    let base = a.as_ref().and_then(Figure::number).filter(|&a| a != 0.0 && b.is_some());
    let percent = delta.zip(base).map(|(d, base)| crate::number::round6(100.0 * d / base.abs()));
    FigureChange { name, field, key, a, b, delta: delta.map(crate::number::round6), percent }
}

/// Sorts changes, largest first. In units, cycles come before counts of steps and tokens. Parameters and metadata keep their order.
fn sorted(table: &str, mut changes: Vec<FigureChange>) -> Vec<FigureChange> {
    if !["run", "config", "image"].contains(&table) {
        let counts = |c: &FigureChange| table == "units" && ["steps", "tokens"].contains(&c.field);
        let size = |c: &FigureChange| c.delta.map_or(0.0, f64::abs);
        changes.sort_by(|x, y| counts(x).cmp(&counts(y)).then(size(y).total_cmp(&size(x))));
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn equal_reports_differ_in_nothing_but_host_and_build() {
        let a = Report { build: "0.1.0+another".into(), ..samples::balanced() };
        assert_ne!(a.build, samples::balanced().build);
        let same = compare(&a, &samples::balanced().with_host(1.0, 1.0), None);
        assert!(same.equal && same.sections.is_empty());
        assert_eq!(same.failures(0.0), [""; 0]);
        assert!(!same.other_input);
    }

    #[test]
    fn parameters_come_before_their_consequences() {
        let (a, b) = samples::before_and_after();
        let tables: Vec<_> = compare(&a, &b, None).sections.iter().map(|s| s.table).collect();
        assert_eq!(tables, ["config", "derived", "cycles", "units", "memories", "quality"]);
    }

    #[test]
    fn the_largest_change_comes_first() {
        let (a, b) = samples::before_and_after();
        let comparison = compare(&a, &b, None);
        let units = comparison.sections.iter().find(|s| s.table == "units").unwrap();
        let sizes: Vec<f64> = units.changes.iter().map(|c| c.delta.unwrap().abs()).collect();
        assert!(sizes.is_sorted_by(|x, y| x >= y), "{sizes:?}");
    }

    #[test]
    fn a_figure_that_only_one_report_has_is_a_change() {
        let a = samples::balanced();
        let mut b = a.clone();
        b.figures.insert("new".into(), 7.into());
        b.figures.shift_remove("codebook");
        let figures = &compare(&a, &b, None).sections[0].changes;
        let view: Vec<_> = figures.iter().map(|c| (c.name.as_str(), c.a.is_some(), c.b.is_some(), c.delta)).collect();
        assert_eq!(view, [("codebook", true, false, None), ("new", false, true, None)]);
    }

    #[test]
    fn area_of_ideal_hardware_keeps_its_caveat() {
        let (a, b) = samples::before_and_after();
        assert!(!compare(&a, &b, None).explanation.contains("area"));
        let warning = "the area has no meaning, because no hardware is ideal: ideal.units";
        let b = Report { warnings: vec![warning.into()], ..b };
        let said = compare(&a, &b, None).explanation;
        assert!(said.ends_with(" The area of B has no meaning, because no hardware is ideal: ideal.units."), "{said}");
    }

    #[test]
    fn other_or_unknown_input_is_reported() {
        let a = samples::balanced();
        let mut b = a.clone();
        b.input.name = "renamed.gltf".into();
        assert!(!compare(&a, &b, None).other_input);
        b.input.sha256 = "cd".repeat(32);
        assert!(compare(&a, &b, None).other_input);
        b.input.sha256.clear();
        assert!(compare(&a, &b, None).other_input && compare(&b, &b, None).other_input);
    }

    #[test]
    fn a_comparison_is_json() {
        let (a, b) = samples::before_and_after();
        let share = CauseShare {
            parameter: WORK.into(),
            derived: vec![],
            set: vec![],
            needs_run: false,
            cycles: Some(400_000),
            by: Some(-600_000),
            share: None,
        };
        let explained = MeasuredCauses { shares: vec![share], together: 0 };
        let json = serde_json::to_value(compare(&a, &b, Some(explained))).unwrap();
        assert_eq!((&json["explained"][0]["by"], &json["together"]), (&(-600_000).into(), &0.into()));
        assert_eq!(json["sections"][0]["table"], "config");
        assert_eq!(json["sections"][0]["changes"][0]["delta"], -192.0);
        assert_eq!((&json["worst"]["what"], &json["unjudged"]), (&"quality.psnr_db".into(), &serde_json::json!([])));
    }
}
