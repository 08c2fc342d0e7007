//! Outputs of a run: the report on disk and on standard output, tables, the time line, and comparisons.

use crate::support::{Place, is_valid, picture, without_host};
use basrelief_report::number::thousands;
use serde_json::Value;

const SMALL: &str = "demo mixed --size 64x48";

#[test]
fn demo_writes_image_reference_difference_and_report() {
    let place = Place::new();
    let said = place.ok(SMALL).out;
    assert_eq!(place.names("out"), ["difference.png", "image.png", "reference.png", "report.json", "run.recording"]);
    let report = place.report("out");
    is_valid(&report, &place);
    let (width, height, hash) = picture(&place.path("out/image.png"));
    assert_eq!((width, height), (64, 48));
    assert_eq!(report["image"][0]["sha256"], hash.as_str());
    assert_eq!(report["image"][0]["file"], "image.png");
    assert!(said.contains("Bottleneck: ") && said.contains("Written to out/"), "{said}");
    let cycles = &report["cycles"];
    let frames: u64 = cycles["frames"].as_array().expect("frames").iter().filter_map(Value::as_u64).sum();
    assert_eq!(cycles["total"].as_u64(), Some(frames + cycles["write_tail"].as_u64().expect("write_tail")));
}

#[test]
fn both_engines_give_identical_reports() {
    let place = Place::new();
    for out in ["timed", "again", "ticked"] {
        let engine = if out == "ticked" { "ticked" } else { "timed" };
        place.ok(&format!("{SMALL} --engine {engine} --out {out}"));
    }
    let [timed, again, ticked] = ["timed", "again", "ticked"].map(|out| without_host(place.report(out)));
    assert_eq!(timed.to_string(), again.to_string());
    assert_eq!(timed.to_string(), ticked.to_string());
}

#[test]
fn functional_mode_gives_same_image_without_cycles() {
    let place = Place::new();
    place.ok(&format!("{SMALL} --out timed"));
    place.ok(&format!("{SMALL} --out functional --functional"));
    let [timed, functional] = ["timed", "functional"].map(|out| place.report(out));
    assert_eq!(timed["image"], functional["image"]);
    assert_eq!(timed["input"], functional["input"]);
    assert!(functional["cycles"].is_null());
    is_valid(&functional, &place);
}

#[test]
fn json_prints_the_report_and_nothing_else() {
    let place = Place::new();
    let outcome = place.ok(&format!("{SMALL} --json"));
    assert_eq!(outcome.out, place.text("out/report.json"));
    assert_eq!(outcome.err, "");
}

#[test]
fn quiet_prints_nothing_but_errors() {
    let place = Place::new();
    let outcome = place.ok(&format!("{SMALL} --quiet"));
    assert_eq!((outcome.out, outcome.err), (String::new(), String::new()));
    place.run("demo teapot --quiet").error(2);
}

#[test]
fn csv_and_time_line_are_written_on_request() {
    let place = Place::new();
    let said = place.ok(&format!("{SMALL} --csv --timeline run.pftrace --waves run.fst --html run.html")).out;
    let (_, written) = said.split_once("\nWritten to out/: ").expect("a list of files");
    let expected = "image.png, reference.png, difference.png, report.json, report.csv, run.recording\nrun.pftrace (--timeline)\n\
                    run.fst (--waves)\nrun.html (--html)\n";
    assert_eq!(written, expected);
    let csv = place.text("out/report.csv");
    let columns = csv.lines().next().expect("a header").split(',').count();
    assert!(columns > 1 && csv.lines().count() > 50, "{csv}");
    assert_eq!(place.names(""), ["out", "run.fst", "run.html", "run.pftrace"]);
    assert!(packets(&place.bytes("run.pftrace")) > 100);
    assert!(place.bytes("run.fst").len() > 1000);
}

// A unit is stated once per figure, and the table of units says that tokens hold several fragments.
#[test]
fn tables_state_units_once_and_fragments_beside_tokens() {
    let place = Place::new();
    let said = place.ok(&format!("{SMALL} --tables units,figures")).out;
    let fragments = thousands(place.report("out")["figures"]["fragments"].as_u64().expect("a count"));
    let base = format!("; a token holds several fragments or is control: {fragments} fragments in all\n");
    assert!(said.contains(&base), "{said}");
    let row = said.lines().find(|line| line.starts_with("vertex_cache_hits ")).expect("a figure");
    assert_eq!(row.matches("vertices").count(), 1, "{row}");
}

#[test]
fn time_line_of_few_cycles_and_units_is_small() {
    let place = Place::new();
    place.ok(&format!("{SMALL} --timeline all.pftrace --waves all.fst"));
    place.ok(&format!("{SMALL} --timeline few.pftrace --waves few.fst --from-cycle 2000 --to-cycle 3000 --units replacement"));
    for kind in ["pftrace", "fst"] {
        let [all, few] = ["all", "few"].map(|name| place.bytes(&format!("{name}.{kind}")).len());
        assert!(few < all / 4, "{kind}: {few} of {all} bytes");
    }
}

#[test]
fn time_line_after_the_end_of_the_run_is_warned_of() {
    let place = Place::new();
    let warning = "warning: timelines, waveforms and token files are empty: they start at cycle 100,000,000, but the run has ";
    for (first, is_empty) in [("100000000", true), ("0", false)] {
        let said = place.ok(&format!("{SMALL} --timeline late.pftrace --from-cycle {first}")).out;
        assert_eq!(said.contains(warning), is_empty, "{said}");
        assert_eq!(place.report("out")["warnings"].to_string().contains("token files are empty"), is_empty);
    }
}

#[test]
fn underruns_of_the_display_are_warned_of() {
    let place = Place::new();
    for (bytes, is_late) in [(64, true), (2048, false)] {
        place.ok(&format!("demo cut-plane --size 64x48 --no-exact --no-bottlenecks --set display.burst_bytes={bytes} --out out"));
        let report = place.report("out");
        assert_eq!(report["display"]["underruns"].as_u64() > Some(0), is_late, "{bytes}");
        assert_eq!(report["warnings"].to_string().contains("(underruns)"), is_late, "{}", report["warnings"]);
    }
}

#[test]
fn waves_over_memory_limit_leave_no_file() {
    let place = Place::new();
    let error = place.run("demo ellipsoid@1 --size 64x48 --waves w.fst --memory-limit 20KiB");
    assert!(error.error(1).contains("w.fst: needs"), "{}", error.err);
    for part in ["for waves", "over the limit of 20 KiB", "--memory-limit", "--from-cycle", "--units"] {
        assert!(error.err.contains(part), "{}", error.err);
    }
    assert!(!place.path("w.fst").exists());
}

#[test]
fn token_file_is_equal_for_both_engines() {
    let place = Place::new();
    let run = "demo mixed --size 64x48 --frames 1 --no-exact --no-bottlenecks --tokens-every 1 --out out --tokens";
    place.ok(&format!("{run} t.kanata"));
    place.ok(&format!("{run} u.kanata.zst --engine ticked"));
    let text = place.text("t.kanata");
    assert_eq!(zstd::decode_all(&*place.bytes("u.kanata.zst")).unwrap(), text.as_bytes());
    let count =
        |pattern: &str, end: &str| text.lines().filter(|line| line.starts_with(pattern) && line.ends_with(end)).count() as u64;
    let (begun, retired, flushed) = (count("I\t", ""), count("R\t", "\t0"), count("R\t", "\t1"));
    let fifos = &place.report("out")["fifos"];
    // Frames, objects and polygons pass through the same FIFOs as tokens of their own, which this trace does not list.
    let tokens = |fifo: &str| fifos[fifo]["tokens"].as_u64().unwrap();
    let (drawn, passed) = (tokens("fragments"), tokens("tested_fragments"));
    assert!(begun > 1000 && begun < drawn, "{begun} of {drawn}");
    assert_eq!(flushed, drawn - passed, "what the depth test removes is flushed");
    assert_eq!(begun, retired + flushed);
    place.ok(&format!("{run} p.kanata --tokens-of polygons"));
    let polygons = place.text("p.kanata");
    assert!(polygons.lines().filter(|line| line.starts_with("R\t")).all(|line| line.ends_with("\t0")), "all are drawn");
    assert!(place.run("demo coin --tokens-every 3").error(2).contains("--tokens"));
}

/// Counts the packets of a Perfetto trace, which are the occurrences of field 1 of the outermost message.
fn packets(mut bytes: &[u8]) -> usize {
    let mut count = 0;
    while let Some((&tag, rest)) = bytes.split_first() {
        assert_eq!(tag, 0x0a, "packet {count} is no length-delimited field 1");
        let end = rest.iter().position(|b| b & 0x80 == 0).expect("a length");
        let length = rest[..=end].iter().rev().fold(0, |n, b| n << 7 | usize::from(b & 0x7f));
        bytes = &rest[end + 1 + length..];
        count += 1;
    }
    count
}

#[test]
fn cycle_limit_reports_state_and_fails() {
    let place = Place::new();
    let outcome = place.run(&format!("{SMALL} --max-cycles 1000"));
    assert!(outcome.error(1).contains("--max-cycles"), "{}", outcome.err);
    let report = place.report("out");
    is_valid(&report, &place);
    assert!(report["cycles"]["total"].as_u64().is_some_and(|total| (1..=2000).contains(&total)), "{}", report["cycles"]);
    assert_eq!(place.names("out"), ["report.json"]);
}

#[test]
fn named_table_without_rows_is_a_note() {
    let place = Place::new();
    let notes = |options: &str| place.ok(&format!("run PATCH --size 16x12 --no-exact {options}")).err;
    let err = notes("--functional --tables bottlenecks,units,fifos");
    for table in ["bottlenecks", "fifos"] {
        let note = format!("note: this run has no table `{table}`; omit --functional to have it\n");
        assert_eq!(err.matches(&note).count(), 1, "{table}: {err}");
    }
    let err = notes("--no-bottlenecks --tables costs,bottlenecks");
    assert!(
        err.contains("note: this run has no table `bottlenecks`; --bottlenecks makes it, unless a warning says why not\n"),
        "{err}"
    );
    assert!(err.contains("note: this run has no table `costs`; a run with --costs has it\n"), "{err}");
    assert!(!notes("--no-bottlenecks --tables all").contains("note:"));
}
