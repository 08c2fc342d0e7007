//! Tables on the figure shading device: cycles and picture on each of the six paths, what each short cut saves, and how that
//! grows with the time that circuit (50) takes.
//!
//! `cargo run --release -p basrelief-session --example short_cuts -- goblet@1 goblet@4 MODEL.glb ...`: demo scenes or models.

use basrelief_report::work::{routes, work};
use basrelief_scene::{DEMOS, ViewOptions, demo, load_path};
use basrelief_session::{MachineInfo, Run, SessionError, Settings, Source, Unobserved, ablate, run};
use basrelief_signals::Scene;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

type Set<'a> = &'a [(&'a str, &'a str)];

/// Every polygon on one path, by thresholds that nothing exceeds.
const PATHS: [(&str, Set<'static>); 6] = [
    ("polyhedron", &[("shade.mode", "polyhedron")]),
    ("brightness", &[("shade.mode", "brightness")]),
    ("normal", &[("shortcut.specular_negligible.enabled", "false"), ("shortcut.flatness.enabled", "false")]),
    ("gate_closed", &[("shortcut.specular_negligible.threshold", "1"), ("shortcut.flatness.enabled", "false")]),
    ("flat", &[("shortcut.flatness.tolerance", "2"), ("shortcut.same_plane.enabled", "false")]),
    (
        "reused",
        &[
            ("shortcut.flatness.tolerance", "2"),
            ("shortcut.same_plane.normal_tolerance", "2"),
            ("shortcut.same_plane.constant_tolerance", "1"),
        ],
    ),
];

/// Cycles of a multiplication in circuit (50).
const MULTIPLY_CYCLES: [&str; 6] = ["1", "2", "4", "8", "16", "32"];

fn open(name: &str) -> Result<Scene, Box<dyn Error>> {
    let options = ViewOptions { frames: Some(1), ..ViewOptions::default() };
    let is_demo = DEMOS.iter().any(|d| Some(d.name) == name.split('@').next());
    Ok(if is_demo { demo(name, &options)? } else { load_path(Path::new(name), &options)? })
}

fn settings(set: Set<'_>) -> Result<Settings, Box<dyn Error>> {
    Ok(Settings { config: MachineInfo::named("shade")?.load("", set)?, ..Settings::default() })
}

fn draw(scene: &Arc<Scene>, settings: &Settings) -> Result<Run, SessionError> {
    run(Source::Scene(Arc::clone(scene)), settings, &mut Unobserved, None)
}

/// One row per path.
fn on_each_path(scene: &Arc<Scene>) -> Result<(), Box<dyn Error>> {
    println!(
        "\n| path | dots on it % | cycles | cycles/dot | cycles/polygon | PSNR dB | mean error |\n|---|---|---|---|---|---|---|"
    );
    for (path, set) in PATHS {
        let report = draw(scene, &settings(set)?)?.report;
        let value = |figure: &str| report.derived.get(figure).map_or(0.0, |d| d.value);
        let quality = report.quality.as_ref().ok_or("no exact picture")?;
        let cycles = report.cycles.as_ref().map_or(0, |c| c.total);
        let on_it: u64 = routes(&report).iter().filter(|p| p.name == path).map(|p| p.dots).sum();
        let share = 100.0 * on_it as f64 / work(&report).count as f64;
        let (per_dot, per_polygon) = (value("cycles_per_dot"), value("cycles_per_polygon"));
        let (psnr, mean) = (quality.last.psnr_db, quality.difference.map_or(0.0, |d| d.mean));
        println!("| {path} | {share:.1} | {cycles} | {per_dot:.2} | {per_polygon:.1} | {psnr:.2} | {mean:.3} |");
    }
    Ok(())
}

/// One row per time of a multiplication: cycles as configured, and change without each short cut and without any.
fn by_time_of_a_multiplication(scene: &Arc<Scene>) -> Result<(), Box<dyn Error>> {
    println!(
        "\n| cycles of a multiplication | as configured | without specular-negligible % | flatness % | same-plane % | any % | largest change |"
    );
    println!("|---|---|---|---|---|---|---|");
    for cycles in MULTIPLY_CYCLES {
        let settings = settings(&[("normal_interpolation.multiply_cycles", cycles)])?;
        let table = ablate(&settings, &mut Unobserved, |settings, observer| {
            run(Source::Scene(Arc::clone(scene)), settings, observer, None)
        })?;
        let changes: Vec<String> = table.variants.iter().skip(1).map(|v| format!("{:+.2}", v.change_percent)).collect();
        let largest = table.variants.iter().map(|v| v.largest_change).max().unwrap_or(0);
        println!("| {cycles} | {} | {} | {largest} |", table.variants[0].cycles, changes.join(" | "));
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    for name in std::env::args().skip(1) {
        let scene = Arc::new(open(&name)?);
        let title = Path::new(&name).file_name().map_or(name.clone(), |n| n.to_string_lossy().into_owned());
        let triangles: usize = scene.objects.iter().map(|o| o.mesh.indices.len() / 3).sum();
        println!("\n### {title}, {triangles} triangles");
        on_each_path(&scene)?;
        by_time_of_a_multiplication(&scene)?;
    }
    Ok(())
}
