//! `import-gl` and `capture`.

use crate::support::{Place, workspace};
use serde_json::Value;
use std::fs;
#[cfg(unix)]
use std::process::Stdio;

/// Returns the command that imports the frame of tests/opengl, without its output.
fn import() -> String {
    let folder = workspace().join("tests/opengl");
    let files = ["435", "466", "493"].map(|call| folder.join(format!("frame.{call}.json")).display().to_string());
    format!("import-gl {} --map 435.normal-map=none,493.normal-map=none", files.join(" "))
}

#[test]
fn imported_frame_is_drawn_by_every_machine() {
    let place = Place::new();
    let run = place.ok(&format!("{} --out frame.gltf --agree 99.9", import()));
    assert!(run.out.contains("Geometry agrees on 100.000 % of 10,800 pixels: 0 differ in coverage, 0 in depth"), "{}", run.out);
    assert!(run.out.contains("call 466: mvp = projection * view * model, position = position (read from the vertex program)"));
    assert!(run.err.contains("warning: call 435: texture `normal_map` is left out"), "{}", run.err);
    let written = ["frame.application.png", "frame.camera.json", "frame.difference.png", "frame.exact.png", "frame.gltf"];
    assert_eq!(place.names("."), written);
    let command = run.out.lines().last().unwrap().trim().strip_prefix("basrelief ").expect("a command").to_owned();
    for machine in ["bump", "shade", "texel", "defer"] {
        place.ok(&format!("{command} --machine {machine} --out {machine} --no-bottlenecks"));
        let report = place.report(machine);
        let psnr = report["quality"]["min"]["psnr_db"].as_f64();
        assert!(psnr.is_some_and(|psnr| psnr > 30.0), "{machine}: {}", report["quality"]);
        assert!(place.frame_cycles(machine) > 10_000, "{machine}");
    }
}

#[test]
fn geometry_that_disagrees_fails_the_check() {
    let place = Place::new();
    let folder = workspace().join("tests/opengl");
    let text = fs::read_to_string(folder.join("frame.493.json")).unwrap();
    let mut dump: Value = serde_json::from_str(&text).unwrap();
    fs::write(place.path("a.json"), dump.to_string()).unwrap();
    // The floor and the ball are missing.
    let failed = place.run("import-gl a.json --out a.gltf --agree 99.9 --quiet");
    assert!(failed.error(1).starts_with("--agree 99.9: geometry agrees on"), "{}", failed.err);
    dump.as_object_mut().unwrap().remove("framebuffer");
    fs::write(place.path("a.json"), dump.to_string()).unwrap();
    assert!(place.run("import-gl a.json --out a.gltf --agree 99.9 --quiet").error(1).contains("no image with depth"));
    assert!(place.ok("import-gl a.json --out a.gltf").out.contains("Nothing is compared, because the dump has no image"));
}

#[test]
fn import_without_picture_removes_older_pictures() {
    let place = Place::new();
    let folder = workspace().join("tests/opengl");
    let text = fs::read_to_string(folder.join("frame.493.json")).unwrap();
    let mut dump: Value = serde_json::from_str(&text).unwrap();
    fs::write(place.path("a.json"), &text).unwrap();
    fs::write(place.path("a.other.png"), "").unwrap();
    place.ok("import-gl a.json --out a.gltf");
    assert!(place.names(".").contains(&"a.exact.png".to_owned()));
    dump.as_object_mut().unwrap().remove("framebuffer");
    fs::write(place.path("a.json"), dump.to_string()).unwrap();
    let out = place.ok("import-gl a.json --out a.gltf").out;
    assert!(out.contains("Removed a.exact.png, an image of an earlier import"), "{out}");
    assert_eq!(place.names("."), ["a.camera.json", "a.gltf", "a.json", "a.other.png"]);
}

/// The second picture cannot be written, because its name is that of a folder.
#[test]
fn failed_import_leaves_older_files() {
    let place = Place::new();
    fs::create_dir(place.path("frame.exact.png")).unwrap();
    fs::write(place.path("frame.gltf"), "old").unwrap();
    let failed = place.run(&format!("{} --out frame.gltf --quiet", import()));
    assert!(failed.error(1).contains("frame.exact.png: cannot be written"), "{}", failed.err);
    assert_eq!((place.text("frame.gltf").as_str(), place.names(".").len()), ("old", 2));
}

#[test]
fn mistakes_of_an_import_are_named() {
    let place = Place::new();
    fs::write(place.path("a.json"), "{\"shaders\": 3}").unwrap();
    let error = |line: &str, code: i32, part: &str| {
        let run = place.run(line);
        assert!(run.err.contains(part) && run.code() == code, "{line}: {}", run.err);
    };
    error("import-gl a.json --out a.gltf", 1, "error: a.json: /shaders (line 1, column 13): the number 3 stands here");
    error("import-gl b.json --out a.gltf", 1, "b.json: cannot be read");
    error("import-gl a.json --out a.obj", 2, "--out a.obj: expected a name that ends in .gltf");
    error("import-gl a.json --out a.gltf --map uvw=x", 2, "`uvw` is no key; expected one of position");
    error("import-gl a.json --out a.gltf --map light=20:20", 2, "`20:20` is no value of `light`; expected `none`, three numbers");
    error("import-gl --out a.gltf", 2, "<DUMP>");
    fs::write(place.path("a.camera.json"), "{}").unwrap();
    error("import-gl a.camera.json --out a.gltf", 2, "a.camera.json");
    assert_eq!(place.text("a.camera.json"), "{}");
}

#[test]
fn capture_without_apitrace_names_the_package() {
    let place = Place::new();
    let mut command = place.command("capture --out a.gltf -- program");
    command.env("PATH", place.path("empty"));
    let output = command.output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.starts_with("error: apitrace is not installed; install the package `apitrace`"), "{text}");
}

/// Returns a capture under a program called apitrace that prints a line and waits.
#[cfg(unix)]
fn endless_capture(place: &Place) -> std::process::Command {
    use std::os::unix::fs::PermissionsExt as _;
    fs::create_dir(place.path("bin")).unwrap();
    let program = place.path("bin/apitrace");
    fs::write(&program, "#!/bin/sh\necho 60 frames per second\ntouch started\nexec sleep 2\n").unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = place.command("capture --out a.gltf -- program");
    let path = std::env::var("PATH").unwrap_or_default();
    command.env("PATH", format!("{}:{path}", place.path("bin").display()));
    command
}

#[cfg(unix)]
#[test]
fn interrupted_capture_names_what_remains() {
    let place = Place::new();
    let capture = endless_capture(&place).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !place.path("started").exists() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let id = capture.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = capture.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "", "standard output holds the text of this program only");
    assert_eq!(
        String::from_utf8(output.stderr).unwrap(),
        "60 frames per second\ninterrupted; no scene was written; the .capture folder holds an unfinished trace\n"
    );
}
