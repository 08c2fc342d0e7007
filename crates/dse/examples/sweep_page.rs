//! A page to look at, of a made-up device with so many points:
//!
//! ```text
//! cargo run -p basrelief-dse --example sweep_page -- sweep.html 10000
//! ```
//!
//! Beside the page come its table as CSV and the Vega-Lite specification. Pages of runs are what `basrelief sweep` writes.

// Some for the samples, which name them as in their own crate.
use basrelief_dse::{Cell, Column, ColumnRole, ObjectiveDirection, PageOptions, PointState, Row, Table, page, vega, write};
use std::error::Error;
use std::path::Path;

/// Those of the tests.
#[path = "../src/samples.rs"]
mod samples;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, count] = arguments.as_slice() else { return Err("expected: OUT.html POINTS".into()) };
    let table = samples::device(count.parse()?);
    table.check()?;
    let csv = Path::new(out).with_extension("csv");
    write::csv(&table, std::fs::File::create(&csv)?)?;
    std::fs::write(Path::new(out).with_extension("vl.json"), serde_json::to_string_pretty(&vega(&table))?)?;
    let name = csv.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let options = PageOptions { files: vec![(name, "all points, all columns".into())], ..PageOptions::default() };
    std::fs::write(out, page(&table, &options))?;
    Ok(())
}
