//! Pages to look at: of a made-up device with so many points, or of reports that `basrelief run` has written.
//!
//! ```text
//! cargo run -p basrelief-charts --example page -- sweep.html 10000
//! cargo run -p basrelief-charts --example page -- sweep.html out/64/report.json out/256/report.json ...
//! ```
//!
//! Beside the page come `sweep.csv` and the Vega-Lite specification. Axes are the parameters that differ; pictures are looked for
//! in the folders of the reports.

use basrelief_charts::{Cell, Column, Goal, PageOptions, Role, Row, State, Table, page, vega, write};
use basrelief_report::Report;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, what @ ..] = arguments.as_slice() else {
        return Err("expected: OUT.html POINTS, or OUT.html report.json ...".into());
    };
    let table = match what {
        [count] if count.parse::<usize>().is_ok() => made_up(count.parse()?),
        files => of_reports(files)?,
    };
    table.check()?;
    let csv = Path::new(out).with_extension("csv");
    write::csv(&table, std::fs::File::create(&csv)?)?;
    std::fs::write(Path::new(out).with_extension("vl.json"), serde_json::to_string_pretty(&vega(&table))?)?;
    let name = csv.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let options = PageOptions { files: vec![(name, "all points, all columns".into())], ..PageOptions::default() };
    std::fs::write(out, page(&table, &options))?;
    Ok(())
}

fn column(name: &str, unit: &str, role: Role) -> Column {
    Column { name: name.into(), unit: unit.into(), role, what: String::new() }
}

/// Entries, lanes, levels and a method; cycles, decibels and bytes as they might be.
fn made_up(count: usize) -> Table {
    let row = |number: usize| {
        let at = |every: usize, length: usize| number / every % length;
        let (entries, lanes, levels, method) = (at(1, 25), at(25, 8), at(200, 5), at(1000, 10));
        let size = 16.0 * libm::exp2(entries as f64 / 3.0);
        let noise = f64::from((number as u32).wrapping_mul(2_654_435_761) >> 20) / 4096.0;
        let db = 14.0 + 0.9 * entries as f64 + 1.2 * levels as f64 + noise + if method % 3 == 0 { 1.0 } else { 0.0 };
        let cycles = 220_000.0 + 900.0 * size * (levels + 1) as f64 / libm::exp2(lanes as f64 / 2.0) + 8000.0 * noise;
        let bytes = 5_300_000 + (size as u64) * 128 * (levels as u64 + 1);
        let state = if number % 97 == 5 {
            State::Failed("deadlock: `shaded` is full, `replacement` waits for it".into())
        } else {
            State::Ok
        };
        let figures = [Cell::Whole(cycles as u64), Cell::Number(db), Cell::Whole(bytes)];
        let method = Cell::Text(["nearest", "linear", "blocked", "blocked_6d", "direct"][method % 5].into());
        let axes = [Cell::Whole(size as u64), Cell::Whole(1 << lanes), Cell::Whole(levels as u64 + 1), method];
        Row {
            id: format!("{:016x}", (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)),
            state,
            cells: figures.into_iter().chain(axes).collect(),
            picture: None,
        }
    };
    let columns = vec![
        column("cycles.total", "cycles", Role::Objective(Goal::Min)),
        column("quality.psnr_db", "dB", Role::Objective(Goal::Max)),
        column("memories.bytes", "bytes", Role::Objective(Goal::Min)),
        column("replacement.entries", "entries", Role::Axis),
        column("search.lanes", "inner products/cycle", Role::Axis),
        column("levels", "", Role::Axis),
        column("texture.layout", "", Role::Axis),
    ];
    let constraints = vec!["quality.psnr_db >= 18".parse().unwrap()];
    Table { title: format!("a made-up device, {count} points"), columns, constraints, rows: (0..count).map(row).collect() }
}

/// Parameters that differ are axes; cycles, decibels and bytes are objectives.
fn of_reports(files: &[String]) -> Result<Table, Box<dyn Error>> {
    let read = |file: &String| Ok::<_, Box<dyn Error>>(Report::from_json(&std::fs::read_to_string(file)?)?);
    let reports: Vec<Report> = files.iter().map(read).collect::<Result<_, _>>()?;
    let configs: Vec<BTreeMap<String, Cell>> = reports.iter().map(|report| flat(&report.config)).collect();
    let names: BTreeSet<&String> = configs.iter().flat_map(BTreeMap::keys).collect();
    let differs = |name: &&String| configs.iter().any(|config| config.get(*name) != configs[0].get(*name));
    let axes: Vec<&String> = names.into_iter().filter(differs).collect();
    let objectives = [
        column("cycles.total", "cycles", Role::Objective(Goal::Min)),
        column("quality.psnr_db", "dB", Role::Objective(Goal::Max)),
        column("memories.bytes", "bytes", Role::Objective(Goal::Min)),
    ];
    let columns = objectives.into_iter().chain(axes.iter().map(|name| column(name, "", Role::Axis))).collect();
    let row = |((file, report), config): ((&String, &Report), &BTreeMap<String, Cell>)| {
        let whole = |n: Option<u64>| n.map_or(Cell::Missing, Cell::Whole);
        let db = report.quality.as_ref().map_or(Cell::Missing, |quality| Cell::Number(quality.last.psnr_db));
        let figures = [whole(report.cycles.as_ref().map(|cycles| cycles.total)), db, whole(report.memory_bytes())];
        let cells = figures.into_iter().chain(axes.iter().map(|name| config.get(*name).cloned().unwrap_or(Cell::Missing)));
        let folder = Path::new(file).parent().unwrap_or(Path::new("."));
        let picture = folder.join("image.png").exists().then(|| folder.join("image.png").display().to_string());
        Row { id: folder.display().to_string(), state: State::Ok, cells: cells.collect(), picture }
    };
    let rows = files.iter().zip(&reports).zip(&configs).map(row).collect();
    Ok(Table { title: format!("{} · {}", reports[0].machine, reports[0].input.name), columns, constraints: vec![], rows })
}

/// A configuration with dotted names; lists as text.
fn flat(config: &serde_json::Value) -> BTreeMap<String, Cell> {
    let mut cells = BTreeMap::new();
    let mut open: Vec<(String, &serde_json::Value)> = vec![(String::new(), config)];
    while let Some((name, value)) = open.pop() {
        let cell = match value {
            serde_json::Value::Object(group) => {
                let dot = if name.is_empty() { "" } else { "." };
                open.extend(group.iter().map(|(key, value)| (format!("{name}{dot}{key}"), value)));
                continue;
            }
            serde_json::Value::Null => Cell::Missing,
            serde_json::Value::Number(number) => {
                number.as_u64().map_or(Cell::Number(number.as_f64().unwrap_or(0.0)), Cell::Whole)
            }
            serde_json::Value::String(text) => Cell::Text(text.clone()),
            other => Cell::Text(other.to_string()),
        };
        cells.insert(name, cell);
    }
    cells
}
