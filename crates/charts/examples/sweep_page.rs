//! Pages to look at: of a made-up device with so many points, or of reports that `basrelief run` has written.
//!
//! ```text
//! cargo run -p basrelief-charts --example sweep_page -- sweep.html 10000
//! cargo run -p basrelief-charts --example sweep_page -- sweep.html out/64/report.json out/256/report.json ...
//! ```
//!
//! Beside the page come its table as CSV and the Vega-Lite specification. Axes are the parameters that differ; pictures are looked
//! for in the folders of the reports, which must lie below that of the page.

use basrelief_charts::{Cell, Column, Goal, PageOptions, Role, Row, State, Table, page, vega, write};
use basrelief_report::Report;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;

/// Those of the tests.
#[path = "../src/samples.rs"]
mod samples;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, what @ ..] = arguments.as_slice() else {
        return Err("expected: OUT.html POINTS, or OUT.html report.json ...".into());
    };
    let table = match what {
        [count] if count.parse::<usize>().is_ok() => samples::device(count.parse()?),
        files => of_reports(files, Path::new(out).parent().unwrap_or(Path::new("")))?,
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

/// Parameters that differ are axes; cycles, decibels and bytes are objectives.
fn of_reports(files: &[String], beside: &Path) -> Result<Table, Box<dyn Error>> {
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
        let below = folder.strip_prefix(beside).unwrap_or(folder).display().to_string();
        let picture = folder.join("image.png").exists().then(|| format!("{below}/image.png"));
        Row { id: below, state: State::Ok, cells: cells.collect(), picture }
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
