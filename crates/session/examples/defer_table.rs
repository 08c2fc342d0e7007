//! Bytes over the path and time to pictures: three modes, five rates of the path, one viewpoint and an orbit.
//!
//! `cargo run --release -p basrelief-session --example defer_table -- gallery MODEL ...`: demo scenes or models.

use basrelief_report::Report;
use basrelief_report::model::Figure;
use basrelief_scene::{DEMOS, ViewOptions, demo, load_path};
use basrelief_session::{MachineInfo, Settings, Source, Unobserved, run};
use basrelief_signals::Scene;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

const MODES: [&str; 3] = ["best", "progressive", "conventional"];
/// Names of paths, their rates \[bit/s\] and latencies \[us\].
const PATHS: [(&str, &str, &str); 5] = [
    ("56 kbit/s", "56000", "100000"),
    ("1 Mbit/s", "1000000", "20000"),
    ("10 Mbit/s", "10000000", "1000"),
    ("100 Mbit/s", "100000000", "500"),
    ("1 Gbit/s", "1000000000", "100"),
];
/// Pictures of an orbit.
const ORBIT: u32 = 12;

fn open(name: &str, frames: u32) -> Result<Scene, Box<dyn Error>> {
    let orbit_degrees = (frames > 1).then_some(360.0);
    let options = ViewOptions { frames: Some(frames), orbit_degrees, ..ViewOptions::default() };
    Ok(if DEMOS.iter().any(|d| d.name == name) { demo(name, &options)? } else { load_path(Path::new(name), &options)? })
}

fn draw(scene: &Arc<Scene>, mode: &str, (_, rate, latency): (&str, &str, &str)) -> Result<Report, Box<dyn Error>> {
    let set = [("defer.mode", mode), ("path.bits_per_second", rate), ("path.latency_us", latency)];
    let config = MachineInfo::named("defer")?.load("", &set)?;
    let settings = Settings { config, exact: false, ..Settings::default() };
    Ok(run(Source::Scene(Arc::clone(scene)), &settings, &mut Unobserved, None)?.report)
}

fn number(report: &Report, name: &str) -> f64 {
    match report.device.get(name) {
        Some(Figure::Count(n)) => *n as f64,
        Some(Figure::Real(x)) => *x,
        _ => 0.0,
    }
}

/// Seconds in three digits.
fn seconds(s: f64) -> String {
    let digits = if s >= 100.0 { 0 } else { 2 - s.max(0.001).log10().floor() as i32 };
    format!("{s:.*}", digits.clamp(0, 6) as usize)
}

/// One row per mode: bytes and tiles, then, per rate, seconds to the first and to the last picture of the first view, or of all
/// views to the last.
fn table(name: &str, frames: u32) -> Result<(), Box<dyn Error>> {
    let scene = Arc::new(open(name, frames)?);
    let file = Path::new(name).file_name().map_or(name.into(), |n| n.to_string_lossy());
    let what =
        if frames == 1 { "one viewpoint: first / final picture".into() } else { format!("orbit of {frames}: all pictures") };
    println!("\n`{file}`, {what} \\[s\\]\n");
    println!("| mode | bytes over the path | tiles loaded | synthesized | reused | {} |", PATHS.map(|p| p.0).join(" | "));
    println!("|---|---:|---:|---:|---:|{}", "---:|".repeat(PATHS.len()));
    for mode in MODES {
        let mut times = Vec::new();
        let mut last = None;
        for path in PATHS {
            let report = draw(&scene, mode, path)?;
            let total = report.cycles.as_ref().map_or(0, |c| c.total) as f64 / 200e6;
            let [first, end] = ["first_picture_ms", "final_picture_ms"].map(|n| seconds(number(&report, n) / 1e3));
            times.push(if frames == 1 { format!("{first} / {end}") } else { seconds(total) });
            last = Some(report);
        }
        let Some(report) = last else { continue };
        let of = ["path_bytes", "tiles_loaded", "tiles_synthesized", "tiles_reused"].map(|n| number(&report, n).to_string());
        println!("| {mode} | {} | {} |", of.join(" | "), times.join(" | "));
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let names = if named.is_empty() { vec!["gallery".into()] } else { named };
    for name in &names {
        table(name, 1)?;
        table(name, ORBIT)?;
    }
    Ok(())
}
