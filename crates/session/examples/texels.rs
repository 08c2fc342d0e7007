//! The tables of docs/texel.md: divisions, cycles, displacement and picture of each way to place division points, and when the
//! time of a division is hidden.
//!
//! `cargo run --release -p basrelief-session --example texels -- corridor turntable MODEL.gltf ...`: demo scenes or models.

use basrelief_report::Report;
use basrelief_report::model::Figure;
use basrelief_scene::{DEMOS, ViewOptions, demo, load_path};
use basrelief_session::{MachineInfo, Settings, Source, Unobserved, run};
use basrelief_signals::Scene;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

type Set<'a> = &'a [(&'a str, &'a str)];

/// Accuracy criteria \[pixels\].
const BOUNDS: [&str; 8] = ["0.05", "0.1", "0.2", "0.35", "0.5", "1", "2", "4"];

/// What the adaptive method is held against.
const OTHERS: [(&str, Set<'static>); 11] = [
    ("adaptive, e 0.5, approximate step", &[("texel.step_form", "approximate")]),
    ("adaptive, e 0.5, table of 64 steps", &[("texel.step_table", "64")]),
    ("fixed, 4", &[("texel.method", "fixed"), ("texel.interval", "4")]),
    ("fixed, 8", &[("texel.method", "fixed"), ("texel.interval", "8")]),
    ("fixed, 16", &[("texel.method", "fixed"), ("texel.interval", "16")]),
    ("fixed, 32", &[("texel.method", "fixed"), ("texel.interval", "32")]),
    ("fixed, 7 points per line", &[("texel.method", "fixed"), ("texel.points", "7")]),
    ("subpolygon, 16", &[("texel.method", "subpolygon"), ("texel.interval", "16")]),
    ("subpolygon, 32", &[("texel.method", "subpolygon"), ("texel.interval", "32")]),
    ("exact", &[("texel.method", "exact")]),
    ("exact, reciprocal", &[("texel.method", "exact"), ("divider.division", "reciprocal")]),
];

/// Dividers: how many, latency, initiation interval.
const DIVIDERS: [[&str; 3]; 5] = [["1", "32", "32"], ["1", "16", "16"], ["2", "16", "16"], ["2", "32", "32"], ["2", "32", "1"]];

fn open(name: &str) -> Result<Scene, Box<dyn Error>> {
    let options = ViewOptions { frames: Some(1), ..ViewOptions::default() };
    let is_demo = DEMOS.iter().any(|d| Some(d.name) == name.split('@').next());
    Ok(if is_demo { demo(name, &options)? } else { load_path(Path::new(name), &options)? })
}

fn report(scene: &Arc<Scene>, set: Set<'_>, exact: bool) -> Result<Report, Box<dyn Error>> {
    let settings = Settings { config: MachineInfo::named("texel")?.load("", set)?, exact, ..Settings::default() };
    Ok(run(Source::Scene(Arc::clone(scene)), &settings, &mut Unobserved, None)?.report)
}

fn figure(report: &Report, name: &str) -> f64 {
    match report.device.get(name) {
        Some(Figure::Count(n)) => *n as f64,
        Some(Figure::Real(x)) => *x,
        _ => 0.0,
    }
}

/// Cycles in which the interpolator had a segment and no quotients.
fn starved(report: &Report) -> f64 {
    let unit = report.units.as_ref().and_then(|units| units.get("approximate-calculator"));
    unit.and_then(|unit| unit.starved.get("quotients")).copied().unwrap_or(0) as f64
}

fn row(scene: &Arc<Scene>, label: &str, set: Set<'_>) -> Result<(), Box<dyn Error>> {
    // Pictures of textures alone: what is lost is lost by division points. No video output: cycles are those of drawing.
    let set = [&[("illuminance.mode", "off"), ("video_out.enabled", "false")], set].concat();
    let report = report(scene, &set, true)?;
    let quality = report.quality.as_ref().ok_or("no exact picture")?.last;
    let pixels = figure(&report, "fragments");
    let cycles = report.cycles.as_ref().map_or(0, |c| c.total) as f64;
    println!(
        "| {label} | {:.4} | {:.3} | {:.4} | {:.3} | {:.3} | {:.2} | {:.4} | {:.4} |",
        figure(&report, "divisions_per_pixel"),
        cycles / pixels,
        starved(&report) / pixels,
        figure(&report, "displacement_largest"),
        figure(&report, "displacement_mean"),
        quality.psnr_db,
        quality.ssim,
        quality.flip
    );
    Ok(())
}

fn methods(scene: &Arc<Scene>) -> Result<(), Box<dyn Error>> {
    println!(
        "\n| method | divisions/pixel | cycles/pixel | starved/pixel | largest displacement | mean | PSNR dB | SSIM | FLIP |\n|---|---|---|---|---|---|---|---|---|"
    );
    for e in BOUNDS {
        row(scene, &format!("adaptive, e {e}"), &[("texel.error_bound", e)])?;
    }
    OTHERS.iter().try_for_each(|(label, set)| row(scene, label, set))
}

/// Cycles per pixel in which the interpolator starved for a division, and in all, by dividers and criterion. Memories that
/// never keep anybody waiting leave the texel value generator alone.
fn hidden(scene: &Arc<Scene>) -> Result<(), Box<dyn Error>> {
    let fast = [
        ("video_out.enabled", "false"),
        ("memory.texture.burst_cycles", "1"),
        ("memory.depth.burst_cycles", "1"),
        ("memory.pixel.burst_cycles", "1"),
        ("cache.texture.sets", "4096"),
    ];
    println!(
        "\n| dividers, latency, interval | {} | exact |\n|{}",
        BOUNDS.map(|e| format!("e {e}")).join(" | "),
        "---|".repeat(10)
    );
    for [count, latency, interval] in DIVIDERS {
        let of_method = |method: (&str, &str)| -> Result<String, Box<dyn Error>> {
            let dividers = [("divider.count", count), ("divider.latency", latency), ("divider.initiation_interval", interval)];
            let report = report(scene, &[&fast[..], &dividers, &[method]].concat(), false)?;
            let pixels = figure(&report, "fragments");
            let cycles = report.cycles.as_ref().map_or(0, |c| c.total) as f64;
            Ok(format!("{:.4} of {:.2}", starved(&report) / pixels, cycles / pixels))
        };
        let cells: Vec<String> = BOUNDS.iter().map(|e| of_method(("texel.error_bound", e))).collect::<Result<_, _>>()?;
        println!("| {count}, {latency}, {interval} | {} | {} |", cells.join(" | "), of_method(("texel.method", "exact"))?);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    for name in std::env::args().skip(1) {
        let scene = Arc::new(open(&name)?);
        let title = Path::new(&name).file_name().map_or(name.clone(), |n| n.to_string_lossy().into_owned());
        println!("\n### {title}");
        methods(&scene)?;
        hidden(&scene)?;
    }
    Ok(())
}
