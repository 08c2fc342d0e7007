//! `--ablate`: runs the same input without each short cut in turn, and without all of them.

use crate::support::{Place, finish};
use serde_json::Value;
use std::fs::{self, File};

const VARIANTS: [(&str, &[&str]); 5] = [
    ("as configured", &[]),
    ("without specular-negligible", &["specular_negligible"]),
    ("without flatness", &["flatness"]),
    ("without same-plane", &["same_plane"]),
    ("without any", &["specular_negligible", "flatness", "same_plane"]),
];

#[test]
fn ablation_table_equals_separate_runs() {
    let place = Place::new();
    let said = place.ok("run demo:cut-plane@2 --size 48x36 --ablate --json").out;
    assert_eq!(place.names("out"), ["ablation.csv", "ablation.json"]);
    assert_eq!(said, place.text("out/ablation.json"));
    let ablation = place.json("out/ablation.json");
    assert_eq!(ablation["machine"], "shade");
    let csv = place.text("out/ablation.csv");
    assert_eq!(csv.lines().count(), VARIANTS.len() + 1);
    let base = ablation["variants"][0]["cycles"].as_f64().expect("cycles");
    for (i, (name, off)) in VARIANTS.into_iter().enumerate() {
        let settings: Vec<String> = off.iter().map(|key| format!("--set shortcut.{key}.enabled=false")).collect();
        place.ok(&format!("run demo:cut-plane@2 --size 48x36 --no-exact --out run {}", settings.join(" ")));
        let (report, found) = (place.report("run"), &ablation["variants"][i]);
        assert_eq!(found["variant"], name);
        assert_eq!(found["cycles"].as_u64(), Some(place.frame_cycles("run")), "{name}");
        assert_eq!(found["dots"], report["figures"]["fragments"], "{name}");
        assert_eq!(found["cycles_per_dot"], report["derived"]["cycles_per_dot"]["value"], "{name}");
        let change = 100.0 * (found["cycles"].as_f64().expect("cycles") / base - 1.0);
        assert!((found["change_percent"].as_f64().expect("a change") - change).abs() < 1e-5, "{name}");
        let line = format!("{name},{},{},", found["cycles"], found["dots"]);
        assert!(csv.lines().any(|l| l.starts_with(&line)), "{line}: {csv}");
    }
}

/// The specification: each omitted contribution is below half a step, so no output changes by more than 1. The other short
/// cuts change nothing beyond their tolerance.
// Claim: as shortcuts_change_outputs_by_at_most_their_rounding.
#[test]
fn default_thresholds_change_output_by_one_step() {
    let place = Place::new();
    for demo in ["ellipsoid@2", "cut-plane@2", "goblet@2"] {
        place.ok(&format!("demo {demo} --size 48x36 --ablate --quiet"));
        let variants = place.json("out/ablation.json")["variants"].clone();
        let largest = variants.as_array().expect("variants").iter().filter_map(|v| v["largest_change"].as_u64()).max();
        assert!(largest.is_some_and(|steps| steps <= 1), "{demo}: {variants}");
    }
}

#[test]
fn changed_picture_is_reported() {
    let place = Place::new();
    // This tolerance makes every polygon count as flat, so the picture changes without that short cut.
    place.ok("demo ellipsoid@2 --size 48x36 --set shortcut.flatness.tolerance=2 --ablate");
    let variants = place.json("out/ablation.json")["variants"].clone();
    assert!(variants[2]["largest_change"].as_u64().is_some_and(|steps| steps > 10), "{variants}");
    assert_eq!(variants[0]["largest_change"], 0);
}

#[test]
fn recorded_list_is_read_once_per_run() {
    let place = Place::new();
    place.ok("record demo:cut-plane@1 --size 48x36 --out t.bdl");
    let said = place.ok("run t.bdl --machine shade --ablate").out;
    assert!(said.contains("without same-plane") && said.contains("Written to out/: ablation.csv, ablation.json"), "{said}");
    assert_eq!(place.json("out/ablation.json")["input"]["name"], "t.bdl");
    fs::remove_dir_all(place.path("out")).expect("removed");
    let list = File::open(place.path("t.bdl")).expect("a trace");
    let outcome = finish(place.command("run - --machine shade --ablate").stdin(list));
    assert!(outcome.error(2).contains("standard input: can be read only once"), "{}", outcome.err);
    assert_eq!(place.names(""), ["t.bdl"]);
}

#[test]
fn empty_comparison_is_an_error() {
    let place = Place::new();
    assert!(
        place
            .run("demo coin --size 16x12 --ablate")
            .error(2)
            .contains("machine `bump` has no short cuts to disable; use --machine shade")
    );
    place.run("demo goblet --ablate --functional").error(2);
    let outcome = place.run("demo goblet@1 --size 16x12 --ablate --max-cycles 100");
    assert!(outcome.error(1).contains("`as configured`: reached the cycle limit"), "{}", outcome.err);
    assert_eq!(place.names(""), Vec::<String>::new());
}

#[test]
fn ablations_of_both_engines_are_identical() {
    let place = Place::new();
    let table = |out: &str, engine: &str| -> Value {
        place.ok(&format!("demo ellipsoid@1 --size 32x24 --ablate --engine {engine} --out {out} --quiet"));
        place.json(&format!("{out}/ablation.json"))
    };
    let timed = table("a", "timed").to_string();
    assert_eq!(timed, table("b", "timed").to_string());
    assert_eq!(timed, table("c", "ticked").to_string());
}
