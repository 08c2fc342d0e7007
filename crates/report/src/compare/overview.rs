//! Several reports in one table, one row each.

use super::comparison::Comparison;
use crate::model::Report;
use crate::number::{decimal, thousands};
use crate::text::style::TextStyle;
use crate::text::table::{Align, Table};
use crate::work::work;
use Align::{Left, Right};

/// Returns the comparisons of the first report with each of the others as text: an overview, then each comparison under the names of its
/// reports.
pub fn comparisons_text(first: (&str, &Report), others: &[((&str, &Report), &Comparison)], style: TextStyle) -> String {
    let reports: Vec<_> = std::iter::once(first).chain(others.iter().map(|(other, _)| *other)).collect();
    let heading = |name: &str| format!("A: {}, B: {name}\n", first.0);
    let pairs = others.iter().map(|((name, _), comparison)| format!("\n{}{}", heading(name), comparison.to_text(style)));
    std::iter::once(overview(&reports, style)).chain(pairs).collect()
}

/// Returns render cycles, time of a frame, memory bytes, area and PSNR of each report, each with its change from the first report, with a
/// line feed at the end.
fn overview(reports: &[(&str, &Report)], style: TextStyle) -> String {
    let mut kinds: Vec<String> = reports.iter().map(|(_, report)| work(report).one).collect();
    kinds.dedup();
    let each = format!("per {}", kinds.join(" or "));
    let columns = [
        ("Report", Left, 0),
        ("render cycles", Right, 0),
        ("ms per frame", Right, 0),
        (&*each, Right, 2),
        ("bytes moved", Right, 1),
        ("area GE", Right, 1),
        ("worst PSNR dB", Right, 1),
    ];
    let mut table = Table::new(&columns);
    for (number, (name, report)) in reports.iter().enumerate() {
        let first = reports.first().filter(|_| number > 0).map(|(_, first)| *first);
        let per_one = report.derived.get(&format!("cycles_per_{}", work(report).one));
        table.row([
            (*name).to_owned(),
            count(report, first, |of| of.cycles.as_ref().map(|_| of.frame_cycles())),
            frame_ms(report, first),
            per_one.map_or_else(none, |figure| decimal(figure.value, 2)),
            count(report, first, Report::memory_bytes),
            count(report, first, |of| of.hardware_area().map(|area| area.area_ge)),
            psnr(report, first),
        ]);
    }
    table.render(style) + "\n"
}

/// Cell of a figure that a report lacks.
fn none() -> String {
    "-".into()
}

/// A count, and its change in percent from that of the first report.
fn count(report: &Report, first: Option<&Report>, figure: impl Fn(&Report) -> Option<u64>) -> String {
    let Some(value) = figure(report) else { return none() };
    thousands(value) + &change(first.and_then(figure).map(|before| before as f64), value as f64)
}

/// The time of a frame, and its change in percent from that of the first report.
fn frame_ms(report: &Report, first: Option<&Report>) -> String {
    let Some(ms) = report.frame_ms() else { return none() };
    decimal(ms, 3) + &change(first.and_then(Report::frame_ms), ms)
}

/// A change in percent, in parentheses. Empty without a positive value before.
fn change(before: Option<f64>, after: f64) -> String {
    let percent = before.filter(|before| *before > 0.0).map(|before| 100.0 * (after / before - 1.0));
    percent.map_or(String::new(), |percent| format!(" ({percent:+.1} %)"))
}

/// The worst PSNR of all frames, and its change in dB from that of the first report.
fn psnr(report: &Report, first: Option<&Report>) -> String {
    let worst = |of: &Report| of.quality.as_ref().map(|quality| quality.min.psnr_db);
    let Some(value) = worst(report) else { return none() };
    let change = first.and_then(worst).map_or(String::new(), |before| format!(" ({:+.2})", value - before));
    format!("{value:.2}{change}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::compare;
    use crate::samples;

    #[test]
    fn reports_side_by_side() {
        let (a, b) = samples::before_and_after();
        let reports = [("out/a", &a), ("out/b", &b), ("out/functional", &samples::functional())];
        insta::assert_snapshot!("overview", overview(&reports, TextStyle::default()));
    }

    #[test]
    fn comparison_names_both_reports() {
        let (a, b) = samples::before_and_after();
        let comparison = compare(&a, &b, None);
        let one = comparisons_text(("out/a", &a), &[(("out/b", &b), &comparison)], TextStyle::default());
        assert!(one.contains("\n\nA: out/a, B: out/b\n"), "{one}");
        let others = [(("out/b", &b), &comparison), (("out/c", &b), &comparison)];
        let two = comparisons_text(("out/a", &a), &others, TextStyle::default());
        assert!(two.contains("\n\nA: out/a, B: out/b\n") && two.contains("\n\nA: out/a, B: out/c\n"), "{two}");
    }
}
