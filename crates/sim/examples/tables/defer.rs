//! Tables of the rate-limited renderer: bytes over the path and time to pictures.

use crate::support::{Inputs, Set, Table, figure, grouped, report, settings};
use basrelief_report::Report;
use basrelief_signals::Scene;
use std::error::Error;
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

/// Caps on the number of layers.
const CAPS: [&str; 6] = ["0", "1", "2", "3", "4", "31"];

/// Seconds in three digits.
fn seconds(s: f64) -> String {
    let digits = if s >= 100.0 { 0 } else { 2 - s.max(0.001).log10().floor() as i32 };
    format!("{s:.*}", digits.clamp(0, 6) as usize)
}

fn draw(scene: &Arc<Scene>, mode: &str, rate: &str, latency: &str) -> Result<Report, Box<dyn Error>> {
    let set = [("defer.mode", mode), ("path.bits_per_second", rate), ("path.latency_us", latency)];
    report(scene, &settings("defer", &set, false)?)
}

/// Row of a mode: bytes and tiles, then for each rate the seconds to the first and the last picture of the first view, or to the picture of
/// the last view.
fn by_mode(scene: &Arc<Scene>, frames: u32) -> Result<String, Box<dyn Error>> {
    let head = ["mode", "bytes over the path", "tiles loaded", "synthesized", "reused"];
    let head: Vec<&str> = head.into_iter().chain(PATHS.map(|p| p.0)).collect();
    let mut table = Table::new(&head, 1);
    for mode in MODES {
        let draw = |(_, rate, latency)| draw(scene, mode, rate, latency);
        let reports: Vec<Report> = PATHS.into_iter().map(draw).collect::<Result<_, _>>()?;
        let counts = ["path_bytes", "tiles_loaded", "tiles_synthesized", "tiles_reused"];
        let counts = counts.map(|name| grouped(figure(&reports[0], name) as u64));
        let seconds = |report: &Report| {
            let [first, last] = ["first_picture_ms", "final_picture_ms"].map(|name| seconds(figure(report, name) / 1e3));
            if frames == 1 { format!("{first} / {last}") } else { seconds(total_seconds(report)) }
        };
        table.row(&[vec![mode.to_owned()], counts.to_vec(), reports.iter().map(seconds).collect()].concat());
    }
    Ok(table.text())
}

/// Returns the time of all frames by the machine's clock.
fn total_seconds(report: &Report) -> f64 {
    let hz = report.config.pointer("/clock/hz").and_then(serde_json::Value::as_f64).unwrap_or(1.0);
    report.frame_cycles() as f64 / hz
}

/// Tables by mode and path, for one view and for an orbit, for each input.
pub fn tiles(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    for name in of {
        let one = by_mode(&inputs.open(name, 1)?, 1)?;
        let all = by_mode(&inputs.open(name, ORBIT)?, ORBIT)?;
        text.push_str(&format!("`{name}`, one view: first / last image \\[s\\]\n\n{one}\n"));
        text.push_str(&format!("`{name}`, orbit of {ORBIT}: all images \\[s\\]\n\n{all}\n"));
    }
    Ok(text)
}

/// Table by cap on Dmax: bytes of tiles, bytes of the conventional mode, and picture quality.
pub fn dmax(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let mut table = Table::new(&["input", "`defer.dmax`", "tile bytes", "conventional", "PSNR dB"], 1);
    for name in of {
        let scene = inputs.open(name, 1)?;
        for cap in CAPS {
            let set: Set<'_> = &[("defer.dmax", cap)];
            let report = report(&scene, &settings("defer", set, true)?)?;
            let psnr = report.quality.as_ref().ok_or("no reference image")?.last.psnr_db;
            let [tiles, all] = ["path_tile_bytes", "conventional_tile_bytes"].map(|n| grouped(figure(&report, n) as u64));
            table.row(&[(*name).to_owned(), cap.to_owned(), tiles, all, format!("{psnr:.2}")]);
        }
    }
    Ok(table.text())
}
