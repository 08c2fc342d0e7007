//! The table of docs/quality.md: picture quality, cycles and bytes over table size and levels, and the patent's promise.
//!
//! `cargo run --release -p basrelief-session --example quality -- sphere brick MODEL.glb ...`: names of demo scenes, or
//! models.

use basrelief_scene::{DEMOS, ViewOptions, demo, load_path};
use basrelief_session::{MachineInfo, Settings, Source, Unobserved, run};
use basrelief_signals::Scene;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

/// What is varied: levels, and whether their tables differ.
const VARIANTS: [(&str, &str, &str); 4] =
    [("1", "1", "different"), ("2", "2", "different"), ("2, identical tables", "2", "identical"), ("3", "3", "different")];

fn open(name: &str) -> Result<Scene, Box<dyn Error>> {
    let options = ViewOptions { frames: Some(1), ..ViewOptions::default() };
    let is_demo = DEMOS.iter().any(|d| d.name == name);
    Ok(if is_demo { demo(name, &options)? } else { load_path(Path::new(name), &options)? })
}

/// One row of the table.
fn row(scene: &Arc<Scene>, entries: &str, (label, levels, tables): (&str, &str, &str)) -> Result<String, Box<dyn Error>> {
    let set = [("replacement.entries", entries), ("brightness.levels", levels), ("replacement.tables", tables)];
    let settings = Settings { config: MachineInfo::named("bump")?.load("", &set)?, ..Settings::default() };
    let report = run(Source::Scene(Arc::clone(scene)), &settings, &mut Unobserved, None)?.report;
    let q = report.quality.as_ref().map(|q| q.last).ok_or("no exact picture")?;
    let cycles = report.cycles.as_ref().map_or(0, |c| c.total);
    let memories = report.memories.iter().flatten();
    let bytes: u64 = memories.flat_map(|(_, m)| m.clients.values()).map(|c| c.bytes()).sum();
    Ok(format!("| {entries} | {label} | {:.2} | {:.4} | {:.4} | {cycles} | {bytes} |", q.psnr_db, q.ssim, q.flip))
}

fn main() -> Result<(), Box<dyn Error>> {
    for name in std::env::args().skip(1) {
        let scene = Arc::new(open(&name)?);
        let title = Path::new(&name).file_name().map_or(name.clone(), |n| n.to_string_lossy().into_owned());
        println!("\n### {title}\n\n| entries | levels | PSNR dB | SSIM | FLIP | cycles | bytes |\n|---|---|---|---|---|---|---|");
        for entries in ["16", "64", "256", "1024"] {
            for variant in VARIANTS {
                println!("{}", row(&scene, entries, variant)?);
            }
        }
    }
    Ok(())
}
