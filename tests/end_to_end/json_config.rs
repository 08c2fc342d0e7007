//! Configurations in JSON, and reports as configurations.

use crate::support::Place;
use serde_json::{Value, json};
use std::fs;

/// Draws a small picture and returns the configuration in the report.
fn drawn(place: &Place, options: &str) -> Value {
    place.ok(&format!("run PATCH --size 16x12 --no-exact --no-bottlenecks --quiet {options}"));
    place.report("out")["config"].clone()
}

#[test]
fn config_of_a_report_gives_the_same_machine() {
    let place = Place::new();
    for (machine, setting) in [
        ("bump", "--set memory.graphics.part=sdr-133 --set replacement.lanes=3"),
        ("shade", "--set shade.mode=normal"),
        ("texel", "--set clock.hz=123456789"),
        ("defer", "--set defer.mode=progressive"),
    ] {
        for setting in ["", setting] {
            let config = drawn(&place, &format!("--machine {machine} {setting}"));
            fs::rename(place.path("out/report.json"), place.path("report.json")).expect("moved");
            fs::write(place.path("c.json"), config.to_string()).expect("written");
            for file in ["report.json", "c.json"] {
                let line = format!("--machine {machine} --config {file}");
                assert_eq!(drawn(&place, &line), config, "{line}: {setting}");
            }
        }
    }
}

#[test]
fn report_of_other_machine_is_an_error() {
    let place = Place::new();
    drawn(&place, "--machine shade");
    let words = "out/report.json: is a report of machine `shade`, and this is `bump`; ";
    for line in ["describe bump --config out/report.json", "run PATCH --out b --config out/report.json"] {
        let outcome = place.run(line);
        assert!(outcome.error(1).contains(&format!("{words}use --machine shade")), "{line}: {}", outcome.err);
    }
    let plan = "machine = 'bump'\ninput = 'demo:golf-ball'\nobjectives = ['cycles min']\nconfig = 'out/report.json'\n";
    fs::write(place.path("plan.toml"), plan).expect("written");
    let outcome = place.run("sweep plan.toml --out sweep");
    let cure = "set machine = \"shade\" in the plan";
    assert!(outcome.error(1).contains(&format!("line 4: config: {words}{cure}")), "{}", outcome.err);
}

#[test]
fn errors_in_json_name_line_and_field() {
    let place = Place::new();
    for (text, words) in [
        ("{\"replacement\": {\n\"lane\": 3}}", "line 2: unknown parameter `replacement.lane`; did you mean `replacement.lanes`"),
        ("{\"replacement\": {\n\"lanes\": 0}}", "line 2: `replacement.lanes` is 0, expected 1..="),
        ("{\"replacement\": {\n\"lanes\": null}}", "line 2: `replacement.lanes`: null stands here"),
        ("{\"replacement\": {\n\"lanes\" 3}}", "not valid JSON: line 2, column 9"),
        ("{\"machine\": \"bump\", \"config\": {\n\"clock\": {\n\"hz\": 0}}}", "line 3: `clock.hz` is 0"),
    ] {
        fs::write(place.path("c.json"), text).expect("written");
        let outcome = place.run("describe bump --config c.json");
        assert!(outcome.error(1).contains(&format!("c.json: {words}")), "{text}: {}", outcome.err);
        let plan = "input = 'demo:golf-ball'\nobjectives = ['cycles min']\nconfig = 'c.json'\n";
        fs::write(place.path("plan.toml"), plan).expect("written");
        let outcome = place.run("sweep plan.toml --out sweep");
        assert!(outcome.error(1).contains(&format!("line 3: config: c.json: {words}")), "{text}: {}", outcome.err);
    }
}

#[test]
fn recording_of_json_config_is_resimulated() {
    let place = Place::new();
    fs::write(place.path("c.json"), json!({ "replacement": { "lanes": 3 } }).to_string()).expect("written");
    place.ok("run PATCH --size 16x12 --no-exact --recording r.recording --config c.json --quiet");
    let [cycles, config] = ["cycles", "config"].map(|key| place.report("out")[key].clone());
    place.ok("resimulate r.recording --out again --quiet");
    assert_eq!([&place.report("again")["cycles"], &place.report("again")["config"]], [&cycles, &config]);
    assert_eq!(config["replacement"]["lanes"], 3);
}
