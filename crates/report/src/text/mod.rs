//! The report on a terminal: the bottleneck in a sentence, then tables.
//!
//! If the terminal is too narrow, the least important columns are dropped first. Shares are in percent; a share of exactly 0 is
//! blank. Colour is off by default.

pub(crate) mod bottlenecks;
pub(crate) mod costs;
pub(crate) mod display;
pub(crate) mod hardware;
pub(crate) mod sections;
pub(crate) mod sensitivity;
pub(crate) mod style;
mod summary;
pub(crate) mod table;
mod tables;

pub use hardware::hardware;

use crate::bottleneck::diagnose;
use crate::model::{Cycles, Report};
use crate::number;
pub(crate) use style::Emphasis;
pub use style::TextStyle;
pub use table::Align;
pub use tables::TableGroup;

/// Returns the report: heading, summary, bottleneck, then these tables. Empty lines separate the parts; a line feed ends the text.
pub fn to_text(report: &Report, style: TextStyle, tables: &[TableGroup]) -> String {
    let mut parts = vec![style.paint(Emphasis::Bold, &style.wrap(&title(report)))];
    parts.push(summary::lines(report).iter().map(|line| style.wrap(line)).collect::<Vec<_>>().join("\n"));
    parts.push(style.wrap(&bottleneck_sentence(report)));
    parts.extend(bottlenecks::ladder_line(report).map(|ladder| style.wrap(&ladder)));
    parts.extend(bottlenecks::path(report).map(|path| style.wrap(&path)));
    // A run with one of these options shows its table.
    let asked = [(TableGroup::Costs, report.costs.is_some()), (TableGroup::Sensitivity, report.sensitivity.is_some())];
    let asked = asked.into_iter().filter(|(_, is_there)| *is_there).map(|(table, _)| table);
    let tables: Vec<TableGroup> = tables.iter().copied().chain(asked).collect();
    for (caption, table) in TableGroup::ALL.iter().filter(|of| tables.contains(of)).flat_map(|of| of.of(report)) {
        let caption = if caption.is_empty() { caption } else { style.paint(Emphasis::Dim, &style.wrap(&caption)) + "\n" };
        parts.push(caption + &table.render(style));
    }
    parts.extend(sections::host(report));
    parts.extend(warnings(report, style));
    parts.extend(unshown_tables(report, &tables).map(|more| style.wrap(&more)));
    parts.retain(|part| !part.is_empty());
    parts.join("\n\n") + "\n"
}

/// Sentence that lists the tables that are not shown.
fn unshown_tables(report: &Report, shown: &[TableGroup]) -> Option<String> {
    let rest: Vec<&str> =
        TableGroup::ALL.iter().filter(|of| !shown.contains(of) && !of.of(report).is_empty()).map(|of| of.name()).collect();
    (!rest.is_empty()).then(|| format!("More tables: --tables all, or any of {}.", rest.join(",")))
}

/// Returns the bottleneck in words: as measured, otherwise from the cycle accounting.
pub(crate) fn bottleneck_sentence(report: &Report) -> String {
    bottlenecks::sentence(report).unwrap_or_else(|| diagnose(report).sentence)
}

fn title(report: &Report) -> String {
    let pictures = match &report.cycles {
        Some(cycles) => frames(report, cycles),
        None => vec!["functional".into()],
    };
    let mut parts = vec![
        report.machine.clone(),
        format!("{} {}", report.input.kind, report.input.name),
        format!("{} x {}", report.size.width, report.size.height),
    ];
    parts.extend(pictures);
    if !report.outcome.is_complete() {
        parts.push("incomplete".into());
    }
    parts.join(" · ")
}

fn frames(report: &Report, cycles: &Cycles) -> Vec<String> {
    let render = number::thousands(report.frame_cycles());
    let term = report.cycles_term();
    let total = match report.drain() {
        tail if tail <= report.frame_cycles() / 100 => format!("{render} {term}"),
        tail => format!("{render} {term}; the run ends {} cycles later", number::thousands(tail)),
    };
    let (least, most) = (cycles.frames.iter().min(), cycles.frames.iter().max());
    let frames = least.zip(most).filter(|_| cycles.frames.len() > 1).map(|(&least, &most)| {
        let (least, most) = (number::thousands(least), number::thousands(most));
        let range = if least == most { least } else { format!("{least} to {most}") };
        match report.picture_term() {
            "frame" => format!("{} frames of {range} cycles", report.frames()),
            term => {
                let frames = report.frames();
                let s = if frames == 1 { "" } else { "s" };
                format!("{frames} frame{s}, {} {term}s of {range} cycles", report.pictures())
            }
        }
    });
    std::iter::once(total).chain(frames).collect()
}

fn warnings(report: &Report, style: TextStyle) -> Option<String> {
    let mark = style.paint(Emphasis::Yellow, "warning:");
    let lines: Vec<String> = report.warnings.iter().map(|w| format!("{mark} {w}")).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::FigureGroup;
    use crate::samples;

    #[test]
    fn tables_of_a_run() {
        let report = samples::balanced().with_host(4.0, 2.0);
        insta::assert_snapshot!("tables", to_text(&report, TextStyle::default(), &TableGroup::ALL));
    }

    #[test]
    fn first_screen_lists_further_tables() {
        let report = samples::balanced();
        let text = to_text(&report, TextStyle::default(), &[]);
        assert!(text.contains("render cycles per frame") && text.contains("bytes of memory traffic per frame"), "{text}");
        assert!(text.lines().count() < 20, "{text}");
        assert!(text.contains("More tables: --tables all, or any of units,fifos,memories,"), "{text}");
        let units = to_text(&report, TextStyle::default(), &[TableGroup::Units]);
        assert!(units.contains("% of render cycles") && !units.contains("--tables all, or any of units"), "{units}");
        assert!(!to_text(&report, TextStyle::default(), &TableGroup::ALL).contains("--tables"));
    }

    #[test]
    fn incomplete_run_has_no_mean_per_frame() {
        let text = to_text(&samples::deadlocked(), TextStyle::default(), &[]);
        assert!(text.contains("\n1,000,000 cycles, 5.00 per fragment; 5.000 ms at 200 MHz\n"), "{text}");
        assert!(text.contains("\n4,992,000 bytes of memory traffic, 24.96 per fragment\n"), "{text}");
    }

    #[test]
    fn quotients_have_separators_or_significant_digits() {
        let mut report = samples::balanced();
        report.figures.insert("fragments".into(), 7.into());
        report.derived = crate::derived::derive(&report);
        let text = to_text(&report.clone().with_host(1.0, 1.0), TextStyle::default(), &[]);
        assert!(text.contains("500,000 render cycles per frame (480,000 to 520,000), 142,857 per fragment"), "{text}");
        assert!(text.contains(" M cycles/s, 7 fragments/s)"), "{text}");
        let html = crate::to_html(&report, &crate::html::PageAssets::default()).unwrap();
        assert!(html.contains("<dt>cycles per fragment</dt><dd>142,857</dd>"), "{html}");
        assert_eq!(bottlenecks::rate(&report, 1_000_000).unwrap(), "0.00000700 fragments per cycle");
        assert_eq!(bottlenecks::rate(&report, 100).unwrap(), "0.0700 fragments per cycle");
    }

    #[test]
    fn tables_of_a_functional_run_and_of_a_deadlock() {
        insta::assert_snapshot!("functional", to_text(&samples::functional(), TextStyle::default(), &TableGroup::ALL));
        insta::assert_snapshot!(
            "deadlock",
            to_text(&samples::deadlocked(), TextStyle { width: 72, color: false }, &TableGroup::ALL)
        );
    }

    #[test]
    fn cost_tables_show_attribution() {
        insta::assert_snapshot!(
            "costs",
            costs::tables(&samples::costed()).map(|table| table.render(TextStyle::default())).join("\n\n")
        );
    }

    #[test]
    fn routes_circuits_and_processes_have_tables_of_their_own() {
        let text = to_text(&samples::with_routes(), TextStyle::default(), &TableGroup::ALL);
        let has = |line: &str| assert!(text.lines().any(|l| l.split_whitespace().eq(line.split(' '))), "{line}: {text}");
        has("Route polygons % dots %");
        has("normal 900 90.0 150,000 75.0");
        has("Circuit needed % started % idle %");
        has("circuit_21 15.0 15.0 85.0");
        has("circuit_50 45.0 60.0 40.0");
        has("Process runs cycles %");
        has("process_22 1,000 36,000 3.6");
        assert!(!text.contains("process_22_runs"), "{text}");
        assert!(!text.contains("dots_normal") && !text.contains("circuit_50_started_cycles"), "{text}");
    }

    #[test]
    fn equal_length_lists_become_a_table_cut_short() {
        let mut report = samples::with_routes();
        let list = |n: u64| crate::model::Figure::List((0..n).map(Into::into).collect());
        for column in ["texture", "layer", "loaded"] {
            let name = format!("layers_{column}");
            report.figures.insert(name.clone(), list(43));
            let part = FigureGroup::Column { table: "layers".into(), title: column.into() };
            report.legend.insert(name, samples::legend("", part));
        }
        let text = to_text(&report, TextStyle::default(), &TableGroup::ALL);
        let has = |line: &str| assert!(text.lines().any(|l| l.split_whitespace().eq(line.split(' '))), "{line}: {text}");
        has("texture layer loaded");
        has("39 39 39");
        has("3 more");
        assert!(!text.contains("layers_") && !text.contains("40 40 40"), "{text}");
    }

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        for width in [60, 72, 80, 100, 120] {
            let text = to_text(&samples::balanced(), TextStyle { width, color: false }, &TableGroup::ALL);
            for line in text.lines() {
                assert!(line.chars().count() <= width || line.starts_with("warning"), "{width}: {line}");
            }
        }
    }

    #[test]
    fn colour_changes_nothing_but_colour() {
        let report = samples::balanced();
        let mut text = to_text(&report, TextStyle { width: 100, color: true }, &TableGroup::ALL);
        assert!(text.contains('\x1b'));
        for code in ["\x1b[0m", "\x1b[1m", "\x1b[2m", "\x1b[33m"] {
            text = text.replace(code, "");
        }
        assert_eq!(text, to_text(&report, TextStyle::default(), &TableGroup::ALL));
        assert!(!text.contains('\x1b'));
    }
}
