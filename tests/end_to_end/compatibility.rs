//! Files of version 0.1.0, as its program wrote them, are read by this version (docs/reference/file-formats.md).

use crate::support::{Place, workspace};
use serde_json::Value;

/// Files of 0.1.0, made by commit 67f5f9d0 from `tests/models/patch.gltf`.
const FILES: [&str; 8] =
    ["report.json", "run.tape", "trace.jsonl", "trace.bdl.zst", "plan.toml", "config.toml", "views.toml", "camera.json"];

/// Returns a folder with these files, and the model.
fn old_files() -> Place {
    let place = Place::new();
    for name in FILES {
        std::fs::copy(workspace().join("tests/inputs/0.1.0").join(name), place.path(name)).expect("copied");
    }
    for name in ["patch.gltf", "bumps.png", "checks.png"] {
        std::fs::copy(workspace().join("tests/models").join(name), place.path(name)).expect("copied");
    }
    place
}

#[test]
fn report_of_0_1_0_is_compared() {
    let place = old_files();
    let old = place.json("report.json");
    assert_eq!((&old["schema"], &old["version"]), (&Value::from("basrelief-report/2"), &Value::from("0.1.0")));
    let same = place.ok("compare report.json report.json");
    assert!(same.out.ends_with("The reports are equal, host figures aside.\n"), "{}", same.out);
    place.ok("run patch.gltf --size 16x12 --out now --quiet");
    let compared: Value = serde_json::from_str(&place.ok("compare report.json now --json").out).expect("JSON");
    let sections = compared["sections"].as_array().expect("sections").iter();
    let changes = sections.flat_map(|section| section["changes"].as_array().expect("changes"));
    // The keys of 0.1.0 stand for the keys of today, so every figure has a partner.
    let changed = |name: &str| changes.clone().find(|change| change["field"] == name).map(|change| change["a"].clone());
    assert_eq!(changed("write_tail"), Some(old["cycles"]["drain"].clone()), "cycles.drain of 0.1.0");
}

#[test]
fn recording_of_0_1_0_is_refused_with_its_build() {
    let place = old_files();
    std::fs::create_dir(place.path("old")).expect("a folder");
    for name in ["run.tape", "report.json"] {
        std::fs::copy(place.path(name), place.path(&format!("old/{name}"))).expect("copied");
    }
    for line in ["resimulate run.tape", "resimulate old", "size-fifos run.tape"] {
        let outcome = place.run(line);
        let error = outcome.error(1);
        for words in ["build 0.1.0 of basrelief made the recording", "11 stages, but the machine has 10", "run the machine again"]
        {
            assert!(error.contains(words), "{line}: {error}");
        }
    }
    let compared = place.ok("compare old old");
    assert!(compared.err.contains("causes are not measured"), "{}", compared.err);
}

#[test]
fn traces_of_0_1_0_are_replayed_and_converted() {
    let place = old_files();
    place.ok("convert trace.bdl.zst converted.jsonl");
    place.ok("convert trace.jsonl again.jsonl");
    assert_eq!(place.text("converted.jsonl"), place.text("again.jsonl"));
    let old = place.text("trace.jsonl");
    assert_eq!(place.text("again.jsonl").lines().count(), old.lines().count());
    let replayed = ["trace.jsonl", "trace.bdl.zst", "again.jsonl"].map(|name| {
        place.ok(&format!("run {name} --out out --quiet"));
        place.report("out")["image"][0]["sha256"].clone()
    });
    let drawn = place.json("report.json")["image"][0]["sha256"].clone();
    assert_eq!(replayed, [drawn.clone(), drawn.clone(), drawn], "the picture of 0.1.0");
}

#[test]
fn plan_of_0_1_0_is_swept() {
    let place = old_files();
    place.ok("sweep plan.toml --out points --quiet");
    let table = place.text("points/sweep.jsonl");
    assert_eq!(table.lines().count(), 4);
    assert!(table.lines().all(|line| line.contains("\"state\":\"ok\"")), "{table}");
    for column in ["bytes.moved", "cycles.write_tail"] {
        assert!(table.contains(column), "{column}: {table}");
    }
}

#[test]
fn configuration_views_and_camera_of_0_1_0_are_read() {
    let place = old_files();
    let described = place.ok("describe bump --config config.toml --json").out;
    let described: Vec<Value> = serde_json::from_str(&described).expect("JSON");
    let value = |key: &str| described.iter().find(|row| row["key"] == key).map(|row| row["value"].clone());
    assert_eq!(value("replacement.lanes"), Some(16.into()));
    assert_eq!(value("display.pixel_hz"), Some(25_000_000.into()), "video_out.pixel_hz of 0.1.0");
    place.ok("run patch.gltf --size 16x12 --camera camera.json --out camera --quiet");
    place.ok("run patch.gltf --size 16x12 --views views.toml --out views --quiet");
    assert_eq!(place.report("camera")["camera"], place.json("camera.json"));
    assert_eq!(place.report("views")["cycles"]["frames"].as_array().map(Vec::len), Some(2));
}
