//! Several reports in one table, one row each.

use crate::model::Report;
use crate::number::{real, thousands};
use crate::text::style::TextStyle;
use crate::text::table::{Align, Table};
use crate::work::work;
use Align::{Left, Right};

/// Returns render cycles, memory bytes, area and PSNR of each report, with a line feed at the end.
pub fn overview(reports: &[(&str, &Report)], style: TextStyle) -> String {
    let mut kinds: Vec<String> = reports.iter().map(|(_, report)| work(report).one).collect();
    kinds.dedup();
    let each = format!("per {}", kinds.join(" or "));
    let columns = [
        ("Report", Left, 0),
        ("render cycles", Right, 0),
        (&*each, Right, 1),
        ("bytes moved", Right, 1),
        ("area GE", Right, 1),
        ("PSNR dB", Right, 1),
    ];
    let mut table = Table::new(&columns);
    for (name, report) in reports {
        let timed = report.cycles.as_ref();
        let per_one = report.derived.get(&format!("cycles_per_{}", work(report).one));
        let cell = |x: Option<String>| x.unwrap_or_else(|| "-".into());
        table.row([
            (*name).to_owned(),
            cell(timed.map(|_| thousands(report.frame_cycles()))),
            cell(per_one.map(|figure| real((100.0 * figure.value).round() / 100.0))),
            cell(report.memory_bytes().map(thousands)),
            cell(report.hardware_area().map(|area| thousands(area.area_ge))),
            cell(report.quality.as_ref().map(|quality| format!("{:.2}", quality.last.psnr_db))),
        ]);
    }
    table.render(style) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn reports_side_by_side() {
        let (a, b) = samples::before_and_after();
        let reports = [("out/a", &a), ("out/b", &b), ("out/functional", &samples::functional())];
        insta::assert_snapshot!("overview", overview(&reports, TextStyle::default()));
    }
}
