//! Tables of the figure shading device: cycles and picture of each of the six paths, savings of each shortcut, and their dependence on the
//! time of circuit (50).

use crate::support::{Inputs, Set, Table, cycles, grouped, report, settings};
use basrelief_signals::Scene;
use basrelief_sim::{NoObserver, RunInput, ablate, run};
use std::error::Error;
use std::sync::Arc;

/// Settings that put every polygon on one path, by thresholds that nothing exceeds.
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

/// Key of the cycles of a multiplication.
const MULTIPLY: &str = "operators.multiply.latency";

/// Cycles of a multiplication. The power of circuit (50) consists of several multiplications.
const MULTIPLY_CYCLES: [&str; 6] = ["1", "2", "4", "8", "16", "32"];

/// Settings for the same picture by full normal interpolation.
const FULL: Set<'static> = &[
    ("normal_interpolation.inner_products", "2"),
    ("shortcut.specular_negligible.enabled", "false"),
    ("shortcut.flatness.enabled", "false"),
    ("shortcut.same_plane.enabled", "false"),
];

fn triangles(scene: &Scene) -> String {
    grouped(scene.objects.iter().map(|o| o.mesh.indices.len() as u64 / 3).sum())
}

/// Table by path.
pub fn paths(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let head = ["model", "triangles", "path", "cycles/dot", "cycles/polygon", "PSNR dB", "mean error, 8 bits"];
    let mut table = Table::new(&head, 3);
    for name in of {
        let scene = inputs.open(name, 1)?;
        for (path, set) in PATHS {
            let report = report(&scene, &settings("shade", set, true)?)?;
            let value = |figure: &str| report.derived.get(figure).map_or(0.0, |d| d.value);
            let quality = report.quality.as_ref().ok_or("no reference image")?;
            table.row(&[
                (*name).to_owned(),
                triangles(&scene),
                format!("`{path}`"),
                format!("{:.2}", value("cycles_per_dot")),
                format!("{:.1}", value("cycles_per_polygon")),
                format!("{:.2}", quality.last.psnr_db),
                format!("{:.3}", quality.difference.map_or(0.0, |d| d.mean)),
            ]);
        }
    }
    Ok(table.text())
}

/// Table by time of a multiplication: cycles as configured, and change without each shortcut and without all.
pub fn short_cuts(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let head = [
        "model",
        "cycles of a multiplication",
        "cycles",
        "specular negligible %",
        "flatness %",
        "same plane %",
        "any %",
        "largest change",
    ];
    let mut table = Table::new(&head, 1);
    for name in of {
        let scene = inputs.open(name, 1)?;
        for multiply in MULTIPLY_CYCLES {
            let settings = settings("shade", &[(MULTIPLY, multiply)], true)?;
            let of_short_cuts = ablate(&settings, &mut NoObserver, |settings, observer| {
                run(RunInput::scene(Arc::clone(&scene)), settings, observer, None)
            })?;
            let variants = &of_short_cuts.variants;
            let mut cells = vec![(*name).to_owned(), multiply.to_owned(), grouped(variants[0].cycles)];
            cells.extend(variants.iter().skip(1).map(|v| format!("{:+.2}", v.change_percent)));
            cells.push(variants.iter().map(|v| v.largest_change).max().unwrap_or(0).to_string());
            table.row(&cells);
        }
    }
    Ok(table.text())
}

/// Table of the cycles of full normal interpolation relative to the configured device, by time of a multiplication.
pub fn full_over_hybrid(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let head: Vec<&str> = ["model"].into_iter().chain(MULTIPLY_CYCLES).collect();
    let mut table = Table::new(&head, 1);
    for name in of {
        let scene = inputs.open(name, 1)?;
        let mut cells = vec![(*name).to_owned()];
        for multiply in MULTIPLY_CYCLES {
            let multiply = [(MULTIPLY, multiply)];
            let cycles = |set: Set<'_>| -> Result<f64, Box<dyn Error>> {
                Ok(cycles(&report(&scene, &settings("shade", &[&multiply[..], set].concat(), false)?)?) as f64)
            };
            cells.push(format!("{:.2}", cycles(FULL)? / cycles(&[])?));
        }
        table.row(&cells);
    }
    Ok(table.text())
}

/// Slowdown of the CPU (11) relative to the default.
const CPU_SCALES: [&str; 7] = ["1", "2", "5", "10", "20", "30", "40"];

/// Table of the cycles of full normal interpolation relative to the configured device, by the cost of CPU operations, and the first cost at
/// which the device no longer pays. Without the decisions of the shortcuts the CPU has less work, so the ratio falls with the cost.
pub fn cpu(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let heads = CPU_SCALES.map(|scale| format!("x{scale}"));
    let head: Vec<&str> = ["model"].into_iter().chain(heads.iter().map(String::as_str)).chain(["pays below"]).collect();
    let mut table = Table::new(&head, 1);
    for name in of {
        let scene = inputs.open(name, 1)?;
        let gain = |scale: &str| -> Result<f64, Box<dyn Error>> {
            let scale = [("cpu.scale", scale)];
            let cycles = |set: Set<'_>| -> Result<f64, Box<dyn Error>> {
                Ok(cycles(&report(&scene, &settings("shade", &[&scale[..], set].concat(), false)?)?) as f64)
            };
            Ok(cycles(FULL)? / cycles(&[])?)
        };
        let gains = CPU_SCALES.into_iter().map(gain).collect::<Result<Vec<_>, _>>()?;
        let cells = gains.iter().map(|gain| format!("{gain:.2}"));
        let row: Vec<String> = [(*name).to_owned()].into_iter().chain(cells).chain([break_even(&gains)]).collect();
        table.row(&row);
    }
    Ok(table.text())
}

/// Returns the cost at which the gain falls to 1, by linear interpolation between the measured costs.
fn break_even(gains: &[f64]) -> String {
    let scales: Vec<f64> = CPU_SCALES.iter().filter_map(|scale| scale.parse().ok()).collect();
    let Some(first) = gains.iter().position(|gain| *gain < 1.0) else {
        return format!("above x{}", CPU_SCALES[CPU_SCALES.len() - 1]);
    };
    if first == 0 {
        return "never".into();
    }
    let share = (gains[first - 1] - 1.0) / (gains[first - 1] - gains[first]);
    format!("x{:.1}", scales[first - 1] + share * (scales[first] - scales[first - 1]))
}

#[test]
fn break_even_is_at_a_gain_of_one() {
    assert_eq!(break_even(&[0.9; 7]), "never");
    assert_eq!(break_even(&[1.2; 7]), "above x40");
    assert_eq!(break_even(&[2.0, 1.5, 1.2, 1.1, 0.9, 0.8, 0.7]), "x15.0");
}
