//! `--sensitivity`: changes every assumption of a machine, one at a time.

use crate::support::{Place, finish, without_host};
use serde_json::Value;
use std::fs::{self, File};

/// Returns the rows of the analysis in a report.
fn changes(report: &Value) -> &Vec<Value> {
    report["sensitivity"]["changes"].as_array().expect("changes")
}

#[test]
fn sensitivity_rows_equal_separate_runs() {
    let place = Place::new();
    let line = "run demo:ellipsoid@1 --size 24x18 --set cpu.divide=30 --frames 2 --no-bottlenecks";
    let said = place.ok(&format!("{line} --sensitivity --html page.html")).out;
    assert!(
        said.contains("one assumed parameter or coefficient of the area changed at a time") && said.contains("bytes %  area %"),
        "{said}"
    );
    assert!(place.text("page.html").contains("Sensitivity to assumed parameters"));
    let mut report = without_host(place.report("out"));
    let first = changes(&report)[0].clone();
    let depths: Vec<&Value> = changes(&report).iter().filter(|c| c["parameter"] == "fifo.pixels.depth").collect();
    assert_eq!(depths.len(), 2);
    for change in [&first, depths[0], depths[1]] {
        let value = change["to"].as_str().map_or_else(|| change["to"].to_string(), str::to_owned);
        place.ok(&format!("{line} --set {}={value} --out alone --quiet", change["parameter"].as_str().unwrap()));
        assert_eq!(place.frame_cycles("alone"), change["cycles"].as_u64().unwrap(), "{change}");
        assert_eq!(place.report("alone")["quality"]["psnr_db"], change["psnr_db"], "{change}");
    }
    place.ok(&format!("{line} --out plain --quiet"));
    report.as_object_mut().unwrap().remove("sensitivity");
    assert_eq!(report, without_host(place.report("plain")));
}

#[test]
fn trace_is_read_for_each_run_of_any_engine() {
    let place = Place::new();
    place.ok("record demo:ellipsoid@1 --size 16x12 --out list.dl.jsonl");
    let report = |engine: &str| {
        let said = place.ok(&format!("run list.dl.jsonl --machine shade --sensitivity --no-exact --json --engine {engine}")).out;
        without_host(serde_json::from_str(&said).unwrap())
    };
    let [timed, ticked] = ["timed", "ticked"].map(report);
    assert_eq!(timed["sensitivity"], ticked["sensitivity"]);
    assert!(changes(&timed).len() > 200 && changes(&timed)[0].get("psnr_db").is_none());
    let list = File::open(place.path("list.dl.jsonl")).unwrap();
    let outcome = finish(place.command("run - --machine shade --sensitivity --out piped").stdin(list));
    assert!(outcome.error(2).contains("can be read only once"), "{}", outcome.err);
    assert!(!place.path("piped").exists());
}

#[test]
fn sensitivity_conflicts_are_usage_errors() {
    let place = Place::new();
    for other in ["--functional", "--ablate", "--compare-methods"] {
        place.run(&format!("demo ellipsoid@1 --size 16x12 --sensitivity {other}")).error(2);
    }
    place.run("run --from http://127.0.0.1:9/ --sensitivity").error(2);
    let outcome = place.run("demo ellipsoid@1 --size 16x12 --sensitivity --max-cycles 100");
    assert!(outcome.error(1).contains("stopped at --max-cycles"), "{}", outcome.err);
    assert!(place.report("out").get("sensitivity").is_none());
    fs::remove_dir_all(place.path("out")).unwrap();
}
