//! The report as people read it on a terminal: what limits the run, in one sentence, then tables.
//!
//! Columns that matter least go first where the width does not hold them all. Shares of cycles are in percent; a share
//! of exactly nothing is left blank. Colour is off unless asked for.

pub(crate) mod bottlenecks;
pub(crate) mod costs;
pub(crate) mod hardware;
pub(crate) mod sections;
pub(crate) mod sensitivity;
pub(crate) mod style;
mod summary;
pub(crate) mod table;
mod tables;

pub use hardware::hardware;

use crate::bottleneck::blame;
use crate::model::{Cycles, OutcomeKind, Report};
use crate::number;
pub(crate) use style::Paint;
pub use style::Style;
pub use table::Align;
pub use tables::Tables;

/// The report: what the run was, what it cost and what limits it, then these tables; parts are parted by empty lines, with a line
/// feed at the end.
pub fn to_text(report: &Report, style: Style, tables: &[Tables]) -> String {
    let mut parts = vec![style.paint(Paint::Bold, &style.wrap(&title(report)))];
    parts.push(summary::lines(report).iter().map(|line| style.wrap(line)).collect::<Vec<_>>().join("\n"));
    parts.push(style.wrap(&what_limits(report)));
    parts.extend(bottlenecks::path(report).map(|path| style.wrap(&path)));
    // Who asks for one of these wants to see it.
    let asked = [(Tables::Costs, report.costs.is_some()), (Tables::Sensitivity, report.sensitivity.is_some())];
    let asked = asked.into_iter().filter(|(_, is_there)| *is_there).map(|(table, _)| table);
    let tables: Vec<Tables> = tables.iter().copied().chain(asked).collect();
    for (caption, table) in Tables::ALL.iter().filter(|of| tables.contains(of)).flat_map(|of| of.of(report)) {
        let caption = if caption.is_empty() { caption } else { style.paint(Paint::Dim, &style.wrap(&caption)) + "\n" };
        parts.push(caption + &table.render(style));
    }
    parts.extend(sections::host(report));
    parts.extend(warnings(report, style));
    parts.extend(more(report, &tables).map(|more| style.wrap(&more)));
    parts.retain(|part| !part.is_empty());
    parts.join("\n\n") + "\n"
}

/// What there is beside the tables that are shown.
fn more(report: &Report, shown: &[Tables]) -> Option<String> {
    let rest: Vec<&str> =
        Tables::ALL.iter().filter(|of| !shown.contains(of) && !of.of(report).is_empty()).map(|of| of.name()).collect();
    (!rest.is_empty()).then(|| format!("More with --tables all, or some of {}.", rest.join(",")))
}

/// In one sentence: as it was measured, or else as it follows from the accounting.
pub(crate) fn what_limits(report: &Report) -> String {
    bottlenecks::sentence(report).unwrap_or_else(|| blame(report).sentence)
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
    if report.outcome.kind != OutcomeKind::Complete {
        parts.push("incomplete".into());
    }
    parts.join(" · ")
}

fn frames(report: &Report, cycles: &Cycles) -> Vec<String> {
    let drain = match report.drain() {
        0 => String::new(),
        drain => format!(" and {} of drain", number::thousands(drain)),
    };
    let total = format!("{} cycles{drain}", number::thousands(report.frame_cycles()));
    let (least, most) = (cycles.frames.iter().min(), cycles.frames.iter().max());
    let frames = least.zip(most).filter(|_| cycles.frames.len() > 1).map(|(&least, &most)| {
        let (least, most) = (number::thousands(least), number::thousands(most));
        let range = if least == most { least } else { format!("{least} to {most}") };
        format!("{} frames of {range}", cycles.frames.len())
    });
    std::iter::once(total).chain(frames).collect()
}

fn warnings(report: &Report, style: Style) -> Option<String> {
    let mark = style.paint(Paint::Yellow, "warning:");
    let lines: Vec<String> = report.warnings.iter().map(|w| format!("{mark} {w}")).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Part;
    use crate::samples;

    #[test]
    fn tables_of_a_run() {
        let report = samples::balanced().with_host(4.0, 2.0);
        insta::assert_snapshot!("tables", to_text(&report, Style::default(), &Tables::ALL));
    }

    #[test]
    fn the_first_screen_answers_and_says_what_more_there_is() {
        let report = samples::balanced();
        let text = to_text(&report, Style::default(), &[]);
        assert!(text.contains("cycles per frame") && text.contains("bytes of memory traffic per frame"), "{text}");
        assert!(text.lines().count() < 20, "{text}");
        assert!(text.contains("More with --tables all, or some of units,fifos,memories,"), "{text}");
        let units = to_text(&report, Style::default(), &[Tables::Units]);
        assert!(
            units.contains("shares of the cycles of the frames") && !units.contains("--tables all, or some of units"),
            "{units}"
        );
        assert!(!to_text(&report, Style::default(), &Tables::ALL).contains("--tables"));
    }

    #[test]
    fn tables_of_a_functional_run_and_of_a_deadlock() {
        insta::assert_snapshot!("functional", to_text(&samples::functional(), Style::default(), &Tables::ALL));
        insta::assert_snapshot!("deadlock", to_text(&samples::deadlocked(), Style { width: 72, color: false }, &Tables::ALL));
    }

    #[test]
    fn what_was_for_whom_stands_in_tables() {
        insta::assert_snapshot!(
            "costs",
            costs::tables(&samples::costed()).map(|table| table.render(Style::default())).join("\n\n")
        );
    }

    #[test]
    fn routes_circuits_and_processes_have_tables_of_their_own() {
        let text = to_text(&samples::with_routes(), Style::default(), &Tables::ALL);
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
    fn lists_of_one_length_are_told_as_a_table_and_long_ones_cut_short() {
        let mut report = samples::with_routes();
        let list = |n: u64| crate::model::Figure::List((0..n).map(Into::into).collect());
        for column in ["texture", "layer", "loaded"] {
            let name = format!("layers_{column}");
            report.figures.insert(name.clone(), list(43));
            let part = Part::Column { table: "layers".into(), title: column.into() };
            report.legend.insert(name, samples::legend("", part));
        }
        let text = to_text(&report, Style::default(), &Tables::ALL);
        let has = |line: &str| assert!(text.lines().any(|l| l.split_whitespace().eq(line.split(' '))), "{line}: {text}");
        has("texture layer loaded");
        has("39 39 39");
        has("3 more");
        assert!(!text.contains("layers_") && !text.contains("40 40 40"), "{text}");
    }

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        for width in [60, 72, 80, 100, 120] {
            let text = to_text(&samples::balanced(), Style { width, color: false }, &Tables::ALL);
            for line in text.lines() {
                assert!(line.chars().count() <= width || line.starts_with("warning"), "{width}: {line}");
            }
        }
    }

    #[test]
    fn colour_changes_nothing_but_colour() {
        let report = samples::balanced();
        let mut text = to_text(&report, Style { width: 100, color: true }, &Tables::ALL);
        assert!(text.contains('\x1b'));
        for code in ["\x1b[0m", "\x1b[1m", "\x1b[2m", "\x1b[33m"] {
            text = text.replace(code, "");
        }
        assert_eq!(text, to_text(&report, Style::default(), &Tables::ALL));
        assert!(!text.contains('\x1b'));
    }
}
