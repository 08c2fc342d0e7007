//! Outputs of machine `texel` besides its picture, and its table of methods.

use crate::support::{Place, picture};
use serde_json::Value;
use std::fs;

/// Reads the lines of a span dump.
fn spans(place: &Place, name: &str) -> Vec<Value> {
    place.text(name).lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{line}: {e}"))).collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|n| n.as_f64().expect("a number")).collect()
}

fn figure(report: &Value, name: &str) -> f64 {
    report["figures"][name].as_f64().unwrap_or_else(|| panic!("{name}: {}", report["figures"]))
}

/// Returns the number of spans that have a line in a dump.
fn textured_spans(report: &Value) -> f64 {
    figure(report, "spans") - figure(report, "spans_untextured")
}

/// Returns the largest displacement within a segment by the derived equation, from W at its ends and its length.
fn displacement(w: [f64; 2], length: f64) -> f64 {
    let slope = ((w[1] - w[0]) / length).abs();
    if slope == 0.0 { 0.0 } else { (w[1].sqrt() - w[0].sqrt()).powi(2) / slope }
}

#[test]
fn run_writes_only_its_pictures() {
    let place = Place::new();
    let said = place.ok("demo corridor --size 64x48").out;
    let kinds = ["difference", "displacement", "divisions", "image", "reference"];
    let names: Vec<String> =
        kinds.iter().map(|k| format!("{k}.png")).chain(["report.json", "run.recording"].map(str::to_owned)).collect();
    assert_eq!(place.names("out"), names);
    assert!(
        said.contains("image.png, reference.png, difference.png, displacement.png, divisions.png, report.json, run.recording"),
        "{said}"
    );
    let size = |name: &str| {
        let (width, height, _) = picture(&place.path(&format!("out/{name}.png")));
        (width, height)
    };
    assert_eq!((size("image"), size("divisions"), size("displacement")), ((64, 48), (64, 48), (64, 148)));
    place.ok("demo corridor --size 64x48 --no-exact --out bare");
    assert_eq!(place.names("bare"), ["image.png", "report.json", "run.recording"]);
}

#[test]
fn frames_and_their_spans_are_numbered() {
    let place = Place::new();
    place.ok("demo turntable --frames 3 --size 48x36 --dump spans s.jsonl");
    for kind in ["image", "displacement", "divisions"] {
        assert_ne!(place.bytes(&format!("out/{kind}-0001.png")), place.bytes(&format!("out/{kind}-0002.png")), "{kind}");
    }
    let lines = spans(&place, "s.jsonl");
    let later = lines.iter().position(|l| l["frame"] == 1).expect("a second frame");
    assert!(
        lines[..later].iter().all(|l| l.get("frame").is_none())
            && lines[later..].iter().all(|l| l["frame"] == 1 || l["frame"] == 2)
    );
    assert_eq!(lines.len() as f64, textured_spans(&place.report("out")));
}

/// Checks section 3 of the specification with the dump alone. Every segment of more than one pixel keeps the error bound. No
/// segment except the last of its span could be one pixel longer.
// Claim: images: By the dump of spans, every segment keeps the error bound, and only the last of a span could be one pixel longer.
#[test]
fn division_points_respect_error_bound() {
    let place = Place::new();
    for bound in [0.1, 0.5, 2.0] {
        place.ok(&format!("demo corridor --size 160x120 --set texel.error_bound={bound} --functional --dump spans s.jsonl"));
        let lines = spans(&place, "s.jsonl");
        assert_eq!(lines.len() as f64, textured_spans(&place.report("out")));
        let mut segments = 0;
        for line in &lines {
            let keys: Vec<&String> = line.as_object().expect("an object").keys().collect();
            assert_eq!(keys, ["divisions", "w", "x", "y"], "serde sorts them");
            let (x, w) = (numbers(&line["x"]), numbers(&line["w"]));
            let at = |column: f64| if x[1] > x[0] { w[0] + (w[1] - w[0]) * (column - x[0]) / (x[1] - x[0]) } else { w[0] };
            let points: Vec<f64> = [x[0]].into_iter().chain(numbers(&line["divisions"])).chain([x[1]]).collect();
            assert!(w.iter().all(|w| *w > 0.0) && x[0] >= 0.0 && x[1] < 160.0, "{line}");
            if x[1] - x[0] + 1.0 <= 2.0 {
                assert_eq!(points.len(), 2, "too short to be divided: {line}");
                continue;
            }
            for (i, pair) in points.windows(2).enumerate() {
                let length = pair[1] - pair[0];
                assert!(length >= 1.0, "{line}");
                let error = |end: f64| displacement([at(pair[0]), at(end)], end - pair[0]);
                assert!(length == 1.0 || error(pair[1]) <= bound + 1e-6, "{bound}: {line}");
                assert!(i + 2 == points.len() || error(pair[1] + 1.0) > bound - 1e-6, "{bound}: could be longer: {line}");
                segments += 1;
            }
        }
        assert!(segments > lines.len(), "{bound}: spans are divided");
        assert!(figure(&place.report("out"), "displacement_largest") <= bound);
    }
}

// Claim: images: A replayed trace has the same spans.
#[test]
fn replayed_list_has_same_spans() {
    let place = Place::new();
    place.ok("demo turntable --frames 1 --size 48x36 --dump spans a.jsonl --out a");
    place.ok("record demo:turntable --frames 1 --size 48x36 --out t.bdl");
    place.ok("run t.bdl --machine texel --dump spans b.jsonl --out b");
    assert_eq!(place.text("a.jsonl"), place.text("b.jsonl"));
    assert_eq!(place.bytes("a/displacement.png"), place.bytes("b/displacement.png"));
}

// Claim: images: At equal error the adaptive method needs fewer divisions than each fixed method. A table row is a run with its
// settings.
#[test]
fn all_methods_are_compared_at_the_same_error() {
    let place = Place::new();
    let said = place.ok("demo corridor --size 96x72 --compare-methods --json").out;
    assert_eq!(place.names("out"), ["methods.csv", "methods.json"]);
    assert_eq!(said, place.text("out/methods.json"));
    let table = place.json("out/methods.json");
    assert_eq!((&table["machine"], table["error_bound"].as_f64()), (&Value::from("texel"), Some(0.5)));
    let methods = table["methods"].as_array().expect("methods");
    assert_eq!(methods.len() + 1, place.text("out/methods.csv").lines().count());
    let of = |m: &Value, name: &str| m[name].as_f64().unwrap_or_else(|| panic!("{name}: {m}"));
    let [adaptive, others @ .., exact, reciprocal] = &methods[..] else { panic!("{table}") };
    let names = [adaptive, exact, reciprocal].map(|m| m["method"].as_str().expect("a name"));
    assert_eq!(names, ["adaptive", "exact", "exact by one reciprocal"]);
    // Set-up adds divisions to the one or two per pixel.
    let [two, one] = [exact, reciprocal].map(|m| of(m, "divisions_per_pixel"));
    assert!(two > 2.0 && (two - one - 1.0).abs() < 1e-5, "{two} {one}");
    for method in [exact, reciprocal] {
        assert!(of(method, "displacement_largest") < 0.01, "rounding of the datapath is left: {method}");
    }
    assert_eq!(others.len(), 3);
    for other in others {
        assert!(of(other, "displacement_largest") <= 0.5, "{other}");
        assert!(of(other, "divisions_per_pixel") > of(adaptive, "divisions_per_pixel"), "{other}");
        let (kind, number) =
            other["settings"].as_array().and_then(|s| s.split_last()).map(|(n, rest)| (rest, n)).expect("settings");
        let settings: Vec<String> =
            kind.iter().chain([number]).map(|s| format!("--set {}", s.as_str().expect("a setting"))).collect();
        place.ok(&format!("demo corridor --size 96x72 --out one {}", settings.join(" ")));
        let report = place.report("one");
        assert_eq!(Some(place.frame_cycles("one")), other["cycles"].as_u64(), "{other}");
        assert_eq!(figure(&report, "displacement_largest"), of(other, "displacement_largest"));
        assert_eq!(report["quality"]["psnr_db"].as_f64(), Some(of(other, "psnr_db")));
    }
}

#[test]
fn dump_may_lie_in_new_output_folder() {
    let place = Place::new();
    place.ok("demo corridor --size 16x12 --no-exact --dump spans out/spans.jsonl");
    assert_eq!(place.names("out"), ["image.png", "report.json", "run.recording", "spans.jsonl"]);
}

#[test]
fn unsupported_outputs_are_refused_without_files() {
    let place = Place::new();
    let wrong = place.run("demo coin --size 16x12 --dump spans s.jsonl");
    assert!(wrong.error(2).contains("machine `bump` has no spans, but machine `texel` has"), "{}", wrong.err);
    let wrong = place.run("demo corridor --size 16x12 --dump colours s.jsonl");
    assert!(wrong.error(2).contains("unknown output `colours`; expected spans"), "{}", wrong.err);
    let wrong = place.run("demo coin --size 16x12 --compare-methods");
    assert!(wrong.error(2).contains("machine `bump` has no methods to compare"), "{}", wrong.err);
    place.run("demo corridor --compare-methods --functional").error(2);
    place.run("demo corridor --dump spans").error(2);
    let twice = place.run("demo corridor --size 16x12 --dump spans s.jsonl --dump spans s.jsonl");
    assert!(twice.error(2).contains("s.jsonl is also the output of"), "{}", twice.err);
    let failed = place.run("run missing.obj --machine texel --out new --dump spans new/s.jsonl");
    failed.error(1);
    fs::write(place.path("cut.jsonl"), "{").expect("written");
    let failed = place.run("run cut.jsonl --machine texel --out new --dump spans new/s.jsonl");
    failed.error(1);
    fs::remove_file(place.path("cut.jsonl")).expect("there");
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
    let wrong = place.run("demo corridor --size 16x12 --dump spans missing/s.jsonl");
    assert!(wrong.error(1).contains("missing/s.jsonl: cannot be written"), "{}", wrong.err);
    let wrong = place.run("demo corridor --size 64x48 --max-cycles 100 --dump spans s.jsonl");
    wrong.error(1);
    assert!(place.names("").iter().all(|name| name == "out" || name == "s.jsonl"), "{:?}", place.names(""));
    fs::remove_dir_all(place.path("out")).expect("the state so far");
}
