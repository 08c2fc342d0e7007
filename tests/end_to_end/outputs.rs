//! Outputs: each is written completely or not at all, to a file of its own. An error names the affected file.

use crate::support::{Place, picture};
use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

const FILES: [&str; 5] = ["difference.png", "image.png", "reference.png", "report.json", "run.recording"];

#[test]
fn remains_of_killed_run_are_removed() {
    let place = Place::new();
    let mut killed = place.command("run PATCH --size 64x48 --frames 3000").stdout(Stdio::null()).spawn().expect("starts");
    let begun = || {
        let folders = fs::read_dir(place.path("out")).into_iter().flatten().flatten();
        folders.into_iter().any(|folder| folder.path().join("image-0002.png").exists())
    };
    (0..5000).take_while(|_| !begun()).for_each(|_| sleep(Duration::from_millis(2)));
    assert!(begun());
    killed.kill().expect("a child");
    killed.wait().expect("a child");
    assert_eq!(place.names("out").len(), 1, "remains");
    place.ok("run PATCH --size 16x12");
    assert_eq!(place.names("out"), FILES);
}

#[test]
fn new_run_removes_pictures_of_an_earlier_run() {
    let place = Place::new();
    let run = |options: &str| {
        place.ok(&format!("run PATCH --size 16x12 --functional {options}"));
        place.names("out")
    };
    let three = run("--frames 3 --orbit 30");
    assert!(["image-0003.png", "reference-0003.png", "difference-0003.png"].iter().all(|name| three.contains(&(*name).into())));
    // No report lists these.
    let own = ["image-0009.png", "own.png"];
    own.iter().for_each(|name| fs::write(place.path("out").join(name), "mine").expect("written"));
    assert_eq!(run("--no-exact"), ["image-0009.png", "image.png", "own.png", "report.json"]);
    assert_eq!(
        run("--frames 2 --orbit 30 --no-exact"),
        [&["image-0001.png", "image-0002.png"], &own[..], &["report.json"]].concat()
    );
    // The run before had no exact picture, so this file is not of it.
    fs::write(place.path("out/reference-0001.png"), "mine").expect("written");
    let left = ["image-0009.png", "image.png", "own.png", "reference-0001.png", "report.json"];
    assert_eq!(run("--no-exact"), left);
    place.ok("run PATCH --size 16x12 --no-bottlenecks --no-exact --costs");
    assert!(["cost.png", "wait.png", "overdraw.png"].iter().all(|name| place.names("out").contains(&(*name).into())));
    assert_eq!(run("--no-exact"), left);
}

/// Publishing hundreds of images takes some milliseconds. The run is killed once the first of them is in its place.
#[cfg(unix)]
#[test]
fn killed_run_leaves_no_old_report_beside_new_images() {
    use std::os::unix::fs::MetadataExt as _;
    let place = Place::new();
    let line = "run PATCH --size 16x12 --frames 400 --functional --no-exact --csv --quiet";
    place.ok(line);
    let files = || ["report.json", "report.csv"].map(|name| fs::read(place.path("out").join(name)).ok());
    let old = files();
    let mut between = 0;
    for _ in 0..5 {
        // Few files, so that the loop is fast.
        let watched = ["report.json", "image-0001.png", "image-0100.png", "image-0200.png", "image-0300.png"];
        let inodes = || watched.map(|name| fs::metadata(place.path("out").join(name)).map(|file| file.ino()).ok());
        let before = inodes();
        let mut child = place.command(&format!("{line} --set replacement.entries=16")).spawn().expect("starts");
        while child.try_wait().expect("a child").is_none() && inodes() == before {}
        child.kill().expect("a child");
        child.wait().expect("a child");
        let left = files();
        between += usize::from(left[0].is_none());
        let has_new_image = inodes()[1..] != before[1..];
        for (left, old) in left.iter().zip(&old) {
            assert!(!has_new_image || left.is_none() || left != old, "an old report beside new images");
        }
        place.ok(line);
    }
    assert!(between > 0, "no run was killed while it published");
}

/// Traces the system calls of a run. A file that is renamed before its content is on disk can be empty after a power cut.
#[cfg(target_os = "linux")]
#[test]
fn files_are_on_disk_before_they_are_renamed() {
    let place = Place::new();
    fs::write(
        place.path("plan.toml"),
        "input = \"demo:coin\"\nmachine = \"shade\"\nobjectives = [\"cycles min\"]\n[view]\nsize = \"16x12\"\n[axes]\nfifo.pixels.depth = [2, 4]\n",
    )
    .expect("written");
    for line in ["run PATCH --size 16x12 --csv --html page.html", "sweep plan.toml --out sweep", "record PATCH --out t.bdl"] {
        let mut traced = Command::new("strace");
        traced.args(["-f", "-y", "-o", "calls", "-e", "trace=fsync,fdatasync,rename,renameat,renameat2"]);
        let run = place.command(line);
        traced.arg(run.get_program()).args(run.get_args()).current_dir(place.path("")).stdout(Stdio::null());
        match traced.status() {
            Ok(status) if status.success() => {}
            _ => return println!("SKIPPED: strace is not there, or may not trace"),
        }
        let calls = place.text("calls");
        let mut synced: Vec<&str> = vec![];
        let mut renamed = 0;
        for call in calls.lines() {
            if let Some((_, file)) = call.split_once("sync(").filter(|_| call.contains(") = 0")) {
                synced.extend(file.split(['<', '>']).nth(1));
            } else if let Some((_, names)) = call.split_once("rename").filter(|_| call.contains(") = 0")) {
                let from = names.split('"').nth(1).expect("a path");
                let name = from.trim_start_matches("./");
                // Inside a hidden folder, files only get their final names.
                let to = names.split('"').nth(3).expect("a path");
                if !to.contains(".partial-") {
                    renamed += 1;
                    assert!(synced.iter().any(|file| file.ends_with(name)), "{line}: {from} is not on disk: {calls}");
                }
            }
        }
        assert!(renamed > 0, "{line}: {calls}");
    }
}

#[test]
fn two_runs_into_one_folder_leave_one_complete_result() {
    let place = Place::new();
    let sizes = ["64x48", "32x24"];
    let lines = sizes.map(|size| format!("run PATCH --frames 20 --orbit 90 --quiet --size {size}"));
    let mut runs = lines.each_ref().map(|line| place.command(line).spawn().expect("starts"));
    runs.iter_mut().for_each(|run| assert!(run.wait().expect("a child").success()));
    let width = place.report("out")["size"]["width"].as_u64().expect("a width");
    assert_eq!(place.names("out").len(), 62, "{:?}", place.names("out"));
    for name in place.names("out").iter().filter(|name| name.ends_with(".png")) {
        assert_eq!(u64::from(picture(&place.path("out").join(name)).0), width, "{name}");
    }
}

#[test]
fn two_outputs_into_one_file_are_refused() {
    let place = Place::new();
    place.ok("run PATCH --size 16x12 --out o");
    let before = place.text("o/report.json");
    fs::create_dir(place.path("d")).expect("created");
    let mut names = vec!["o/report.json", "./o/report.json", "d/../o/image.png", "o/report.csv"];
    if cfg!(unix) {
        for (to, name) in [("o", "link"), ("o/report.json", "to-report")] {
            let linked = Command::new("ln").args(["-s", to, name]).current_dir(place.path("")).status().expect("ln");
            assert!(linked.success());
        }
        names.extend(["link/report.json", "to-report"]);
    }
    for name in names {
        let refused = place.run(&format!("run PATCH --size 16x12 --out o --timeline {name}"));
        assert!(
            refused.error(2).contains("--timeline: ") && refused.err.contains("of this run in --out"),
            "{name}: {}",
            refused.err
        );
        let refused = place.run(&format!("demo --machine texel --size 16x12 --out o --dump spans {name}"));
        assert!(refused.error(2).contains("--dump: ") && refused.err.contains("of this run in --out"), "{name}: {}", refused.err);
    }
    let twice = place.run("demo --machine texel --size 16x12 --out o --timeline x --dump spans d/../x");
    assert!(twice.error(2).contains("is also the output of"), "{}", twice.err);
    assert_eq!(place.text("o/report.json"), before);
    assert!(place.run("run PATCH --size 16x12 --out o --timeline o/run.recording").error(2).contains("of this run in --out"));
    place.ok("run PATCH --size 16x12 --out o --timeline o/time --quiet");
    assert!(place.path("o/time").exists());
}

#[test]
fn outputs_never_overwrite_inputs() {
    let place = Place::new();
    place.ok("record PATCH --size 16x12 --out t.jsonl");
    fs::write(place.path("c.toml"), "replacement.entries = 64\n").expect("written");
    for (line, option, what) in [
        ("run t.jsonl --timeline ./t.jsonl", "--timeline", "INPUT"),
        ("run t.jsonl --recording t.jsonl", "--recording", "INPUT"),
        ("run t.jsonl --requests t.jsonl", "--requests", "INPUT"),
        ("demo --size 16x12 --config c.toml --timeline c.toml", "--timeline", "--config"),
        ("demo --machine texel --size 16x12 --camera c.toml --dump spans c.toml", "--dump", "--camera"),
    ] {
        let (files, refused) = (["c.toml", "t.jsonl"].map(|name| place.text(name)), place.run(line));
        let error = refused.error(2);
        assert!(error.starts_with(&format!("{option}: ")) && error.contains(&format!("is an input ({what})")), "{line}: {error}");
        assert_eq!(["c.toml", "t.jsonl"].map(|name| place.text(name)), files, "{line}");
    }
    assert_eq!(place.names(""), ["c.toml", "t.jsonl"]);
}

#[test]
fn every_command_keeps_its_inputs() {
    let place = Place::new();
    place.ok("demo --size 16x12 --no-exact --out a");
    place.ok("demo --size 16x12 --no-exact --out b");
    place.ok("record PATCH --size 16x12 --out t.jsonl");
    fs::write(place.path("a/report.csv"), "replacement.entries = 64\n").expect("written");
    let plan = "title = \"a\"\ninput = \"t.jsonl\"\nmachine = \"bump\"\nconfig = \"sweep.csv\"\nobjectives = [\"cycles min\"]\n\
                [axes]\nfifo.pixels.depth = [64, 128]\n";
    fs::write(place.path("plan.toml"), plan).expect("written");
    fs::write(place.path("sweep.csv"), "replacement.entries = 64\n").expect("written");
    let names = ["a/report.json", "a/run.recording", "a/image.png", "a/report.csv", "b/report.json", "t.jsonl", "sweep.csv"];
    let before = names.map(|name| place.bytes(name));
    for line in [
        "compare a b --html a/report.json",
        "compare a b --html b/report.json",
        "compare a b --html a/run.recording",
        "compare a b --html a/image.png",
        "resimulate a --html a/report.json",
        "resimulate a --out a",
        "resimulate a/run.recording --html a/run.recording",
        "demo --size 16x12 --config a/report.csv --out a",
        "convert t.jsonl ./t.jsonl",
        "record PATCH --camera t.jsonl --out t.jsonl",
        "sweep plan.toml --out .",
    ] {
        let error = place.run(line);
        assert!(error.error(2).contains("is an input"), "{line}: {}", error.err);
        assert!(names.map(|name| place.bytes(name)) == before, "{line}");
    }
}

/// Textures, buffers and texels in files are inputs, although the command line does not name them.
#[test]
fn outputs_keep_files_that_an_input_names() {
    let place = Place::new();
    let model = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n";
    fs::write(place.path("m.obj"), model).expect("written");
    fs::write(place.path("m.mtl"), "newmtl m\nmap_Kd image.png\n").expect("written");
    image::RgbImage::from_pixel(4, 4, image::Rgb([9; 3])).save(place.path("image.png")).expect("written");
    let positions: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(place.path("b.bin"), positions).expect("written");
    let gltf = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"uri":"b.bin","byteLength":36}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;
    fs::write(place.path("b.gltf"), gltf).expect("written");
    let before = ["image.png", "m.mtl", "b.bin"].map(|name| place.bytes(name));
    for line in [
        "run m.obj --size 8x8 --out .",
        "run m.obj --size 8x8 --out o --html m.mtl",
        "run m.obj --size 8x8 --out o --timeline image.png",
        "run b.gltf --size 8x8 --out o --recording b.bin",
    ] {
        let refused = place.run(line);
        assert!(refused.error(2).contains("is an input (a file that INPUT names)"), "{line}: {}", refused.err);
        assert_eq!(["image.png", "m.mtl", "b.bin"].map(|name| place.bytes(name)), before, "{line}");
    }
    // Other names in the folder of the model are free.
    fs::rename(place.path("image.png"), place.path("wood.png")).expect("renamed");
    fs::write(place.path("m.mtl"), "newmtl m\nmap_Kd wood.png\n").expect("written");
    place.ok("run m.obj --size 8x8 --out . --quiet");
    assert_eq!(place.bytes("wood.png"), before[0]);
}

#[test]
fn foreign_names_cannot_control_the_terminal() {
    let place = Place::new();
    let name = "a\u{1b}]0;title\u{7}\u{9b}2J.jsonl";
    fs::write(place.path(name), "no trace").expect("written");
    let outcome = place.command("run").arg(name).output().expect("starts");
    let said = String::from_utf8(outcome.stderr).expect("UTF-8");
    assert!(said.contains("a\\u001b]0;title\\u0007\\u009b2J.jsonl"), "{said}");
    assert!(!said.contains(|c: char| c.is_control() && c != '\n'), "{said:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn unprintable_report_writes_nothing() {
    let place = Place::new();
    for more in ["--json", "--machine shade --ablate --json"] {
        let full = fs::File::options().write(true).open("/dev/full").expect("a device");
        let mut child = place.command(&format!("run PATCH --size 16x12 {more}")).stdout(full).spawn().expect("starts");
        assert_eq!(child.wait().expect("a child").code(), Some(1), "{more}");
        assert!(place.names("").is_empty(), "{more}: {:?}", place.names(""));
    }
    place.ok("record PATCH --out t.jsonl");
    for line in ["convert t.jsonl -", "record PATCH --out -", "--help", "--version", "run --help"] {
        let full = fs::File::options().write(true).open("/dev/full").expect("a device");
        let child = place.command(line).stdout(full).stderr(Stdio::piped()).spawn().expect("starts");
        let said = String::from_utf8_lossy(&child.wait_with_output().expect("a child").stderr).into_owned();
        assert!(said.starts_with("error: standard output: cannot be written: No space left"), "{line}: {said}");
    }
}

#[cfg(unix)]
#[test]
fn full_disk_names_file() {
    let place = Place::new();
    place.ok("record PATCH --out t.jsonl");
    place.ok("record PATCH --out blessed.jsonl");
    let before = place.text("blessed.jsonl");
    for (line, file) in [
        ("convert t.jsonl u.jsonl", "u.jsonl"),
        ("convert t.jsonl u.bdl.zst", "u.bdl.zst"),
        ("record PATCH --out u.jsonl", "u.jsonl"),
        ("run PATCH --size 64x48 --out u", "u/image-0001.png"),
        ("demo --machine texel --size 64x48 --out u --dump spans u.jsonl --no-exact", "u"),
        ("run PATCH --size 16x12 --out u --timeline u.pftrace", "u"),
        ("run PATCH --size 16x12 --out u --requests u.csv --no-exact", "u"),
    ] {
        let full = place.on_a_full_disk(line);
        let error = full.error(1);
        assert!(error.starts_with(file) && error.contains("cannot be written: ") && !error.contains("ncod"), "{line}: {error}");
        assert_eq!(place.names(""), ["blessed.jsonl", "t.jsonl"], "{line}");
    }
    let full = place.on_a_full_disk("verify --bless blessed.jsonl");
    assert!(!full.error(1).contains("--bless"), "{}", full.err);
    assert_eq!(place.text("blessed.jsonl"), before);
}

#[test]
fn unreadable_trace_is_not_blessed() {
    let place = Place::new();
    place.ok("record PATCH --out t.jsonl");
    assert!(place.run("verify t.jsonl").error(1).contains("`basrelief verify --bless` adds them"));
    let missing = place.run("verify missing");
    assert!(!missing.error(1).contains("--bless"), "{}", missing.err);
}
