//! Views: cameras, orbits, lights, sizes.

use crate::support::{Place, picture};
use serde_json::Value;

fn image(report: &Value) -> &str {
    report["image"].as_array().and_then(|i| i.last()).and_then(|i| i["sha256"].as_str()).expect("a picture")
}

#[test]
fn reported_camera_draws_same_picture() {
    let place = Place::new();
    place.ok("run PATCH --size 64x48 --light 1,2,3 --out a");
    let report = place.report("a");
    let camera = &report["camera"];
    let mut keys: Vec<&String> = camera.as_object().expect("an object").keys().collect();
    keys.sort();
    assert_eq!(keys, ["to_light", "to_viewer", "view_projection"]);
    assert_eq!(camera["view_projection"].as_array().map(Vec::len), Some(16));
    std::fs::write(place.path("camera.json"), camera.to_string()).expect("written");
    place.ok("run PATCH --size 64x48 --camera camera.json --out b");
    assert_eq!(image(&place.report("b")), image(&report));
    place.ok("run PATCH --size 64x48 --out c");
    assert_ne!(image(&place.report("c")), image(&report), "another light makes another picture");
}

#[test]
fn frame_k_of_n_turns_by_k_nths_of_the_angle() {
    let place = Place::new();
    place.ok("run PATCH --size 48x36 --frames 4 --orbit 80 --out all");
    let all = place.report("all");
    assert_eq!(all["image"].as_array().map(Vec::len), Some(4));
    assert_eq!(all["image"][3]["file"], "image-0004.png");
    for (kind, k) in ["image", "reference", "difference"].iter().flat_map(|kind| (1..=4).map(move |k| (kind, k))) {
        assert_eq!(picture(&place.path(&format!("all/{kind}-000{k}.png"))).0, 48);
    }
    // Both pictures are turned by the same angle, but belong to different sequences.
    place.ok("run PATCH --size 48x36 --frames 2 --orbit 80 --out half");
    assert_eq!(place.report("half")["image"][1]["sha256"], all["image"][2]["sha256"], "1/2 of 80 is 2/4 of 80");
    assert_eq!(place.report("half")["image"][0]["sha256"], all["image"][0]["sha256"]);
    assert_ne!(all["image"][1]["sha256"], all["image"][2]["sha256"]);
}

#[test]
fn obj_with_pictures_is_drawn() {
    let place = Place::new();
    let model = crate::support::workspace().join("tests/models/patch.obj");
    place.ok(&format!("run {} --size 64x48", model.display()));
    let report = place.report("out");
    assert!(report["figures"]["bump_fragments"]["value"].as_u64().or(report["figures"]["bump_fragments"].as_u64()) > Some(100));
    assert_eq!(picture(&place.path("out/image.png")).2, image(&report));
}
