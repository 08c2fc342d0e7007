//! Errors name the file, the reason, the expectation and the cure.

use crate::support::{PROGRAM, Place, finish};
use std::fs;

#[test]
fn missing_input_of_every_command_has_a_cure() {
    let place = Place::new();
    for name in ["patch.gltf", "views.toml", "camera.json", "plan.toml", "list.jsonl"] {
        fs::write(place.path(name), "").expect("written");
    }
    for (line, near) in [
        ("run patch.glb", "patch.gltf"),
        ("run golf-ball", "demo:golf-ball"),
        ("demo --config pan.toml", "plan.toml"),
        ("demo --views views.json", "views.toml"),
        ("demo --camera camra.json", "camera.json"),
        ("sweep plam.toml", "plan.toml"),
        ("compare patch list", "patch.gltf"),
        ("serve patch.obj", "patch.gltf"),
        ("convert list.bdl t.bdl", "list.jsonl"),
        ("size-fifos patch.glb", "patch.gltf"),
        ("resimulate lst.jsonl", "list.jsonl"),
        ("verify list.bdl", "list.jsonl"),
    ] {
        let outcome = place.run(line);
        let error = outcome.error(1);
        assert!(
            error.contains(&format!("; expected an existing file; did you mean `{near}`? Otherwise check")),
            "{line}: {error}"
        );
    }
    for line in ["demo --config nix.toml", "sweep nosuch.toml"] {
        let outcome = place.run(line);
        let cure = "expected an existing file; check the name, which is looked up from the current folder";
        assert!(outcome.error(1).contains(cure), "{line}: {}", outcome.err);
    }
    let far = place.run("run none/model.glb");
    assert!(far.error(1).contains("the folder none does not exist; check the name, which is looked up"), "{}", far.err);
}

#[cfg(unix)]
#[test]
fn refused_output_folder_is_named_with_cure() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    let allow = |name: &str, mode| fs::set_permissions(place.path(name), fs::Permissions::from_mode(mode)).expect("permissions");
    fs::create_dir(place.path("locked")).expect("created");
    allow("", 0o755);
    allow("locked", 0o555);
    // Root may write everywhere.
    let is_root = fs::write(place.path("locked/probe"), "").is_ok();
    let unprivileged = |line: &str| {
        let mut command = std::process::Command::new(if is_root { "setpriv" } else { PROGRAM });
        if is_root {
            command.args(["--reuid", "65534", "--regid", "65534", "--clear-groups", PROGRAM]);
        }
        finish(command.args(line.split(' ')).current_dir(place.path("")))
    };
    if unprivileged("--version").status.code() != Some(0) {
        println!("SKIPPED: this user cannot give up the right to write everywhere");
        return;
    }
    let cure = "the folder locked does not allow writing; choose another folder, or allow writing to it";
    let small = "demo golf-ball --size 8x8 --no-exact --no-bottlenecks --quiet";
    for out in ["--out locked", "--out locked/a/b/c", "--out locked/a --waves locked/w.fst"] {
        let outcome = unprivileged(&format!("{small} {out}"));
        let error = outcome.error(1);
        assert!(error.contains("Permission denied") && error.contains(cure), "{out}: {error}");
    }
    let plan = "input = 'demo:golf-ball'\nobjectives = ['cycles min']\nview.size = '8x8'\naxes.replacement.lanes = [1]\n";
    fs::write(place.path("plan.toml"), plan).expect("written");
    let sweep = unprivileged("sweep plan.toml --out locked/a --quiet");
    assert!(sweep.error(1).contains(cure), "{}", sweep.err);
    allow("locked", 0o755);
}

#[test]
fn folder_without_recording_names_reason_and_cure() {
    let place = Place::new();
    place.ok("demo golf-ball --size 8x8 --no-exact --no-bottlenecks --quiet --out a");
    for command in ["resimulate a", "size-fifos a"] {
        let outcome = place.run(command);
        let error = outcome.error(1);
        assert!(error.starts_with("a/run.recording: cannot be read: "), "{error}");
        assert!(error.contains("--no-bottlenecks") && error.contains("`basrelief run INPUT --recording FILE`"), "{error}");
    }
}

#[test]
fn recording_as_input_points_to_resimulate() {
    let place = Place::new();
    place.ok("demo golf-ball --size 8x8 --no-exact --quiet");
    let outcome = place.run("run out/run.recording --out b");
    let says = "out/run.recording: the recording of a run, expected a model or a trace; `basrelief resimulate out/run.recording`";
    assert!(outcome.error(1).starts_with(says), "{}", outcome.err);
}

#[test]
fn picture_as_text_names_the_expected_file() {
    let place = Place::new();
    place.ok("demo golf-ball --size 8x8 --no-exact --no-bottlenecks --quiet");
    for (line, content) in [
        ("sweep out/image.png", "a plan (TOML)"),
        ("compare out out/image.png", "a report (report.json), or the folder that holds it"),
        ("demo --out b --config out/image.png", "parameters of a machine (TOML or JSON)"),
        ("demo --out b --views out/image.png", "views (TOML or JSON)"),
        ("demo --out b --camera out/image.png", "a camera (JSON)"),
    ] {
        let outcome = place.run(&format!("{line} --quiet"));
        let says = format!("out/image.png: not a text file in UTF-8; expected {content}\n");
        assert_eq!(outcome.error(1), says, "{line}");
    }
}

#[test]
fn unreadable_trace_is_named_on_standard_error() {
    let place = Place::new();
    let outcome = place.run("verify nosuch");
    assert_eq!(outcome.out, "FAILED  nosuch\n");
    let error = outcome.error(1);
    assert!(error.starts_with("nosuch: cannot be read: ") && !error.contains("above"), "{error}");
    assert!(error.ends_with("1 of 1 traces cannot be read, run or written\n"), "{error}");
}

#[test]
fn reached_cycle_limit_names_value_and_cure() {
    let place = Place::new();
    let outcome = place.run("demo golf-ball --size 8x8 --no-exact --no-bottlenecks --quiet --max-cycles 100");
    let says =
        "stopped at --max-cycles 100; the report holds the state so far; a larger --max-cycles, or none, lets the run finish";
    assert_eq!(outcome.error(1).trim_end(), says);
}
