//! The numbers of a report, each by its path: `cycles.total`, `quality.psnr_db`, `units.replacement.busy`.
//!
//! A path is that of `report.json`; `derived.NAME` stands for its `value`. A list below `figures`, such as a number for each frame, has
//! the path `figures.NAME.sum`. Quality has a path per frame, `quality.frames.N.psnr_db`, from 0; other lists have no path. These sums are added: `cycles.frames`, the render cycles, with the short name
//! `cycles`; `hardware.area_ge`, the area of the machine, with its parts; and `hardware.bits`, its storage.

use crate::Cell;
use basrelief_parameters::nearest;
use basrelief_report::model::{Hardware, HardwareArea};
use serde::Deserialize as _;
use serde_json::Value;
use std::collections::BTreeMap;

/// A number of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportFigure {
    /// Path of the figure in the report.
    pub name: String,
    /// Unit of measure, in the plural; empty for a ratio.
    pub unit: String,
    /// Description; may be empty.
    pub what: String,
    /// Value of the figure.
    pub cell: Cell,
}

/// Keys that plans of earlier versions name, and their names today.
const RENAMED: [(&str, &str); 5] = [
    ("drain", "write_tail"),
    ("scan_out_tail", "write_tail"),
    ("look_ups", "lookups"),
    ("utilisation", "utilization"),
    ("bus_utilisation", "bus_utilization"),
];

/// Short names of figures. A suggestion prefers them to the paths.
const SHORT_NAMES: [&str; 1] = ["cycles"];

/// Returns the path of a name in a plan.
pub fn path_of(name: &str) -> String {
    let Some((group, last)) = name.rsplit_once('.') else {
        return if name == "cycles" { "cycles.frames".into() } else { name.into() };
    };
    if name == "memories.bytes" {
        return "bytes.moved".into();
    }
    let renamed = RENAMED.iter().find(|(old, _)| *old == last);
    renamed.map_or_else(|| name.to_owned(), |(_, new)| format!("{group}.{new}"))
}

/// Parts of a report whose numbers are figures without conversion.
const PLAIN: [&str; 8] = ["cycles", "bytes", "quality", "display", "units", "fifos", "memories", "caches"];

/// Returns the figures of a report, part by part, sorted by name. The order of JSON's keys depends on features that other crates may
/// enable.
pub fn figures(report: &Value) -> Vec<ReportFigure> {
    let mut figures = Vec::new();
    for part in PLAIN {
        numbers(&report[part], &mut vec![part], &mut |path, cell| {
            figures.push(ReportFigure { name: path.join("."), unit: unit(path).into(), what: String::new(), cell });
        });
    }
    figures.extend(frame_qualities(&report["quality"]));
    figures.extend(sums(report));
    for (name, value) in sorted(&report["figures"]) {
        let legend = |key: &str| report["legend"][name][key].as_str().unwrap_or_default().to_owned();
        let figure = |name, cell| ReportFigure { name, unit: legend("unit"), what: legend("description"), cell };
        figures.extend(number(value).map(|cell| figure(format!("figures.{name}"), cell)));
        figures.extend(sum(value).map(|cell| figure(format!("figures.{name}.sum"), cell)));
    }
    for (name, derived) in sorted(&report["derived"]) {
        let text = |key: &str| derived[key].as_str().unwrap_or_default().to_owned();
        let unit = Some(text("unit")).filter(|unit| unit != "1").unwrap_or_default();
        let figure = |cell| ReportFigure { name: format!("derived.{name}"), unit, what: text("formula"), cell };
        figures.extend(number(&derived["value"]).map(figure));
    }
    figures
}

/// Returns the value of a figure by the name that plans use.
///
/// # Errors
/// The report has no such figure; the message names the nearest one.
pub fn figure_of(report: &Value, name: &str) -> Result<Cell, String> {
    let (path, mut known) = (path_of(name), figures(report));
    match known.iter().position(|figure| figure.name == path) {
        Some(at) => Ok(known.swap_remove(at).cell),
        None => Err(no_figure(name, &known)),
    }
}

/// Returns the message for an unknown figure.
pub(crate) fn no_figure(name: &str, known: &[ReportFigure]) -> String {
    let sum = format!("{name}.sum");
    let hint = if known.iter().any(|figure| figure.name == sum) {
        format!(": it is a list; name its sum, `{sum}`")
    } else {
        let near = nearest(name, SHORT_NAMES.into_iter().chain(known.iter().map(|figure| figure.name.as_str())));
        near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
    };
    format!("the report has no figure `{name}`{hint} (docs/guide/sweep-and-explore.md says how they are named)")
}

/// Path of the quality of a frame, before its number.
const FRAME_QUALITY: &str = "quality.frames.";

/// The quality of each frame; of a run with one picture, the quality of that one.
fn frame_qualities(quality: &Value) -> Vec<ReportFigure> {
    let mut found = Vec::new();
    let of_last = std::slice::from_ref(quality);
    let frames = quality["frames"].as_array().map_or(of_last, Vec::as_slice);
    for (place, frame) in frames.iter().enumerate() {
        for name in ["flip", "psnr_db", "ssim"] {
            let unit = unit(&["quality", name]).into();
            let path = format!("{FRAME_QUALITY}{place}.{name}");
            found.extend(number(&frame[name]).map(|cell| ReportFigure { name: path, unit, what: String::new(), cell }));
        }
    }
    found
}

/// Returns the path of the same figure of the first frame, which every report has, and the number of the frame.
pub(crate) fn first_frame(path: &str) -> Option<(String, usize)> {
    let (number, name) = path.strip_prefix(FRAME_QUALITY)?.split_once('.')?;
    Some((format!("{FRAME_QUALITY}0.{name}"), number.parse().ok()?))
}

fn sorted(group: &Value) -> BTreeMap<&str, &Value> {
    group.as_object().into_iter().flatten().map(|(name, value)| (name.as_str(), value)).collect()
}

fn number(value: &Value) -> Option<Cell> {
    value.as_u64().map(Cell::Whole).or_else(|| value.as_f64().map(Cell::Number))
}

/// Sum of a list of numbers, if it has any.
fn sum(value: &Value) -> Option<Cell> {
    let cells = value.as_array().filter(|list| !list.is_empty())?.iter().map(number).collect::<Option<Vec<_>>>()?;
    let whole = |cell: &Cell| if let Cell::Whole(n) = cell { Some(*n) } else { None };
    let number = |cell: &Cell| match cell {
        Cell::Whole(n) => Some(*n as f64),
        Cell::Number(x) => Some(*x),
        _ => None,
    };
    match cells.iter().map(whole).try_fold(0, |sum: u64, n| sum.checked_add(n?)) {
        Some(sum) => Some(Cell::Whole(sum)),
        None => cells.iter().map(number).sum::<Option<f64>>().map(Cell::Number),
    }
}

/// All numbers below, groups opened.
fn numbers<'a>(value: &'a Value, path: &mut Vec<&'a str>, found: &mut impl FnMut(&[&str], Cell)) {
    for (name, value) in sorted(value) {
        path.push(name);
        match number(value) {
            // A name in the patent, and no number of the run.
            Some(_) if name == "numeral" => {}
            Some(cell) => found(path, cell),
            None => numbers(value, path, found),
        }
        path.pop();
    }
}

fn sums(report: &Value) -> Vec<ReportFigure> {
    let frames = report["cycles"]["frames"].as_array().map(|frames| frames.iter().filter_map(Value::as_u64).sum());
    let hardware = Vec::<Hardware>::deserialize(&report["hardware"]).unwrap_or_default();
    let sum = |name: &str, unit: &str, what: &str, n: u64| ReportFigure {
        name: name.into(),
        unit: unit.into(),
        what: what.into(),
        cell: Cell::Whole(n),
    };
    let bits = sum("hardware.bits", "bits", "what the machine holds", hardware.iter().map(Hardware::bits).sum());
    let areas = areas(&hardware);
    let frames = frames.map(|cycles| sum("cycles.frames", "cycles", "of all frames", cycles));
    frames.into_iter().chain([bits]).chain(areas).collect()
}

/// Area of the machine; none in a report of a version without areas.
fn areas(hardware: &[Hardware]) -> impl Iterator<Item = ReportFigure> {
    let HardwareArea { logic_ge, register_bits, memory_bits, area_ge, depth_fo4 } = HardwareArea::sum(hardware);
    let all = [
        ("area_ge", "gate equivalents", "area of the machine", area_ge),
        ("logic_ge", "gate equivalents", "logic of the machine", logic_ge),
        ("register_bits", "bits", "flip-flops of the machine", register_bits),
        ("memory_bits", "bits", "memory macros of the machine", memory_bits),
        ("depth_fo4", "FO4", "largest delay of a cycle", depth_fo4),
    ];
    let figure = |(name, unit, what, n): (&str, &str, &str, u64)| ReportFigure {
        name: format!("hardware.{name}"),
        unit: unit.into(),
        what: what.into(),
        cell: Cell::Whole(n),
    };
    all.map(figure).into_iter().filter(move |_| area_ge > 0)
}

/// Returns the unit of measure of a figure without one in the report, as documented in `basrelief_report::model`.
fn unit(path: &[&str]) -> &'static str {
    let last = path.last().copied().unwrap_or_default();
    match (path[0], last) {
        ("cycles", _) | ("memories", "queue_wait" | "latency_sum" | "latency_95" | "interval") => "cycles",
        ("units", "steps") => "steps",
        ("units" | "fifos", "tokens") => "tokens",
        ("units", _) => "cycles",
        ("fifos", _) => "slots",
        ("memories", "reads" | "writes") => "requests",
        ("bytes", _) | ("memories", "read_bytes" | "write_bytes" | "moved_bytes" | "requested" | "moved") => "bytes",
        ("memories", _) => "bursts",
        ("caches", _) => "lookups",
        ("quality", "psnr_db") => "dB",
        ("quality", "mean" | "largest") => "1/255",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_number_has_its_path_and_its_unit() {
        let report = json!({
            "cycles": { "total": 10, "frames": [7], "write_tail": 3 },
            "units": { "a": { "numeral": 11, "busy": 4, "tokens": 2, "starved": { "in": 6 } } },
            "memories": { "m": { "clients": { "held": { "read_bytes": 1 }, "z_read": { "read_bytes": 5, "write_bytes": 8 } }, "channels": [{ "row_hits": 1 }], "bytes": { "moved": 64 } } },
            "bytes": { "requested": 13, "moved": 64 },
            "hardware": [{ "place": "a", "kind": "table", "description": "x", "count": 8, "width": 3, "area_ge": 90, "register_bits": 24 }],
            "figures": { "fragments": 9, "names": "x", "levels": [1, 2], "none": [], "waits": [1, 0.5], "words": ["y"] },
            "legend": { "fragments": { "unit": "fragments", "description": "drawn" } },
            "derived": { "a.utilization": { "value": 0.4, "unit": "1", "formula": "f" }, "time_ms": { "value": 2.5, "unit": "ms", "formula": "g" } },
            "quality": { "psnr_db": 30.5, "ssim": 1.0, "min": { "psnr_db": 20.5 }, "frames": [{ "psnr_db": 20.5 }, { "psnr_db": 30.5 }] },
        });
        let found: Vec<String> =
            figures(&report).into_iter().map(|f| format!("{} = {} {}", f.name, f.cell, f.unit).trim_end().to_owned()).collect();
        assert_eq!(
            found,
            [
                "cycles.total = 10 cycles",
                "cycles.write_tail = 3 cycles",
                "bytes.moved = 64 bytes",
                "bytes.requested = 13 bytes",
                "quality.min.psnr_db = 20.5 dB",
                "quality.psnr_db = 30.5 dB",
                "quality.ssim = 1.0",
                "units.a.busy = 4 cycles",
                "units.a.starved.in = 6 cycles",
                "units.a.tokens = 2 tokens",
                "memories.m.bytes.moved = 64 bytes",
                "memories.m.clients.held.read_bytes = 1 bytes",
                "memories.m.clients.z_read.read_bytes = 5 bytes",
                "memories.m.clients.z_read.write_bytes = 8 bytes",
                "quality.frames.0.psnr_db = 20.5 dB",
                "quality.frames.1.psnr_db = 30.5 dB",
                "cycles.frames = 7 cycles",
                "hardware.bits = 24 bits",
                "hardware.area_ge = 90 gate equivalents",
                "hardware.logic_ge = 0 gate equivalents",
                "hardware.register_bits = 24 bits",
                "hardware.memory_bits = 0 bits",
                "hardware.depth_fo4 = 0 FO4",
                "figures.fragments = 9 fragments",
                "figures.levels.sum = 3",
                "figures.waits.sum = 1.5",
                "derived.a.utilization = 0.4",
                "derived.time_ms = 2.5 ms",
            ]
        );
        assert_eq!(figure_of(&report, "cycles"), Ok(Cell::Whole(7)));
        assert_eq!(figure_of(&report, "hardware.area_ge"), Ok(Cell::Whole(90)));
        let list = figure_of(&report, "figures.waits").unwrap_err();
        assert!(
            list.starts_with("the report has no figure `figures.waits`: it is a list; name its sum, `figures.waits.sum`"),
            "{list}"
        );
        let meant = |name: &str| figure_of(&report, name).unwrap_err().split('`').nth(3).map(str::to_owned);
        assert_eq!(meant("hardware.aera_ge").as_deref(), Some("hardware.area_ge"));
        assert_eq!(meant("cycels").as_deref(), Some("cycles"));
        assert_eq!(meant("memories.m.clients.z.read_bytes").as_deref(), Some("memories.m.clients.z_read.read_bytes"));
        let paths = ["cycles", "cycles.drain", "derived.a.utilisation", "caches.c.hits", "memories.bytes"].map(path_of);
        assert_eq!(paths, ["cycles.frames", "cycles.write_tail", "derived.a.utilization", "caches.c.hits", "bytes.moved"]);
    }
}
