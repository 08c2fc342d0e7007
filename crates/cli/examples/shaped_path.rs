//! Measures and models the times to pictures over shaped paths: the tables of docs/experiments/defer.md.
//!
//! ```text
//! cargo run --release -p basrelief-cli --example shaped_path              # one tile by a request
//! cargo run --release -p basrelief-cli --example shaped_path -- several   # several tiles by a request
//! cargo run --release -p basrelief-cli --example shaped_path -- views     # a user who looks around
//! ```
//!
//! The slow paths take some minutes. Cargo builds `basrelief` with the example, which runs it from the folder above its own.

mod common;
#[path = "../../../tests/end_to_end/relay.rs"]
mod relay;

use common::{Server, program};
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Runs: rate of the path \[bit/s\] and options.
const RUNS: [(u64, &str); 3] = [
    (56_000, "--size 320x240 --set defer.mode=progressive"),
    (1_000_000, "--size 640x480 --set defer.mode=progressive"),
    (10_000_000, "--size 640x480 --set defer.mode=progressive"),
];
/// Size of an answer's head \[bytes\]: `head_bytes` per request in `host.path` of the report.
const HEAD_BYTES: u64 = 310;
/// Latencies \[ms\].
const LATENCIES: [u64; 3] = [0, 50, 200];

/// Options for small tiles, so that the heads of answers matter.
const SMALL_TILES: &str =
    "--size 320x240 --set defer.mode=progressive --set tile.width=16 --set tile.height=16 --set tile.encoding=png";
/// Rates and latencies for several tiles per request \[bit/s, ms\].
const PATHS: [(u64, u64); 3] = [(56_000, 50), (1_000_000, 200), (10_000_000, 200)];
/// Times at which the user turns by 40 degrees \[ms\].
const TURNS: [u64; 4] = [0, 2000, 2500, 6000];

fn main() -> Result<(), Box<dyn Error>> {
    let program = program()?;
    let server = Server::start(&program, "demo:gallery")?;
    match std::env::args().nth(1).as_deref() {
        Some("several") => several(&program, &server.address),
        Some("views") => views(&program, &server.address),
        _ => single(&program, &server.address),
    }
}

/// Prints modelled and measured times with one tile per request.
fn single(program: &Path, address: &str) -> Result<(), Box<dyn Error>> {
    println!(
        "| path | latency | first picture, modelled | measured | | final picture, modelled | measured | |\n|---|---:|---:|---:|---:|---:|---:|---:|"
    );
    for (rate, options) in RUNS {
        for latency in LATENCIES {
            let report = report(program, address, rate, latency, options)?;
            println!("| {} | {latency} ms | {} | {} |", name(rate), agreement(&report, "first")?, agreement(&report, "final")?);
        }
    }
    Ok(())
}

/// Prints bytes and time to the final picture with several tiles per request.
fn several(program: &Path, address: &str) -> Result<(), Box<dyn Error>> {
    println!(
        "| path | latency | tiles by a request | requests | their bytes | heads of answers | tiles | final picture, modelled | measured | |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
    );
    for (rate, latency) in PATHS {
        for most in [1, 4, 16, 64] {
            let options = format!("{SMALL_TILES} --set path.tiles_per_request={most}");
            let report = report(program, address, rate, latency, &options)?;
            let path = &report["host"]["path"];
            let [requests, asked, heads, tiles] =
                ["requests", "request_bytes", "head_bytes", "tile_bytes"].map(|name| path[name].as_u64().unwrap_or_default());
            let agreement = agreement(&report, "final")?;
            println!("| {} | {latency} ms | {most} | {requests} | {asked} | {heads} | {tiles} | {agreement} |", name(rate));
        }
    }
    Ok(())
}

/// Prints, for a user looking around, the tiles of each view and the time of its last picture.
fn views(program: &Path, address: &str) -> Result<(), Box<dyn Error>> {
    println!(
        "| path | latency | view | begins | tiles, modelled | measured | last picture, modelled | measured |\n|---|---:|---:|---:|---:|---:|---:|---:|"
    );
    let script = std::env::temp_dir().join(format!("views-{}.json", std::process::id()));
    let views: Vec<Value> = (0..).zip(TURNS).map(|(i, at)| serde_json::json!({"at_ms": at, "orbit": 40 * i})).collect();
    std::fs::write(&script, serde_json::json!({ "views": views }).to_string())?;
    for (rate, latency) in [(1_000_000, 50), (10_000_000, 50)] {
        let path = modelled_path(rate, latency);
        let options = format!("--size 640x480 --set defer.mode=progressive --views {}", script.display());
        let modelled = run(program, &format!("demo gallery {options} {path} --no-exact"))?;
        let measured = report(program, address, rate, latency, &options)?;
        let (model, real) = (last_pictures(&modelled, &modelled["figures"]), last_pictures(&measured, &measured["host"]["path"]));
        for (view, at) in TURNS.iter().enumerate() {
            let [of_model, of_path] = [&modelled, &measured].map(|report| &report["figures"]["view_tiles"][view]);
            println!(
                "| {} | {latency} ms | {} | {:.2} s | {of_model} | {of_path} | {:.2} s | {:.2} s |",
                name(rate),
                view + 1,
                *at as f64 / 1e3,
                model.get(view).ok_or("no picture")? / 1e3,
                real.get(view).ok_or("no picture")? / 1e3
            );
        }
    }
    std::fs::remove_file(script)?;
    Ok(())
}

/// Returns the time of the last picture of each view \[ms\].
fn last_pictures(report: &Value, times: &Value) -> Vec<f64> {
    let numbers = |of: &Value| of.as_array().into_iter().flatten().filter_map(Value::as_f64).collect::<Vec<_>>();
    let (frames, times) = (numbers(&report["figures"]["picture_frame"]), numbers(&times["picture_at_ms"]));
    let is_last = |i: usize| frames.get(i + 1) != frames.get(i);
    times.into_iter().enumerate().filter(|(i, _)| is_last(*i)).map(|(_, time)| time).collect()
}

/// Runs over a path of this rate \[bit/s\] and latency \[ms\] and returns the report.
fn report(program: &Path, address: &str, rate: u64, latency: u64, options: &str) -> Result<Value, Box<dyn Error>> {
    let shaped = relay::relay(address, rate as f64, Duration::from_millis(latency))?;
    run(program, &format!("run --from http://{shaped}/ {options} {}", modelled_path(rate, latency)))
}

/// Returns the settings that describe the path to the model.
fn modelled_path(rate: u64, latency: u64) -> String {
    format!("--set path.bits_per_second={rate} --set path.latency_us={} --set path.head_bytes={HEAD_BYTES}", 1000 * latency)
}

/// Runs the program and returns its report.
fn run(program: &Path, line: &str) -> Result<Value, Box<dyn Error>> {
    let out = std::env::temp_dir().join(format!("shaped-path-{}", std::process::id()));
    let line = format!("{line} --json --no-bottlenecks --quiet --out");
    let run = Command::new(program).args(line.split(' ')).arg(&out).stderr(Stdio::inherit()).output()?;
    std::fs::remove_dir_all(&out)?;
    Ok(serde_json::from_slice(&run.stdout)?)
}

/// Returns the modelled time to a picture, the measured time, and the relative difference.
fn agreement(report: &Value, picture: &str) -> Result<String, Box<dyn Error>> {
    let time = |of: &Value| of.as_f64().ok_or("no time");
    let path = &report["host"]["path"];
    let modelled = time(&report["figures"][format!("{picture}_picture_ms")])?;
    // The measured time excludes the host's own time while the path was idle.
    let measured = time(&path[format!("{picture}_picture_ms")])? - time(&path[format!("{picture}_picture_idle_ms")])?;
    Ok(format!("{:.2} s | {:.2} s | {:+.1} %", modelled / 1e3, measured / 1e3, 100.0 * (measured / modelled - 1.0)))
}

fn name(rate: u64) -> String {
    if rate < 1_000_000 { format!("{} kbit/s", rate / 1000) } else { format!("{} Mbit/s", rate / 1_000_000) }
}
