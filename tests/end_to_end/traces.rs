//! Recording, replaying, converting, verifying.

use crate::support::{Place, sha256, workspace};
use basrelief_report::number::thousands;
use std::fs;

const FORMS: [&str; 4] = ["t.jsonl", "t.jsonl.zst", "t.bdl", "t.bdl.zst"];

#[test]
fn replay_gives_same_image_in_every_form() {
    let place = Place::new();
    place.ok("run PATCH --size 64x48 --frames 2 --orbit 30 --out scene");
    let scene = place.report("scene");
    for form in FORMS {
        place.ok(&format!("record PATCH --size 64x48 --frames 2 --orbit 30 --out {form}"));
        place.ok(&format!("run {form} --out replay"));
        let replay = place.report("replay");
        assert_eq!(replay["image"], scene["image"], "{form}");
        assert_eq!(replay["input"]["sha256"], scene["input"]["sha256"], "{form}");
        assert_eq!(replay["input"]["kind"], "trace");
        assert_eq!(replay["camera"], scene["camera"], "{form}");
    }
    for form in FORMS {
        place.ok_from(form, "run - --out stdin --quiet");
        assert_eq!(place.report("stdin")["image"], scene["image"], "{form} on standard input");
    }
}

#[test]
fn conversion_there_and_back_is_identical() {
    let place = Place::new();
    let said = place.ok("record PATCH --size 48x36 --out t.jsonl").out;
    let canonical = place.bytes("t.jsonl");
    let lines = canonical.iter().filter(|byte| **byte == b'\n').count();
    let expected = format!("Written to t.jsonl: {} commands of 1 frame, {} bytes", lines - 1, thousands(canonical.len() as u64));
    assert_eq!(said.trim_end(), expected);
    assert_eq!(place.ok("record PATCH --size 48x36 --out -").out.as_bytes(), canonical);
    for form in &FORMS[1..] {
        place.ok(&format!("convert t.jsonl {form}"));
        place.ok(&format!("convert {form} back.jsonl"));
        assert_eq!(place.bytes("back.jsonl"), canonical, "{form}");
        assert_eq!(place.ok_from(form, "convert - -").out.as_bytes(), canonical, "{form}");
    }
    let error = place.run("convert t.jsonl t.txt");
    assert!(error.error(2).contains(".jsonl or .bdl"), "{}", error.err);
}

#[test]
fn polygon_that_is_not_convex_is_a_warning() {
    let place = Place::new();
    let quad = fs::read_to_string(workspace().join("crates/sim/src/quad.dl.jsonl")).expect("read");
    let square = "[[1,1,0.5,1],[1,7,0.5,1],[7,7,0.5,1],[7,1,0.5,1]]";
    let polygon = quad.lines().nth(4).expect("the polygon");
    let dent = polygon.replace(square, "[[1,1,0.5,1],[4,3,0.5,1],[7,1,0.5,1],[4,7,0.5,1]]");
    let bow = polygon.replace(square, "[[1,1,0.5,1],[7,7,0.5,1],[1,7,0.5,1],[7,1,0.5,1]]");
    let both = quad.replace(polygon, &format!("{polygon}\n{dent}\n{bow}")).replace("\"commands\":6", "\"commands\":8");
    for (text, line, others) in [(quad.replace(polygon, &dent), 5, ""), (both, 6, ", as well as 1 later polygon")] {
        fs::write(place.path("t.jsonl"), text).expect("written");
        let run = place.ok("run t.jsonl --out out");
        let warning = format!(
            "line {line}: polygon.position: the polygon is not convex or crosses itself, so image and reference image can be wrong; \
             cut it into triangles{others}"
        );
        assert!(place.report("out")["warnings"].as_array().expect("a list").contains(&warning.clone().into()), "{warning}");
        let terminal = format!("{}{}", run.out, run.err).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(terminal.contains(&warning), "{terminal}");
    }
    fs::write(place.path("t.jsonl"), quad).expect("written");
    place.ok("run t.jsonl --out out");
    assert!(!place.text("out/report.json").contains("not convex"));
}

#[cfg(unix)]
#[test]
fn named_pipe_is_read_once() {
    let place = Place::new();
    place.ok("record PATCH --size 48x36 --out t.bdl");
    place.ok("run t.bdl --out file");
    let pipe = place.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let bytes = place.bytes("t.bdl");
    let writer = std::thread::spawn(move || fs::write(pipe, bytes));
    place.ok("run pipe --out piped");
    writer.join().expect("no panic").expect("all was read");
    assert_eq!(place.report("piped")["image"], place.report("file")["image"]);
}

#[test]
fn trace_verifies_with_recorded_settings() {
    let place = Place::new();
    fs::write(place.path("c.toml"), "[replacement]\nentries = [64, 32]\n").expect("written");
    place.ok("record PATCH --size 48x36 --config c.toml --set brightness.levels=1 --expect --out t.jsonl");
    let trace = place.text("t.jsonl");
    assert!(trace.contains(r#""brightness.levels":1"#) && trace.contains(r#""replacement.entries":[64,32]"#));
    let said = place.ok("verify t.jsonl").out;
    assert!(said.contains("ok") && said.contains("t.jsonl"), "{said}");
    place.ok("convert t.jsonl sub.bdl.zst");
    place.ok("verify . --engine ticked");
}

#[test]
fn expectation_of_nothing_fails_and_is_blessed() {
    let place = Place::new();
    place.ok("record PATCH --size 48x36 --expect --out t.jsonl");
    let good = place.text("t.jsonl");
    let line = good.lines().count() - 1;
    for nothing in [r#"{"expect":{}}"#, r#"{"expect":{"machine":"bump","frames":[],"memories":{"normal_map":{}},"images":[]}}"#] {
        let is_expect = |text: &str| text.starts_with(r#"{"expect"#);
        let lines = good.lines().map(|text| if is_expect(text) { nothing } else { text });
        fs::write(place.path("t.jsonl"), lines.map(|text| format!("{text}\n")).collect::<String>()).expect("written");
        let outcome = place.run("verify t.jsonl");
        outcome.error(1);
        let told = format!("line {line}: expects nothing; `basrelief verify --bless` adds");
        assert!(format!("{}{}", outcome.out, outcome.err).contains(&told), "{}{}", outcome.out, outcome.err);
        place.ok("verify --bless t.jsonl");
        assert_eq!(place.text("t.jsonl"), good);
    }
}

#[test]
fn wrong_parameter_of_an_expectation_is_named() {
    let place = Place::new();
    place.ok("record PATCH --size 48x36 --set brightness.levels=4 --set replacement.codebook=fixed --expect --out t.jsonl");
    let good = place.text("t.jsonl");
    let line = good.lines().count() - 1;
    let says = |replaced: &str, by: &str, expected: &str| {
        assert!(good.contains(replaced), "the trace has no {replaced}: {}", good.lines().nth(line - 1).unwrap_or_default());
        fs::write(place.path("t.jsonl"), good.replace(replaced, by)).expect("written");
        for command in ["verify t.jsonl", "verify --bless t.jsonl"] {
            let outcome = place.run(command);
            let message = outcome.error(1);
            assert!(message.starts_with(&format!("t.jsonl: line {line}: expect.{expected}")), "{message}");
        }
    };
    says("brightness.levels", "brightness.level", "config: unknown parameter `brightness.level`; did you mean");
    says(r#""brightness.levels":4"#, r#""brightness.levels":-1"#, "config: `brightness.levels` is -1, expected ");
    says(r#""fixed""#, r#""fixd""#, "config: `replacement.codebook`: unknown value `fixd`, expected one of `fixed`");
}

#[test]
fn bless_repairs_tampered_expectation() {
    let place = Place::new();
    place.ok("record PATCH --size 48x36 --expect --out t.jsonl");
    let good = place.text("t.jsonl");
    let cycles = good.split_once(r#""cycles":"#).expect("cycles").1.split(',').next().expect("a number");
    fs::write(place.path("t.jsonl"), good.replace(&format!(r#""cycles":{cycles}"#), r#""cycles":7"#)).expect("written");
    let outcome = place.run("verify t.jsonl");
    assert!(outcome.error(1).contains("1 of 1 traces"), "{}", outcome.err);
    assert!(outcome.out.contains(&format!("timed: cycles {cycles}, expected 7")), "{}", outcome.out);
    place.ok("verify --bless t.jsonl");
    assert_eq!(place.text("t.jsonl"), good);
    // Another coefficient gives another picture.
    fs::write(place.path("t.jsonl"), good.replacen(r#""ks":0.4"#, r#""ks":0.9"#, 1)).expect("written");
    assert!(place.run("verify t.jsonl").out.contains("images: number 0"));
}

#[test]
fn thousands_of_expectations_are_refused() {
    let place = Place::new();
    place.ok("record PATCH --size 48x36 --expect --out t.jsonl");
    let trace = place.text("t.jsonl");
    let (before, end) = trace.trim_end().rsplit_once('\n').expect("lines");
    assert!(end.starts_with("{\"end\""), "{end}");
    let commands = before.lines().count() + 5000;
    let more = "\n{\"expect\":{\"cycles\":1}}".repeat(5000);
    fs::write(place.path("t.jsonl"), format!("{before}{more}\n{{\"end\":{{\"commands\":{commands}}}}}\n")).expect("written");
    for how in ["", "--bless "] {
        let outcome = place.run(&format!("verify {how}t.jsonl"));
        let line = before.lines().count() + 64;
        let said = format!("t.jsonl: line {line}: expect: is one too many, expected at most 64");
        assert!(outcome.error(1).starts_with(&said), "{how}: {}", outcome.err);
    }
}

#[test]
fn bad_trace_does_not_stop_verification() {
    let place = Place::new();
    place.ok("record PATCH --size 48x36 --expect --out z.bdl");
    fs::write(place.path("a.bdl"), "no trace").expect("written");
    let outcome = place.run("verify .");
    outcome.error(1);
    assert!(outcome.out.contains("FAILED  ./a.bdl") && outcome.out.contains("ok      ./z.bdl"), "{}", outcome.out);
    fs::remove_file(place.path("a.bdl")).expect("removed");
    place.ok("record PATCH --size 48x36 --out plain.bdl");
    let plain = place.run("verify plain.bdl");
    assert!(plain.out.contains("has no expectations"), "{}", plain.out);
    assert!(plain.err.contains("1 of 1 traces: no expectations"), "{}", plain.err);
    place.run("verify -").error(2);
    place.run("verify missing.bdl").error(1);
}

#[test]
fn input_hash_covers_canonical_commands() {
    let place = Place::new();
    place.ok("record PATCH --size 48x36 --out t.jsonl");
    place.ok("run t.jsonl");
    let text = place.text("t.jsonl");
    let hash = place.report("out")["input"]["sha256"].clone();
    let commands: Vec<&str> = text.lines().collect();
    let without_texels = |line: &str| {
        let texels = line.split_once(r#","data":""#).and_then(|(head, texels)| Some((head, texels.split_once('"')?.1)));
        texels.map_or_else(|| format!("{line}\n"), |(head, tail)| format!("{head}{tail}\n"))
    };
    let ends = [commands.len(), commands.len() - 1].map(|n| commands[..n].iter().map(|l| without_texels(l)).collect::<String>());
    assert!(ends.iter().any(|list| hash == sha256(list.as_bytes()).as_str()), "{hash}");
}
