//! Tables of the sensitivity to assumed parameters.

use super::table::{Align, Table};
use crate::model::{ComesTo, Measure, PERCENT_PER_DB, Sensitivity};
use crate::number::{decimal, real, thousands};
use Align::{Left, Right};
use serde_json::Value;

/// Maximum number of rows on a terminal.
const SHOWN: usize = 20;

/// Longest words about a parameter in a table \[characters\].
const ABOUT: usize = 32;

/// Caption of the table of changes.
pub(crate) fn caption(sensitivity: &Sensitivity) -> String {
    let Measure { cycles, frame_ms, bytes, area_ge, psnr_db } = sensitivity.base;
    let count =
        |is: &dyn Fn(Option<f64>) -> bool| sensitivity.changes.iter().filter(|change| is(change.largest_change())).count();
    let (still, failed) = (count(&|size| size == Some(0.0)), count(&|size| size.is_none()));
    let time = frame_ms.map_or_else(String::new, |ms| format!("{} ms per frame, ", decimal(ms, 3)));
    let picture = psnr_db.map_or_else(String::new, |db| format!(", {} dB", two_decimals(db)));
    format!(
        "one assumed parameter or coefficient of the area changed at a time, against {} cycles, {time}{} bytes, {} \
         gate equivalents{picture}. {} changes, the largest percentage first (1 dB counts as {PERCENT_PER_DB} %); {still} have no effect, \
         {failed} did not finish; report.json lists all",
        thousands(cycles),
        thousands(bytes),
        thousands(area_ge),
        sensitivity.changes.len()
    )
}

/// With two decimals at most.
fn two_decimals(x: f64) -> String {
    real((x * 100.0).round() / 100.0)
}

/// Formats a change with a sign and at most two decimals. Empty for 0, so that other changes stand out.
fn signed_change(x: f64) -> String {
    match x {
        0.0 => String::new(),
        x if x.abs() < 0.005 => if x > 0.0 { "+0.00" } else { "-0.00" }.into(),
        x if x > 0.0 => format!("+{}", two_decimals(x)),
        x => two_decimals(x),
    }
}

/// A value as `--set` takes it.
fn setting_text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// The first words about a parameter.
fn short_description(about: &str) -> String {
    let first = about.split_once(". ").map_or(about, |(first, _)| first).trim_end_matches('.');
    if first.chars().count() <= ABOUT {
        return first.into();
    }
    let cut: String = first.chars().take(ABOUT - 4).collect();
    format!("{} ...", cut.rsplit_once(' ').map_or(cut.as_str(), |(whole, _)| whole))
}

/// Table of the largest changes.
pub(crate) fn changes(sensitivity: &Sensitivity) -> Table {
    let mut table = Table::new(&[
        ("Parameter", Left, 0),
        ("from", Right, 0),
        ("to", Right, 0),
        ("cycles %", Right, 0),
        ("time %", Right, 0),
        ("bytes %", Right, 0),
        ("area %", Right, 0),
        ("dB", Right, 0),
        ("description", Left, 1),
    ]);
    let moving = sensitivity.changes.iter().filter_map(|change| match &change.comes_to {
        ComesTo::Run(moved) if moved.largest_change() > 0.0 => Some((change, moved)),
        ComesTo::Run(_) | ComesTo::Nothing { .. } => None,
    });
    for (change, to) in moving.take(SHOWN) {
        table.row([
            change.parameter.clone(),
            setting_text(&change.from),
            setting_text(&change.to),
            signed_change(to.cycles_percent),
            signed_change(to.time_percent),
            signed_change(to.bytes_percent),
            signed_change(to.area_percent),
            to.psnr_change_db.map_or_else(String::new, signed_change),
            short_description(&change.about),
        ]);
    }
    table
}

/// Table of the runs that did not finish.
pub(crate) fn failed(sensitivity: &Sensitivity) -> Table {
    let mut table = Table::new(&[("Parameter", Left, 0), ("from", Right, 0), ("to", Right, 0), ("reason", Left, 0)]);
    for change in &sensitivity.changes {
        if let ComesTo::Nothing { reason } = &change.comes_to {
            table.row([change.parameter.clone(), setting_text(&change.from), setting_text(&change.to), reason.clone()]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{ParameterChange, Report};
    use crate::samples;
    use crate::text::{TableGroup, TextStyle, to_text};
    use serde_json::json;

    const BASE: Measure = Measure { cycles: 1000, frame_ms: Some(0.5), bytes: 400, area_ge: 500, psnr_db: Some(30.0) };

    fn change(parameter: &str, to: Option<(u64, u64, f64)>) -> ParameterChange {
        let moved = |(cycles, bytes, db)| ComesTo::Run(BASE.change_to(Measure { cycles, bytes, psnr_db: Some(db), ..BASE }));
        let none = || ComesTo::Nothing { reason: "deadlock: a waits for b".into() };
        ParameterChange {
            parameter: parameter.into(),
            about: "Slots. More is faster.".into(),
            unit: "tokens".into(),
            from: json!(64),
            to: json!(32),
            comes_to: to.map_or_else(none, moved),
        }
    }

    fn sensitivity() -> Sensitivity {
        let changes = vec![
            change("stuck", None),
            change("still", Some((1000, 400, 30.0))),
            change("fast", Some((900, 400, 30.0))),
            change("bytes", Some((1000, 480, 30.0))),
            change("fast as well", Some((1100, 400, 30.0))),
            change("picture", Some((1000, 400, 28.0))),
        ];
        Sensitivity::new(BASE, changes, vec!["text".into()])
    }

    #[test]
    fn largest_change_is_first_and_failed_run_last() {
        let names: Vec<String> = sensitivity().changes.into_iter().map(|change| change.parameter).collect();
        // 24.4 %, 20 %, 10 % twice, nothing.
        assert_eq!(names, ["picture", "bytes", "fast", "fast as well", "still", "stuck"]);
    }

    #[test]
    fn changes_are_relative_to_the_base_run() {
        let moved = BASE.change_to(Measure { cycles: 1333, bytes: 0, area_ge: 600, psnr_db: None, ..BASE });
        assert_eq!((moved.cycles_percent, moved.bytes_percent, moved.psnr_change_db), (33.3, -100.0, None));
        assert_eq!(moved.area_percent, 20.0);
        let nothing = Measure { cycles: 0, frame_ms: None, bytes: 0, area_ge: 0, psnr_db: None };
        assert_eq!((nothing.change_to(BASE).cycles_percent, nothing.change_to(BASE).time_percent), (0.0, 0.0));
    }

    #[test]
    fn slower_clock_has_an_effect() {
        let clock = ParameterChange {
            comes_to: ComesTo::Run(BASE.change_to(Measure { frame_ms: Some(1.0), ..BASE })),
            ..change("clock.hz", None)
        };
        let analysis = Sensitivity::new(BASE, vec![change("picture", Some((1000, 400, 28.0))), clock], vec![]);
        assert_eq!(analysis.changes[0].parameter, "clock.hz");
        assert_eq!(changes(&analysis).rows()[0][3..5], ["", "+100"]);
        assert!(caption(&analysis).contains("against 1,000 cycles, 0.500 ms per frame, 400 bytes"), "{}", caption(&analysis));
    }

    #[test]
    fn analysis_of_a_version_without_time_is_read() {
        let mut old = serde_json::to_value(sensitivity()).unwrap();
        for measure in old["changes"].as_array_mut().unwrap() {
            measure.as_object_mut().unwrap().remove("frame_ms");
            measure.as_object_mut().unwrap().remove("time_percent");
        }
        old["base"].as_object_mut().unwrap().remove("frame_ms");
        let read: Sensitivity = serde_json::from_value(old).unwrap();
        assert!(read.base.frame_ms.is_none() && !caption(&read).contains("ms per frame"));
    }

    #[test]
    fn sensitivity_tables_list_changes_and_failures() {
        let report = Report { sensitivity: Some(sensitivity()), ..samples::balanced() };
        let text = to_text(&report, TextStyle { width: 120, color: false }, &[]);
        let has = |line: &str| assert!(text.lines().any(|l| l.split_whitespace().eq(line.split(' '))), "{line}: {text}");
        has("picture 64 32 -2 Slots");
        has("bytes 64 32 +20 Slots");
        has("stuck 64 32 deadlock: a waits for b");
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            words.contains("6 changes, the largest percentage first (1 dB counts as 12.2 %); 1 have no effect, 1 did not finish"),
            "{text}"
        );
        assert!(!text.contains("still  "), "{text}");
        assert!(!to_text(&samples::balanced(), TextStyle::default(), &TableGroup::ALL).contains("assumed parameters"));
    }

    #[test]
    fn as_json_and_back() {
        let text = serde_json::to_string(&sensitivity()).unwrap();
        assert_eq!(serde_json::from_str::<Sensitivity>(&text).unwrap(), sensitivity());
        let report = Report { sensitivity: Some(sensitivity()), ..samples::balanced() };
        let json = serde_json::to_value(&report).unwrap();
        assert_eq!(json["sensitivity"]["changes"][1]["bytes_percent"], 20.0);
        let validator = jsonschema::validator_for(&crate::schema()).unwrap();
        let errors: Vec<String> = validator.iter_errors(&json).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{errors:?}");
    }
}
