//! Warnings of the import, on the terminal and in the report.

use crate::support::{Place, workspace};
use basrelief_scene::{ViewOptions, load_path};
use std::fs;
use std::path::{Path, PathBuf};

/// Returns the models of `tests/inputs/reports/` that are drawn.
fn models() -> Vec<PathBuf> {
    let folder = workspace().join("tests/inputs/reports");
    let folders = fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let models = folders.flat_map(|folder| ["m.obj", "m.gltf", "q.gltf"].map(|name| folder.join(name)));
    models.filter(|path| path.is_file()).collect()
}

/// Runs a model and checks that the terminal and the report have the warnings of the import. Returns their number.
fn check(place: &Place, model: &Path) -> usize {
    let scene = match load_path(model, &ViewOptions::default()) {
        Ok(scene) => scene,
        Err(error) => {
            let refused = place.run(&format!("run {} --size 16x12 --out out", model.display()));
            assert!(refused.error(1).contains(&error.what), "{}: {}", model.display(), refused.err);
            return 0;
        }
    };
    let run = place.ok(&format!("run {} --machine texel --size 16x12 --no-exact --out out", model.display()));
    let report = place.report("out");
    let reported: Vec<&str> = report["warnings"].as_array().expect("a list").iter().filter_map(|text| text.as_str()).collect();
    // The terminal wraps lines.
    let unwrapped = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let terminal = unwrapped(&format!("{}{}", run.out, run.err));
    for warning in &scene.warnings {
        assert!(reported.contains(&&**warning), "{}: {warning}: {reported:?}", model.display());
        assert!(terminal.contains(&unwrapped(warning)), "{}: {warning}: {terminal}", model.display());
    }
    scene.warnings.len()
}

#[test]
fn import_warnings_reach_terminal_and_report() {
    let place = Place::new();
    let models = models();
    assert!(models.len() >= 48, "{}", models.len());
    let warned = models.iter().filter(|model| check(&place, model) > 0).count();
    assert!(warned >= 11, "{warned} models with a warning");
}

#[test]
fn unused_normal_map_is_a_warning() {
    let place = Place::new();
    for machine in ["bump", "shade", "texel", "defer"] {
        let run = place.ok(&format!("demo golf-ball --machine {machine} --size 16x12 --no-exact --quiet --out {machine}"));
        let warnings = place.report(machine)["warnings"].to_string();
        let expected = "polygons have a normal map; the device has no normal maps and leaves it out";
        assert_eq!(warnings.contains(expected), machine != "bump", "{machine}: {warnings} {}", run.err);
    }
}

/// An invalid glTF file that is drawn all the same.
#[test]
fn invalid_but_drawn_gltf_warns_in_report() {
    let place = Place::new();
    let models = workspace().join("tests/models");
    for name in ["bumps.png", "checks.png"] {
        fs::copy(models.join(name), place.path(name)).expect("copied");
    }
    let mut document: serde_json::Value =
        serde_json::from_slice(&fs::read(models.join("patch.gltf")).expect("read")).expect("JSON");
    document["nodes"][0]["rotation"] = serde_json::json!([0.0, 0.0, 0.0, 3.0]);
    document["nodes"][0].as_object_mut().expect("an object").remove("matrix");
    fs::write(place.path("m.gltf"), document.to_string()).expect("written");
    assert!(check(&place, &place.path("m.gltf")) > 0);
}
