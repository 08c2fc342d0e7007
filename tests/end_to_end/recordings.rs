//! `--recording`, `resimulate`, `size-fifos` and the bottlenecks of a run.

use crate::support::{Place, without_host};
use std::fs;
use std::io::Write;
use std::process::Stdio;

const RUN: &str = "demo corridor --size 48x36 --no-exact --quiet";

#[test]
fn resimulation_equals_run_with_any_engine() {
    let place = Place::new();
    place.ok(&format!("{RUN} --recording timed.recording --out a"));
    place.ok(&format!("{RUN} --recording ticked.recording --engine ticked --out b"));
    let report = |folder: &str| without_host(place.report(folder));
    assert_eq!(report("a"), report("b"), "limits and all");
    let again = |recording: &str, set: &str| {
        place.ok(&format!("resimulate {recording} {set} --out again --quiet"));
        report("again")
    };
    assert_eq!(again("timed.recording", ""), report("a"));
    let set = "--set fifo.pixels.depth=3 --set memory.texture.part=sdr-100 --set cache.texture.ways=1 --set ideal.units=divider";
    place.ok(&format!("{RUN} {set} --out other"));
    assert_ne!(report("other"), report("a"));
    for recording in ["timed.recording", "ticked.recording"] {
        assert_eq!(again(recording, set), report("other"), "{recording}");
    }
    let printed = place.ok(&format!("resimulate timed.recording {set} --json")).out;
    assert_eq!(without_host(serde_json::from_str(&printed).expect("a report")), report("other"));
}

#[test]
fn limits_hold_as_full_runs_and_can_be_left_out() {
    let place = Place::new();
    let text = place.ok("demo corridor --size 48x36 --no-exact").out;
    assert!(text.contains("Bottleneck: `"), "{text}");
    let report = place.report("out");
    let first = &report["bottlenecks"]["single"][0];
    let set: Vec<String> =
        first["set"].as_array().expect("options").iter().map(|s| format!("--set {}", s.as_str().unwrap())).collect();
    place.ok(&format!("{RUN} --no-bottlenecks {} --out ideal", set.join(" ")));
    assert_eq!(place.frame_cycles("ideal"), first["cycles"].as_u64().expect("cycles"));
    assert!(place.report("ideal").get("bottlenecks").is_none());
}

#[test]
fn run_writes_recording_beside_report() {
    let place = Place::new();
    let has_recording = |folder: &str| place.names(folder).contains(&"run.recording".to_owned());
    place.ok(&format!("{RUN} --out a"));
    assert!(has_recording("a"));
    for without in ["--no-bottlenecks", "--functional", "--max-cycles 500"] {
        place.ok(&format!("{RUN} --out b"));
        assert!(has_recording("b"));
        place.run(&format!("{RUN} --out b {without}"));
        assert!(place.names("b").contains(&"report.json".to_owned()) && !has_recording("b"), "{without}: none of an earlier run");
    }
    place.ok("resimulate a --set fifo.pixels.depth=3 --out b --quiet");
    place.ok(&format!("{RUN} --set fifo.pixels.depth=3 --out c"));
    assert_eq!(without_host(place.report("b")), without_host(place.report("c")), "a folder is its recording");
    place.ok("resimulate b --set fifo.pixels.latency=7 --out d --quiet");
    place.ok("resimulate c --set fifo.pixels.latency=7 --out e --quiet");
    assert_eq!(without_host(place.report("d")), without_host(place.report("e")), "resimulate writes the recording of that run");
    place.ok("resimulate a --no-bottlenecks --out d --quiet");
    assert!(!has_recording("d"));
    place.ok("size-fifos a --within 1");
    assert!(place.run("size-fifos d").error(1).starts_with("d/run.recording: cannot be read"));
    let damaged = place.run("size-fifos a b/report.json");
    assert!(damaged.error(1).starts_with("b/report.json: not a recording, or damaged"), "only the damaged input is named");
    assert!(place.run("resimulate a --out a").error(2).contains("is an input (RECORDING)"));
    place.ok(&format!("{RUN} --no-bottlenecks --recording d/run.recording --out d"));
    place.ok("resimulate d");
}

#[test]
fn resimulation_time_excludes_bottleneck_analysis() {
    let place = Place::new();
    place.ok(&format!("{RUN} --out a"));
    place.ok("resimulate a --bottlenecks --out b --quiet");
    let host = place.report("b")["host"].clone();
    let [simulated, all] = ["simulate_s", "wall_s"].map(|key| host[key].as_f64().expect("seconds"));
    assert!(simulated > 0.0 && 2.0 * simulated < all, "the analysis resimulates many times: {host}");
}

#[test]
fn resimulation_lists_its_files() {
    let place = Place::new();
    place.ok(&format!("{RUN} --out a"));
    let written = |options: &str| {
        let said = place.ok(&format!("resimulate a {options}")).out;
        said.split_once("\nWritten to ").map(|(_, files)| files.to_owned())
    };
    assert_eq!(written(""), None);
    assert_eq!(written("--html a.html").as_deref(), Some("a.html (--html)\n"));
    assert_eq!(written("--out b --csv").as_deref(), Some("b/: report.json, report.csv, run.recording\n"));
    assert_eq!(place.names("b"), ["report.csv", "report.json", "run.recording"]);
    let both = "--out c --no-bottlenecks --html c.html";
    assert_eq!(written(both).as_deref(), Some("c/: report.json\nc.html (--html)\n"));
    assert_eq!(place.names("c"), ["report.json"]);
}

#[test]
fn sized_fifos_keep_requested_cycles() {
    let place = Place::new();
    place.ok(&format!("{RUN} --recording a.recording"));
    let cycles = place.frame_cycles("out");
    let text = place.ok("size-fifos a.recording --within 0,1").out;
    assert!(place.ok("size-fifos a.recording").out.contains("within 0.1 %: "), "the default tolerance");
    let sets = text.lines().find_map(|line| line.strip_prefix("within 1 %: ")).expect("a choice");
    place.ok(&format!("{RUN} --no-bottlenecks {sets} --out small"));
    assert!(place.frame_cycles("small") as f64 <= cycles as f64 * 1.01, "{text}");
    let sizes: serde_json::Value = serde_json::from_str(&place.ok("size-fifos a.recording --within 1 --json").out).expect("JSON");
    let slots = |n: usize| sizes["choices"][n]["slots"].as_u64().expect("slots");
    assert!(slots(1) * 10 < slots(0) * 6, "at least 40 % fewer: {sizes}");
    assert_eq!(sizes["choices"][1]["cycles"][0].as_u64(), Some(place.frame_cycles("small")), "as a full run has it");
}

#[test]
fn models_and_demos_are_sized_without_recording() {
    let place = Place::new();
    place.ok(&format!("{RUN} --recording a.recording"));
    let of_recording = place.ok("size-fifos a.recording --within 1 --json").out;
    assert_eq!(place.ok("size-fifos demo:corridor --size 48x36 --within 1 --json").out, of_recording);
    assert!(place.run("size-fifos a.recording --size 8x8").error(2).contains("a recording has its own machine and view"));
    place.ok(&format!("{RUN} --set fifo.pixels.depth=3 --recording b.recording"));
    let error = place.run("size-fifos a.recording b.recording").error(1).to_owned();
    assert!(error.starts_with("b.recording: `fifo.pixels.depth` is 3, expected ") && !error.contains("--set"), "{error}");
}

#[test]
fn run_of_a_user_who_acts_at_times_is_not_recorded() {
    let place = Place::new();
    fs::write(place.path("views.toml"), "[[views]]\nat_ms = 0\n[[views]]\nat_ms = 5\norbit = 30\n").expect("a file");
    let run = "demo gallery --size 32x24 --views views.toml --set defer.mode=progressive --no-exact --quiet";
    let refused = place.run(&format!("{run} --recording a.recording"));
    assert!(refused.error(2).starts_with("--recording: the user of this run acts at times"), "{}", refused.err);
    assert!(!place.path("a.recording").exists());
    place.ok(run);
    assert!(!place.path("out/run.recording").exists());
}

#[test]
fn bad_recordings_and_parameters_are_named() {
    let place = Place::new();
    place.ok(&format!("{RUN} --recording a.recording"));
    let recording = place.bytes("a.recording");
    fs::write(place.path("half.recording"), &recording[..recording.len() / 2]).expect("a file");
    fs::write(place.path("no.recording"), "no recording").expect("a file");
    for name in ["half.recording", "no.recording"] {
        for command in ["resimulate", "size-fifos"] {
            let error = place.run(&format!("{command} {name}"));
            assert!(error.error(1).starts_with(&format!("{name}: not a recording")), "{}", error.err);
        }
    }
    // The checksum of the compression stands at the end of both files.
    for name in ["a.recording", "out/run.recording"] {
        let whole = place.bytes(name);
        let (body, checksum) = whole.split_at(whole.len() - 4);
        let zeros = [body, &[0; 4]].concat();
        for (damage, bytes) in [("zeros", &zeros[..]), ("missing", body), ("twice", &[&whole[..], checksum].concat())] {
            fs::write(place.path("bad.recording"), bytes).expect("a file");
            let error = place.run("resimulate bad.recording");
            assert!(error.error(1).starts_with("bad.recording: not a recording"), "{name}, {damage}: {}", error.err);
        }
    }
    let error = |line: &str| place.run(&format!("resimulate a.recording {line}"));
    assert!(error("--set operators.divide.latency=9").error(2).contains("changes the work of the units"));
    assert!(error("--set fifo.pixels.depht=9").error(2).contains("did you mean `fifo.pixels.depth`"));
    assert!(place.run("resimulate gone.recording").error(1).starts_with("gone.recording: cannot be read"));
    // A run that is cut short writes no recording, and removes an older one of that name.
    place.run(&format!("{RUN} --max-cycles 500 --recording cut.recording")).error(1);
    assert!(!place.path("cut.recording").exists());
    assert!(place.run(&format!("{RUN} --recording out/report.json")).error(2).contains("report.json"));
}

#[cfg(unix)]
#[test]
fn config_from_pipe_is_read_once_and_recorded() {
    let place = Place::new();
    let mut run = place.command(&format!("{RUN} --config /dev/stdin --recording a.recording --out a"));
    let mut run = run.stdin(Stdio::piped()).spawn().expect("a run");
    run.stdin.take().expect("a pipe").write_all(b"[fifo.pixels]\ndepth = 3\n").expect("a reader");
    assert!(run.wait().expect("an end").success());
    place.ok("resimulate a.recording --out again --quiet");
    assert_eq!(without_host(place.report("again")), without_host(place.report("a")));
}

#[test]
fn incomplete_run_names_no_recording_of_an_earlier_run() {
    let place = Place::new();
    let run = "run PATCH --size 16x12 --no-exact --recording kept.recording";
    assert!(place.ok(run).out.contains("kept.recording (--recording)"));
    let cut = place.run(&format!("{run} --max-cycles 100"));
    assert!(!cut.out.contains("kept.recording"), "{}", cut.out);
    assert!(cut.error(1).contains("\nkept.recording (--recording) is not written, because "), "{}", cut.err);
}
