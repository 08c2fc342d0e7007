//! `compare`: changes between reports, and their causes.

use crate::support::Place;
use serde_json::Value;
use std::fs;

const SMALL: &str = "demo mixed --size 64x48";
const QUICK: &str = "demo corridor --size 48x36 --no-exact --quiet";

fn json(place: &Place, line: &str) -> Value {
    serde_json::from_str(&place.ok(&format!("compare {line} --json")).out).expect("JSON")
}

/// Returns the output of `compare` as one line.
fn said(place: &Place, line: &str) -> String {
    place.ok(&format!("compare {line}")).out.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn comparing_fails_only_over_its_limit() {
    let place = Place::new();
    place.ok(&format!("{SMALL} --out a"));
    place.ok(&format!("{SMALL} --out b --set memory.graphics.cl=900"));
    let same = place.ok("compare a a --fail-over 0").out;
    assert!(!same.is_empty());
    assert!(place.ok("compare a b/report.json").out.contains("graphics"));
    assert!(place.run("compare a b --fail-over 0.01").error(1).contains("worse by"));
    place.ok("compare a b --fail-over 100000");
    let json: Value = serde_json::from_str(&place.ok("compare a b --json").out).expect("JSON");
    assert!(json.is_object());
    fs::write(place.path("no.json"), "{}").expect("written");
    assert!(place.run("compare a no.json").error(1).contains("no.json"));
}

#[test]
fn comparing_two_machines_is_reported() {
    let place = Place::new();
    place.ok("demo goblet@1 --size 32x24 --out a --quiet");
    place.ok("demo goblet@1 --size 32x24 --machine bump --out b --quiet");
    let said = place.ok("compare a b").out;
    let words: Vec<&str> = said.split_whitespace().collect();
    assert!(words.join(" ").starts_with("The machines differ: A is shade, B is bump."), "{said}");
}

#[test]
fn compare_measures_causes_from_recordings() {
    let place = Place::new();
    place.ok(&format!("{QUICK} --out a"));
    let set = "--set memory.texture.part=sdr-100 --set fifo.pixels.depth=2 --set texel.error_bound=0.1";
    place.ok(&format!("{QUICK} {set} --out b"));
    let [before, after] = ["a", "b"].map(|folder| place.frame_cycles(folder) as i64);
    let comparison = json(&place, "a b/report.json");
    assert_eq!((comparison["a"].as_str(), comparison["b"].as_str()), (Some("a"), Some("b/report.json")));
    let shares = comparison["explained"].as_array().expect("shares");
    let sum: i64 = shares.iter().map(|share| share["by"].as_i64().expect("measured")).sum();
    assert_eq!(sum + comparison["together"].as_i64().expect("a number"), after - before);
    let groups: Vec<&str> = shares.iter().filter_map(|share| share["group"].as_str()).collect();
    for (share, group) in shares.iter().zip(&groups) {
        let options: Vec<String> =
            share["set"].as_array().expect("options").iter().map(|set| format!("--set {}", set.as_str().unwrap())).collect();
        place.ok(&format!("{QUICK} --no-bottlenecks {set} {} --out promised", options.join(" ")));
        assert_eq!(Some(place.frame_cycles("promised")), share["cycles"].as_u64(), "{group}");
    }
    let told = said(&place, "a b");
    assert!(groups.contains(&"memory.texture") && told.contains(" memory.texture: "), "{told}");
    assert!(groups.contains(&"work") && told.contains(" work parameters: "), "{told}");
    place.ok("resimulate a --set memory.texture.cl=9 --out c --quiet");
    assert!(said(&place, "a c").contains(" all due to memory.texture."), "results of resimulate can be compared");
}

#[test]
fn several_reports_compare_with_the_first() {
    let place = Place::new();
    for (folder, set) in [("a", ""), ("b", "--set memory.texture.cl=9"), ("c", "--set memory.texture.cl=99 --no-bottlenecks")] {
        place.ok(&format!("{QUICK} {set} --out {folder}"));
    }
    let list = json(&place, "a b c");
    let pairs: Vec<_> = list.as_array().expect("a list").iter().map(|pair| (&pair["a"], &pair["b"])).collect();
    assert_eq!(pairs, [(&"a".into(), &"b".into()), (&"a".into(), &"c".into())]);
    assert_eq!(list[0], json(&place, "a b"));
    assert_eq!((list[0]["explained"][0]["group"].as_str(), list[1].get("explained")), (Some("memory.texture"), None));
    let told = said(&place, "a b c");
    assert!(told.starts_with("Report render cycles per ") && told.contains("A: a, B: c B takes "), "{told}");
    assert!(told.contains("all due to memory.texture.") && told.contains("To measure the causes, keep the recording"), "{told}");
    let worst = |n: usize| list[n]["worst"]["percent"].as_f64().expect("a number");
    assert!(worst(0) < worst(1));
    place.ok(&format!("compare a c b --fail-over {}", worst(1)));
    assert!(place.run(&format!("compare a c b --fail-over {}", worst(0))).error(1).contains("worse by"));
}

#[test]
fn damaged_or_foreign_recording_is_named() {
    let place = Place::new();
    place.ok(&format!("{QUICK} --out a"));
    place.ok(&format!("{QUICK} --set memory.texture.cl=9 --out b"));
    place.ok("demo goblet@1 --size 32x24 --quiet --no-exact --out c");
    let tape = place.bytes("b/run.recording");
    for (wrong, words) in [
        (&tape[..tape.len() / 2], "not a recording"),
        (b"no tape", "not a recording"),
        (&place.bytes("c/run.recording"), "belong to different runs"),
    ] {
        fs::write(place.path("b/run.recording"), wrong).expect("written");
        for line in ["a b", "b a", "a a b"] {
            let error = place.run(&format!("compare {line}"));
            assert!(error.error(1).starts_with("b/run.recording: ") && error.err.contains(words), "{line}: {}", error.err);
        }
    }
    // A recording does not belong to a report with another name in the same folder.
    fs::rename(place.path("b/report.json"), place.path("b/kept.json")).expect("renamed");
    assert!(said(&place, "a b/kept.json").contains("To measure the causes, keep the recording"));
}
