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
fn limit_never_passes_missing_figures() {
    let place = Place::new();
    let demo = "demo golf-ball --size 32x24 --quiet";
    let coarse = "--set replacement.entries=16";
    for (folder, options) in [
        ("a", ""),
        ("functional", "--functional"),
        ("no-quality", "--no-exact"),
        ("coarse", coarse),
        ("bare", "--functional --no-exact"),
    ] {
        place.ok(&format!("{demo} {options} --out {folder}"));
    }
    let fails = |line: &str| place.run(&format!("compare {line} --fail-over 1000000")).error(1).to_owned();
    assert!(fails("a functional").starts_with("functional: cycles cannot be judged: A has it and B lacks it"));
    assert!(fails("a no-quality").starts_with("no-quality: quality cannot be judged: A has it and B lacks it"));
    assert!(fails("a coarse no-quality").starts_with("no-quality: quality"));
    assert!(fails("bare a").contains("A has neither cycles nor bytes nor quality"));
    assert!(!place.ok("compare a functional").out.contains("No regression"));
    place.ok("compare functional a --fail-over 0");
    let error = place.run("compare a coarse --fail-over 2").error(1).to_owned();
    assert!(error.starts_with("coarse: quality.psnr_db got worse by ") && error.contains(" %; the limit is 2 %"), "{error}");
}

#[test]
fn slower_clock_fails_limit_in_time() {
    let place = Place::new();
    let demo = "demo coin --size 40x30 --set display.enabled=false --quiet";
    place.ok(&format!("{demo} --out fast"));
    place.ok(&format!("{demo} --set clock.hz=20000000 --out slow"));
    let told = said(&place, "fast slow");
    assert!(told.contains("B: slow A frame takes 0.283 ms in A and 2.829 ms in B (+900 %). The clock is 200 MHz in A"), "{told}");
    assert!(told.contains("2.829 (+900.0 %)"), "{told}");
    let time = &json(&place, "fast slow")["sections"][1];
    assert_eq!((&time["table"], &time["changes"][0]["name"]), (&"derived".into(), &"frame_ms".into()));
    let error = place.run("compare fast slow --fail-over 899").error(1).to_owned();
    assert!(error.contains("derived.frame_ms got worse by 900"), "{error}");
    // The slow run has almost the same cycles, so only time differs in the other direction.
    place.ok("compare slow fast --fail-over 0");
    let page = |line: &str| place.ok(&format!("compare {line} --html page.html"));
    page("fast slow");
    assert!(place.text("page.html").contains("2.829 at 20 MHz"));
}

#[test]
fn limit_counts_every_frame() {
    let place = Place::new();
    place.ok("demo golf-ball --size 32x24 --frames 3 --quiet --out a");
    let mut report = place.report("a");
    report["quality"]["frames"][1]["psnr_db"] = 5.0.into();
    fs::write(place.path("middle.json"), report.to_string()).expect("written");
    let error = place.run("compare a middle.json --fail-over 2").error(1).to_owned();
    assert!(error.starts_with("middle.json: quality.frames[1].psnr_db got worse by "), "{error}");
    let mut report = place.report("a");
    report["quality"]["frames"].as_array_mut().expect("frames").pop();
    fs::write(place.path("fewer.json"), report.to_string()).expect("written");
    let error = place.run("compare a fewer.json --fail-over 2").error(1).to_owned();
    assert!(error.contains("quality.frames cannot be judged: A has 3 frames and B has 2"), "{error}");
}

#[test]
fn limit_rejects_unfinished_runs_and_other_inputs() {
    let place = Place::new();
    let demo = "demo golf-ball --size 32x24 --quiet";
    place.ok(&format!("{demo} --out a"));
    place.run(&format!("{demo} --max-cycles 100 --out cut")).error(1);
    let error = place.run("compare a cut --fail-over 1000000").error(1).to_owned();
    assert!(error.contains("cut: outcome cannot be judged: run B did not finish (limit)"), "{error}");
    assert!(!error.contains("inf"), "{error}");
    place.ok("demo golf-ball --size 32x24 --turn 5,0 --quiet --out other");
    let error = place.run("compare a other --fail-over 1000000").error(1).to_owned();
    assert!(error.starts_with("other: input.sha256 differs from A"), "{error}");
    place.ok("compare a other --fail-over 1000000 --allow-other-input");
    assert_eq!(place.run("compare a other --allow-other-input").code(), 2);
    assert_eq!(place.run("compare a other --fail-over nan").code(), 2);
}

#[test]
fn comparing_two_machines_is_reported() {
    let place = Place::new();
    place.ok("demo goblet@1 --size 32x24 --out a --quiet");
    place.ok("demo goblet@1 --size 32x24 --machine bump --out b --quiet");
    let said = place.ok("compare a b").out;
    let words: Vec<&str> = said.split_whitespace().collect();
    assert!(words.join(" ").contains("The machines differ: A is shade, B is bump."), "{said}");
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
    let mut parameters: Vec<&str> = shares.iter().filter_map(|share| share["parameter"].as_str()).collect();
    for (share, parameter) in shares.iter().zip(&parameters) {
        let options: Vec<String> =
            share["set"].as_array().expect("options").iter().map(|set| format!("--set {}", set.as_str().unwrap())).collect();
        place.ok(&format!("{QUICK} --no-bottlenecks {} --out promised", options.join(" ")));
        assert_eq!(Some(place.frame_cycles("promised")), share["cycles"].as_u64(), "{parameter}");
    }
    parameters.sort_unstable();
    assert_eq!(parameters, ["fifo.pixels.depth", "memory.texture.part", "texel.error_bound"]);
    let told = said(&place, "a b");
    assert!(parameters.iter().all(|parameter| told.contains(&format!(" {parameter} "))), "{told}");
    place.ok("resimulate a --set memory.texture.cl=90 --out c --quiet");
    assert!(said(&place, "a c").contains(" all due to memory.texture.cl."), "results of resimulate can be compared");
}

/// The machine runs again for each of several work parameters, on the demo that the reports name or on a given input.
#[test]
fn work_parameters_are_explained_one_by_one() {
    let place = Place::new();
    let demo = "demo golf-ball --size 32x24 --frames 1 --no-exact --quiet";
    place.ok(&format!("{demo} --set replacement.entries=128 --out a"));
    place.ok(&format!("{demo} --set replacement.lanes=32 --set brightness.levels=1 --out b"));
    let parameters = |line: &str| {
        let list = json(&place, line)["explained"].as_array().cloned().unwrap_or_default();
        let mut names: Vec<String> = list.iter().filter_map(|share| share["parameter"].as_str().map(str::to_owned)).collect();
        names.sort_unstable();
        names
    };
    let all = ["brightness.levels", "replacement.entries", "replacement.lanes"];
    assert_eq!(parameters("a b"), all);
    assert_eq!(parameters("a b --input demo:golf-ball --size 32x24 --frames 1"), all);
    assert_eq!(parameters("a b --explain timing"), ["work"]);
    assert_eq!(parameters("a b --explain none"), [""; 0]);
    assert!(said(&place, "a b").contains(" a run "), "{}", said(&place, "a b"));
    let error = place.run("compare a b --input demo:golf-ball --size 8x8 --frames 1").error(1).to_owned();
    assert!(error.contains("is not the input of the first report"), "{error}");
    assert!(place.run("compare a b --size 8x8").error(2).contains("--input"));
}

#[test]
fn several_reports_compare_with_the_first() {
    let place = Place::new();
    for (folder, set) in [("a", ""), ("b", "--set memory.texture.cl=90"), ("c", "--set memory.texture.cl=300 --no-bottlenecks")] {
        place.ok(&format!("{QUICK} {set} --out {folder}"));
    }
    let list = json(&place, "a b c");
    let pairs: Vec<_> = list.as_array().expect("a list").iter().map(|pair| (&pair["a"], &pair["b"])).collect();
    assert_eq!(pairs, [(&"a".into(), &"b".into()), (&"a".into(), &"c".into())]);
    assert_eq!(list[0], json(&place, "a b"));
    assert_eq!((list[0]["explained"][0]["parameter"].as_str(), list[1].get("explained")), (Some("memory.texture.cl"), None));
    let told = said(&place, "a b c");
    assert!(told.starts_with("Report render cycles ms per frame ") && told.contains("A: a, B: c B takes "), "{told}");
    assert!(
        told.contains("all due to memory.texture.cl.") && told.contains("To measure the causes, keep the recording"),
        "{told}"
    );
    let worst = |n: usize| list[n]["worst"]["percent"].as_f64().expect("a number");
    assert!(worst(0) < worst(1));
    place.ok(&format!("compare a c b --fail-over {}", worst(1)));
    assert!(place.run(&format!("compare a c b --fail-over {}", worst(0))).error(1).contains("worse by"));
}

#[test]
fn damaged_or_foreign_recording_is_named() {
    let place = Place::new();
    place.ok(&format!("{QUICK} --out a"));
    place.ok(&format!("{QUICK} --set memory.texture.cl=90 --out b"));
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
