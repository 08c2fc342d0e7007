//! Foreign and broken files: the program runs them, or fails with exit code 1 and an error that names the file. It never ends
//! by a signal, panics or hangs, and a failure writes nothing.

use crate::support::{Place, finish, inputs, patch, workspace};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Time limit for a small bad file in a debug build \[s\].
const PATIENCE_S: f64 = 5.0;

/// Runs a file. The run succeeds, or fails with a message that names the file and writes nothing.
fn check(place: &Place, file: &Path) -> i32 {
    let outcome = finish(place.command("run --size 32x24 --quiet --out out").arg(file));
    let (shown, code) = (file.display(), outcome.code());
    assert!(code == 0 || code == 1, "{shown}: exit code {code}: {}", outcome.err);
    assert!(outcome.seconds < PATIENCE_S, "{shown}: took {} s", outcome.seconds);
    if code == 1 {
        let name = file.file_name().expect("a name").to_string_lossy();
        assert!(outcome.error(1).contains(&*name), "{shown}: not named: {}", outcome.err);
        assert!(!place.path("out").exists(), "{shown}: something was written");
    } else {
        fs::remove_dir_all(place.path("out")).expect("outputs");
    }
    code
}

/// Returns all files below a folder with one of these endings.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            found.extend(files(&path, endings));
        } else if path.extension().is_some_and(|e| endings.iter().any(|known| e == *known)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn validator_files_run_or_are_refused() {
    let Some(folder) = inputs("bad/gltf-validator") else { return };
    let place = Place::new();
    let files = files(&folder, &["gltf", "glb"]);
    assert!(files.len() >= 150, "only {} files", files.len());
    let refused: i32 = files.iter().map(|file| check(&place, file)).sum();
    assert!(refused > 50, "only {refused} refused");
}

#[test]
fn corrupt_pictures_are_errors() {
    let Some(folder) = inputs("bad/png") else { return };
    let place = Place::new();
    let model = fs::read_to_string(patch().with_extension("obj")).expect("the model");
    fs::write(place.path("m.obj"), model.replace("patch.mtl", "m.mtl")).expect("written");
    fs::copy(patch().with_file_name("checks.png"), place.path("checks.png")).expect("copied");
    for picture in files(&folder, &["png"]) {
        let name = picture.file_name().expect("a name").to_string_lossy().into_owned();
        fs::copy(&picture, place.path(&name)).expect("copied");
        fs::write(place.path("m.mtl"), format!("newmtl bumpy\nmap_Kd checks.png\nnorm {name}\n")).expect("written");
        let outcome = place.run("run m.obj --size 16x12 --out out");
        assert!(outcome.error(1).contains(&name), "{name}: {}", outcome.err);
        assert!(!place.path("out").exists());
    }
}

#[test]
fn non_model_is_refused_by_name() {
    let place = Place::new();
    fs::create_dir(place.path("folder")).expect("created");
    fs::write(place.path("letter.txt"), "Dear Sir or Madam,\n").expect("written");
    fs::write(place.path("empty.glb"), "").expect("written");
    fs::write(place.path("empty.jsonl"), "").expect("written");
    for name in ["folder", "letter.txt", "empty.glb", "empty.jsonl", "missing.gltf"] {
        for command in ["run", "record --out t.bdl", "convert t.bdl"] {
            let (command, rest) = command.split_once(' ').unwrap_or((command, ""));
            // The name is that of a display list, which `record` does not accept: wrong usage.
            if (command, name) == ("record", "empty.jsonl") {
                continue;
            }
            let line = format!("{command} {name} {rest}");
            assert!(place.run(&line).error(1).contains(name), "{line}");
        }
        assert!(!place.path("out").exists() && !place.path("t.bdl").exists(), "{name}");
    }
    if cfg!(unix) {
        assert!(place.run("run /dev/null").error(1).contains("/dev/null"));
        assert!(place.run("run /dev/zero").error(1).contains("/dev/zero"));
        assert!(place.run("run PATCH --config /dev/zero").error(1).contains("/dev/zero"));
    }
}

/// Makes a pipe without a writer.
#[cfg(unix)]
fn pipe(place: &Place, name: &str) {
    assert!(Command::new("mkfifo").arg(place.path(name)).status().expect("mkfifo").success());
}

#[cfg(unix)]
#[test]
fn pipe_as_model_file_does_not_block() {
    let place = Place::new();
    ["pipe", "pipe.png", "pipe.mtl"].iter().for_each(|name| pipe(&place, name));
    let gltf = |accessor: &str, more: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"materials":[{{"normalTexture":{{"index":0}}}}],"meshes":[{{"primitives":
            [{{"attributes":{{"POSITION":0}},"material":0}}]}}],"accessors":[{{"componentType":5126,"count":3,"type":"VEC3"{accessor}}}],
            "textures":[{{"source":0}}],{more}}}"#
        )
    };
    let buffer =
        r#""bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"pipe","byteLength":36}],"images":[{"uri":"x"}]"#;
    fs::write(place.path("buffer.gltf"), gltf(r#","bufferView":0"#, buffer)).expect("written");
    fs::write(place.path("image.gltf"), gltf("", r#""images":[{"uri":"pipe.png"}]"#)).expect("written");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
    fs::write(place.path("library.obj"), format!("mtllib pipe.mtl\n{triangle}")).expect("written");
    fs::write(place.path("map.obj"), format!("mtllib map.mtl\n{triangle}")).expect("written");
    fs::write(place.path("map.mtl"), "newmtl a\nnorm pipe.png\n").expect("written");
    for (model, pipe) in
        [("buffer.gltf", "pipe"), ("image.gltf", "pipe.png"), ("library.obj", "pipe.mtl"), ("map.obj", "pipe.png")]
    {
        let outcome = place.run(&format!("run {model} --size 16x12 --no-exact"));
        let said = format!("{}{}", outcome.out, outcome.err);
        assert!(outcome.code() <= 1 && said.contains(pipe) && said.contains("not a regular file"), "{model}: {said}");
        assert!(outcome.seconds < PATIENCE_S, "{model}: took {} s", outcome.seconds);
    }
}

#[cfg(unix)]
#[test]
fn verify_skips_pipes_and_repeated_links() {
    let place = Place::new();
    fs::create_dir(place.path("traces")).expect("created");
    place.ok("record PATCH --size 16x12 --expect --out traces/t.jsonl");
    pipe(&place, "traces/pipe.jsonl");
    std::os::unix::fs::symlink(".", place.path("traces/again")).expect("linked");
    std::os::unix::fs::symlink("/dev/zero", place.path("traces/zero.bdl")).expect("linked");
    assert_eq!(place.ok("verify traces").out, "ok      traces/t.jsonl\n");
    let pipe = place.run("verify traces/pipe.jsonl");
    assert!(pipe.out.is_empty() && pipe.error(1).starts_with("traces/pipe.jsonl: neither a file nor a folder"), "{}", pipe.err);
}

#[test]
fn truncated_trace_is_an_error_without_output() {
    let place = Place::new();
    let quad = workspace().join("crates/sim/src/quad.dl.jsonl");
    for form in ["jsonl", "jsonl.zst", "bdl", "bdl.zst"] {
        place.ok(&format!("convert {} whole.{form}", quad.display()));
        let bytes = place.bytes(&format!("whole.{form}"));
        // A text without its last line feed is complete.
        let whole = if form == "jsonl" { bytes.len() - 1 } else { bytes.len() };
        let name = format!("cut.{form}");
        // The reader is tested with every cut: `truncation_at_every_byte_is_an_error_in_every_form`.
        for cut in (0..whole).step_by(23).chain([whole - 1]) {
            fs::write(place.path(&name), &bytes[..cut]).expect("written");
            let line = if cut % 2 == 0 { format!("convert {name} out.jsonl") } else { format!("run {name} --quiet") };
            assert!(place.run(&line).error(1).contains(&name), "{form} cut at {cut}");
            assert!(!place.path("out").exists() && !place.path("out.jsonl").exists(), "{form} cut at {cut}");
        }
    }
}

#[test]
fn failed_run_keeps_earlier_results() {
    let place = Place::new();
    place.ok("run PATCH --size 16x12");
    let before = place.text("out/report.json");
    fs::write(place.path("bad.gltf"), "{}").expect("written");
    place.run("run bad.gltf").error(1);
    assert_eq!(place.names("out"), ["difference.png", "image.png", "reference.png", "report.json", "run.recording"]);
    assert_eq!(place.text("out/report.json"), before);
    fs::remove_file(place.path("out/image.png")).expect("removed");
    fs::create_dir(place.path("out/image.png")).expect("created");
    assert!(place.run("run PATCH --size 16x12 --out out").error(1).contains("image.png is a folder"));
    assert_eq!(place.text("out/report.json"), before);
}

#[test]
fn input_of_another_format_is_named() {
    let place = Place::new();
    place.ok("demo coin --size 16x12 --no-exact --no-bottlenecks --quiet --out out");
    fs::write(place.path("notes.txt"), "solid").expect("written");
    for (file, expected) in [
        ("out/report.json", "is the report of a run; expected a glTF file; "),
        ("notes.txt", "expected a .glb, .gltf or .obj file, or a trace: .jsonl or .bdl, or either with .zst appended; "),
    ] {
        let outcome = place.run(&format!("run {file} --out other"));
        let error = outcome.error(1);
        assert!(error.starts_with(&format!("{file}: ")) && error.contains(expected), "{error}");
    }
}

#[test]
fn bad_settings_and_cameras_have_own_exit_codes() {
    let place = Place::new();
    fs::write(place.path("c.toml"), "[replacement]\nentrys = 3\n").expect("written");
    let outcome = place.run("run PATCH --config c.toml");
    let message = outcome.error(1);
    let words = "c.toml: line 2: unknown parameter `replacement.entrys`; did you mean `replacement.entries`";
    assert!(message.contains(words), "{message}");
    fs::write(place.path("c.toml"), "[replacement\n").expect("written");
    assert!(place.run("run PATCH --config c.toml").error(1).contains("not valid TOML"));
    let outcome = place.run("run PATCH --set replacement.lane=3");
    assert!(outcome.error(2).contains("did you mean `replacement.lanes`"), "{}", outcome.err);
    place.run("run PATCH --set replacement.entries=0").error(2);
    for camera in ["", "{}", "[]", r#"{"view_projection":[1],"to_light":[0,0,1],"to_viewer":[0,0,1]}"#] {
        fs::write(place.path("camera.json"), camera).expect("written");
        assert!(place.run("run PATCH --camera camera.json").error(1).contains("camera.json"), "{camera}");
    }
    assert!(!place.path("out").exists());
}

#[test]
fn unwritable_place_is_named() {
    let place = Place::new();
    fs::write(place.path("file"), "").expect("written");
    assert!(place.run("run PATCH --size 16x12 --out file/out").error(1).contains("file/out"));
    assert!(place.run("run PATCH --size 16x12 --out file").error(1).contains("file"));
    assert!(place.run("run PATCH --size 16x12 --timeline none/t").error(1).contains("none/t"));
    assert!(place.run("record PATCH --out none/t.bdl").error(1).contains("none/t.bdl"));
    assert_eq!(place.names(""), ["file"]);
}

#[test]
fn closed_output_pipe_is_no_error() {
    let place = Place::new();
    let mut child = Command::new(crate::support::PROGRAM)
        .arg("describe")
        .stdout(std::process::Stdio::piped())
        .current_dir(place.path(""))
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    assert!(child.wait().expect("a child").success());
}

// Claim: as own_views_equal_the_same_options.
#[test]
fn bad_view_file_names_place_and_field() {
    let place = Place::new();
    let write = |text: &str| std::fs::write(place.path("v.toml"), text).expect("written");
    let refused =
        |line: &str, code: i32| place.run(&format!("{line} --views v.toml --size 8x8 --out out")).error(code).to_owned();
    write("views = [{ orbit = 1 }, { zoom = 0 }]");
    assert!(refused("demo", 1).starts_with("v.toml: /views/1/zoom: 0; expected a number from 0.01 to 100"));
    write("views = [{ at_ms = 0 }, { at_ms = 0 }]");
    assert!(refused("demo", 1).starts_with("v.toml: /views/1/at_ms: 0; expected rising times"));
    write("views = [{ at_ms = 0 }, { at_ms = 5 }]");
    assert!(refused("demo golf-ball", 2).contains("machine `bump` cannot leave a view; use `defer`, or remove `at_ms`"));
    assert!(refused("demo gallery", 2).contains("set `defer.mode=progressive`"));
    assert!(refused("record demo:gallery", 2).contains("remove `at_ms`"));
    assert!(refused("demo --frames 2", 2).contains("--frames"));
    assert!(place.names("").iter().all(|name| name == "v.toml"), "{:?}", place.names(""));
}
