//! Times to the first and to the final picture over shaped paths, measured and modelled: the table of docs/defer.md.
//!
//! ```text
//! cargo run --release -p basrelief-cli --example shaped_path
//! ```
//!
//! It takes some minutes: the slow paths are slow. With it `basrelief` is built and taken from the folder above.

mod common;
#[path = "../../../tests/end_to_end/relay.rs"]
mod relay;

use common::{Server, program};
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// What is drawn over which path: rate \[bit/s\], options.
const RUNS: [(u64, &str); 3] = [
    (56_000, "--size 320x240 --set defer.mode=progressive"),
    (1_000_000, "--size 640x480 --set defer.mode=progressive"),
    (10_000_000, "--size 640x480 --set defer.mode=progressive"),
];
/// Latencies \[ms\].
const LATENCIES: [u64; 3] = [0, 50, 200];

fn main() -> Result<(), Box<dyn Error>> {
    let program = program()?;
    let server = Server::start(&program, "demo:gallery")?;
    println!(
        "| path | latency | first picture, modelled | measured | | final picture, modelled | measured | |\n|---|---:|---:|---:|---:|---:|---:|---:|"
    );
    for (rate, options) in RUNS {
        for latency in LATENCIES {
            println!("{}", row(&program, &server.address, (rate, latency), options)?);
        }
    }
    Ok(())
}

/// A run over a path of this rate \[bit/s\] and latency \[ms\], as a row.
fn row(program: &Path, address: &str, (rate, latency): (u64, u64), options: &str) -> Result<String, Box<dyn Error>> {
    let shaped = relay::relay(address, rate as f64, Duration::from_millis(latency))?;
    let line = format!(
        "run --from http://{shaped}/ {options} --set path.bits_per_second={rate} --set path.latency_us={} --json --no-limits --quiet --out",
        1000 * latency
    );
    let out = std::env::temp_dir().join(format!("shaped-path-{}", std::process::id()));
    let run = Command::new(program).args(line.split(' ')).arg(&out).stderr(Stdio::inherit()).output()?;
    std::fs::remove_dir_all(&out)?;
    let report: Value = serde_json::from_slice(&run.stdout)?;
    let time = |of: &Value| of.as_f64().ok_or("no time");
    let mut row = format!("| {} | {latency} ms |", name(rate));
    for name in ["first_picture", "final_picture"] {
        let path = &report["host"]["path"];
        let modelled = time(&report["figures"][format!("{name}_ms")])?;
        // Without what the host took while the path had nothing to do.
        let measured = time(&path[format!("{name}_ms")])? - time(&path[format!("{name}_idle_ms")])?;
        row += &format!(" {:.2} s | {:.2} s | {:+.1} % |", modelled / 1e3, measured / 1e3, 100.0 * (measured / modelled - 1.0));
    }
    Ok(row)
}

fn name(rate: u64) -> String {
    if rate < 1_000_000 { format!("{} kbit/s", rate / 1000) } else { format!("{} Mbit/s", rate / 1_000_000) }
}
