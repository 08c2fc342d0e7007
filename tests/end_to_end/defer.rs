//! Outputs of the rate-limited renderer.

use crate::support::{Place, is_valid, picture, workspace};
use serde_json::Value;
use std::path::Path;

const SMALL: &str = "--size 64x48 --quiet --set tile.width=8 --set tile.height=8";

fn lines(place: &Place, name: &str) -> Vec<Value> {
    place.text(name).lines().map(|l| serde_json::from_str(l).unwrap_or_else(|e| panic!("{name}: {e}: {l}"))).collect()
}

fn image(place: &Place, out: &str) -> String {
    place.report(out)["image"][0]["sha256"].as_str().expect("a hash").to_owned()
}

// Claim: defer, outputs: A run writes an image per round, layer depth with its scale, a tile map and both dumps.
#[test]
fn defer_writes_round_images_maps_and_dumps() {
    let place = Place::new();
    let dumps = "--dump reference-buffer buffer.jsonl --dump tiles tiles.jsonl";
    place.ok(&format!("demo gallery {SMALL} --set defer.mode=progressive {dumps} --out p"));
    let report = place.report("p");
    is_valid(&report, &place);
    let rounds = report["figures"]["picture_round"].as_array().expect("rounds").len();
    assert!(rounds >= 2, "{rounds}");
    let names = place.names("p");
    let expected = (0..rounds).map(|n| format!("image-round-{n}.png"));
    assert!(expected.chain(["layer-depth.png".into(), "tiles.png".into()]).all(|n| names.contains(&n)), "{names:?}");
    let last = picture(&place.path(&format!("p/image-round-{}.png", rounds - 1)));
    assert_eq!(last, picture(&place.path("p/image.png")));
    let pixels = lines(&place, "buffer.jsonl");
    assert_eq!(pixels.len() as u64, report["figures"]["pixels_textured"].as_u64().unwrap_or(0) / rounds as u64);
    let keys = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys(&pixels[0]).len(), 6);
    let tiles = lines(&place, "tiles.jsonl");
    let loaded = tiles.iter().filter(|t| t["state"] == "loaded").count() as u64;
    assert_eq!(Some(loaded), report["figures"]["tiles_loaded"].as_u64());
    assert_eq!(keys(&tiles[0]).len(), 6);
    place.ok(&format!("demo gallery {SMALL} --out b"));
    assert_eq!(image(&place, "p"), image(&place, "b"), "progressive ends with the picture of best resolution");
}

#[test]
fn best_first_progressive_image_is_a_round() {
    let place = Place::new();
    place.ok("demo gallery --size 64x48 --quiet --set defer.mode=progressive --out p");
    assert_eq!(place.report("p")["figures"]["picture_round"], serde_json::json!([0]));
    assert_eq!(picture(&place.path("p/image-round-0.png")), picture(&place.path("p/image.png")));
}

#[test]
fn both_engines_and_the_functional_model_agree() {
    let place = Place::new();
    // The ticked engine visits every unit in every cycle.
    let fast = "--set path.bits_per_second=30000000000 --set path.latency_us=1 --set display.enabled=false";
    let line = format!("demo gallery {SMALL} --frames 2 --no-bottlenecks {fast}");
    place.ok(&format!("{line} --out timed"));
    place.ok(&format!("{line} --out ticked --engine ticked"));
    place.ok(&format!("{line} --out functional --functional --no-exact"));
    let [timed, ticked] = ["timed", "ticked"].map(|out| crate::support::without_host(place.report(out)));
    assert_eq!(timed.to_string(), ticked.to_string());
    assert_eq!(timed["image"], place.report("functional")["image"]);
}

#[test]
fn unknown_dump_is_refused() {
    let place = Place::new();
    let refused = |line: &str| place.run(line).error(2).to_owned();
    assert!(refused("demo sphere --dump tiles t.jsonl").contains("but machine `defer` has"));
    assert!(refused("demo gallery --dump everything t.jsonl").contains("expected spans, reference-buffer, tiles"));
    assert!(place.names("").is_empty());
}

// Claim: defer, path, [0025]: A preset makes a local disk the path.
#[test]
fn local_disk_preset_is_a_path_0025() {
    let place = Place::new();
    let folder = workspace().join("presets");
    let line = |preset: &str| {
        format!("demo gallery --size 64x48 --quiet --no-exact --config {}/{preset} --out {preset}", folder.display())
    };
    let reports = ["disk.toml", "modem.toml"].map(|preset| {
        place.ok(&line(preset));
        place.report(preset)
    });
    let paths = reports.each_ref().map(|r| {
        let path = &r["config"]["path"];
        ["bits_per_second", "latency_us", "requests"].map(|key| path[key].as_u64().unwrap_or(0))
    });
    assert_eq!(paths, [[80_000_000, 14_556, 1], [56_000, 100_000, 8]]);
    let tiles = |r: &Value| r["figures"]["tiles_loaded"].as_u64().unwrap_or(0);
    let ms = |r: &Value| r["figures"]["final_picture_ms"].as_f64().unwrap_or(0.0);
    assert!(tiles(&reports[0]) > 1 && tiles(&reports[0]) == tiles(&reports[1]));
    // With one command at a time, each tile needs a seek of its own.
    let seeks = tiles(&reports[0]) as f64 * 14.556;
    assert!(ms(&reports[0]) >= seeks && ms(&reports[0]) < 1.5 * seeks + 100.0, "{} ms, {seeks} ms of seeks", ms(&reports[0]));
    assert!(ms(&reports[1]) > 3.0 * ms(&reports[0]));
}

// Claim: defer, trace: A recorded trace draws the same images in every form and mode. Two sample traces check the cycles.
#[test]
fn recorded_trace_draws_same_images_in_all_forms() {
    let place = Place::new();
    let model = workspace().join("tests/models/alcove.gltf");
    let (model, view) = (model.display(), "--size 48x36 --frames 2 --orbit 40");
    let small = "--set tile.width=8 --set tile.height=8 --quiet --machine defer --set defer.mode";
    for form in ["jsonl", "bdl", "jsonl.zst", "bdl.zst"] {
        place.ok(&format!("record {model} {view} --machine defer --out t.{form}"));
    }
    for mode in ["best", "progressive", "conventional"] {
        place.ok(&format!("run {model} {view} {small}={mode} --out scene"));
        let of_scene = place.report("scene");
        assert_eq!(of_scene["image"].as_array().map(Vec::len), Some(2));
        for form in ["jsonl", "bdl", "jsonl.zst", "bdl.zst"] {
            place.ok(&format!("run t.{form} {small}={mode} --out {form}"));
            let replayed = place.report(form);
            for (a, b) in
                of_scene["image"].as_array().into_iter().flatten().zip(replayed["image"].as_array().into_iter().flatten())
            {
                assert_eq!(a["sha256"], b["sha256"], "{mode}, {form}");
            }
            assert_eq!(replayed["figures"]["tiles_loaded"], of_scene["figures"]["tiles_loaded"], "{mode}, {form}");
        }
    }
}

#[test]
fn unwritable_dump_leaves_no_images() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        return;
    }
    let place = Place::new();
    let run = place.run("demo gallery --size 16x12 --no-exact --dump tiles /dev/full --out p");
    assert!(run.error(1).contains("/dev/full: cannot be written"), "{}", run.error(1));
    assert!(!place.path("p").exists());
}
