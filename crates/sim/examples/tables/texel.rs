//! Tables of the texture mapping system: divisions, cycles, displacement and picture of each method to place division points, and the
//! conditions under which the latency of a division is hidden.

use crate::support::{Inputs, Set, Table, cycles, figure, report, settings};
use basrelief_report::Report;
use basrelief_signals::Scene;
use std::error::Error;
use std::sync::Arc;

/// Accuracy criteria \[pixels\].
const BOUNDS: [&str; 8] = ["0.05", "0.1", "0.2", "0.35", "0.5", "1", "2", "4"];

/// Methods that are compared with the adaptive method.
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

/// Dividers: count, quotient bits per cycle, and whether they are pipelined.
const DIVIDERS: [[&str; 3]; 5] =
    [["1", "1", "false"], ["1", "2", "false"], ["2", "2", "false"], ["2", "1", "false"], ["2", "1", "true"]];

/// Returns the cycles in which the interpolator had a segment but no quotients.
fn starved(report: &Report) -> f64 {
    let unit = report.units.as_ref().and_then(|units| units.get("approximate-calculator"));
    unit.and_then(|unit| unit.starved.get("quotients")).copied().unwrap_or(0) as f64
}

/// Runs one method to place division points, without illuminance, so that the error is that of the division points. Without video output, so
/// that the cycles are render cycles.
fn row(scene: &Arc<Scene>, label: String, set: Set<'_>) -> Result<Vec<String>, Box<dyn Error>> {
    let set = [&[("illuminance.mode", "off"), ("display.enabled", "false")], set].concat();
    let report = report(scene, &settings("texel", &set, true)?)?;
    let quality = report.quality.as_ref().ok_or("no reference image")?.last;
    let pixels = figure(&report, "fragments");
    Ok(vec![
        label,
        format!("{:.4}", figure(&report, "divisions_per_pixel")),
        format!("{:.3}", cycles(&report) as f64 / pixels),
        format!("{:.4}", starved(&report) / pixels),
        format!("{:.3}", figure(&report, "displacement_largest")),
        format!("{:.3}", figure(&report, "displacement_mean")),
        format!("{:.2}", quality.psnr_db),
        format!("{:.4}", quality.ssim),
        format!("{:.4}", quality.flip),
    ])
}

/// Table by method, for each input.
pub fn methods(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let head =
        ["method", "divisions/pixel", "cycles/pixel", "starved/pixel", "largest displacement", "mean", "PSNR dB", "SSIM", "FLIP"];
    let mut text = String::new();
    for name in of {
        let scene = inputs.open(name, 1)?;
        let mut table = Table::new(&head, 1);
        for e in BOUNDS {
            table.row(&row(&scene, format!("adaptive, e {e}"), &[("texel.error_bound", e)])?);
        }
        for (label, set) in OTHERS {
            table.row(&row(&scene, label.into(), set)?);
        }
        text.push_str(&format!("### {name}\n\n{}\n", table.text()));
    }
    Ok(text)
}

/// Settings for memories without waits, so that only the texel value generator limits the speed.
const FAST: Set<'static> = &[
    ("display.enabled", "false"),
    ("memory.texture.burst_cycles", "1"),
    ("memory.depth.burst_cycles", "1"),
    ("memory.pixel.burst_cycles", "1"),
    ("cache.texture.sets", "4096"),
];

/// Returns the cycles per pixel in which the interpolator starved for a division, and all cycles per pixel.
fn hidden(scene: &Arc<Scene>, dividers: Set<'_>, method: (&str, &str)) -> Result<String, Box<dyn Error>> {
    let report = report(scene, &settings("texel", &[FAST, dividers, &[method]].concat(), false)?)?;
    let pixels = figure(&report, "fragments");
    Ok(format!("{:.4} of {:.2}", starved(&report) / pixels, cycles(&report) as f64 / pixels))
}

/// Table by dividers and accuracy criterion, for each input.
pub fn dividers(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let bounds = BOUNDS.map(|e| format!("e {e}"));
    let head: Vec<&str> =
        ["dividers, bits per cycle, pipelined"].into_iter().chain(bounds.iter().map(String::as_str)).chain(["exact"]).collect();
    let mut text = String::new();
    for name in of {
        let scene = inputs.open(name, 1)?;
        let mut table = Table::new(&head, 1);
        for [count, bits, pipelined] in DIVIDERS {
            let set = [("divider.count", count), ("divider.bits_per_cycle", bits), ("divider.pipelined", pipelined)];
            let methods = BOUNDS.map(|e| ("texel.error_bound", e)).into_iter().chain([("texel.method", "exact")]);
            let cells: Vec<String> = methods.map(|method| hidden(&scene, &set, method)).collect::<Result<_, _>>()?;
            table.row(&[vec![format!("{count}, {bits}, {pipelined}")], cells].concat());
        }
        text.push_str(&format!("### {name}\n\n{}\n", table.text()));
    }
    Ok(text)
}
