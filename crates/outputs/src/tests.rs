//! Publication and removal of output files.

use super::*;
use std::fs;
use std::io::Write;
use std::path::Path;

const REPORT: &str = "report.json";
const RECORDING: &str = "run.recording";
const OF_A_RUN: [&str; 2] = [REPORT, RECORDING];

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Lists no files of an earlier run.
fn nothing(_: &Path) -> Vec<String> {
    vec![]
}

#[test]
fn dropped_outputs_leave_no_files_or_folders() {
    let base = tempfile::tempdir().unwrap();
    let outputs = OutputFolder::begin(&base.path().join("new/out")).unwrap();
    outputs.create("a.txt").unwrap().write_all(b"a").unwrap();
    drop(outputs);
    PartialFile::create(&base.path().join("b.txt")).unwrap().write_all(b"b").unwrap();
    assert!(names(base.path()).is_empty());
}

#[test]
fn publish_replaces_own_files_only() {
    let base = tempfile::tempdir().unwrap();
    fs::write(base.path().join("mine.txt"), "kept").unwrap();
    fs::write(base.path().join("a.txt"), "old").unwrap();
    let outputs = OutputFolder::begin(base.path()).unwrap();
    outputs.create("first").unwrap().write_all(b"new").unwrap();
    outputs.create("report").unwrap();
    outputs.rename("first", "a.txt").unwrap();
    outputs.publish("report", nothing).unwrap();
    assert_eq!(names(base.path()), ["a.txt", "mine.txt", "report"]);
    assert_eq!(fs::read_to_string(base.path().join("a.txt")).unwrap(), "new");
}

#[test]
fn stale_recording_is_removed_with_its_report() {
    let base = tempfile::tempdir().unwrap();
    let publish = |names: &[&str]| {
        let outputs = OutputFolder::begin(base.path()).unwrap();
        names.iter().for_each(|name| drop(outputs.create(name).unwrap()));
        outputs.publish(REPORT, |_| vec![RECORDING.into()]).unwrap();
    };
    publish(&[REPORT, RECORDING, "image.png"]);
    publish(&[REPORT, RECORDING]);
    assert_eq!(names(base.path()), ["image.png", REPORT, RECORDING]);
    publish(&[REPORT]);
    publish(&[REPORT]);
    assert_eq!(names(base.path()), ["image.png", REPORT]);
}

#[test]
fn old_report_never_lies_beside_new_images() {
    let base = tempfile::tempdir().unwrap();
    let old = || {
        OF_A_RUN.iter().for_each(|name| fs::write(base.path().join(name), "old").unwrap());
        fs::write(base.path().join("image.png"), "old").unwrap();
    };
    old();
    // An image of a run that is killed later.
    let outputs = OutputFolder::begin(base.path()).unwrap();
    write_all(&outputs, &["image.png".into()], "new");
    assert_eq!(names(base.path()).len(), 1 + OF_A_RUN.len() + 1);
    outputs.show("image.png", |_| OF_A_RUN.map(str::to_owned).into()).unwrap();
    drop(outputs);
    assert_eq!(names(base.path()), ["image.png"]);
    // The best image of a failed run.
    old();
    let outputs = OutputFolder::begin(base.path()).unwrap();
    write_all(&outputs, &["image.png".into()], "best");
    outputs.publish("image.png", |_| OF_A_RUN.map(str::to_owned).into()).unwrap();
    assert_eq!(names(base.path()), ["image.png"]);
}

#[test]
fn failed_placement_leaves_no_file() {
    let base = tempfile::tempdir().unwrap();
    fs::create_dir(base.path().join("report")).unwrap();
    let outputs = OutputFolder::begin(base.path()).unwrap();
    outputs.create("a").unwrap();
    outputs.create("report").unwrap();
    assert!(outputs.publish("report", nothing).unwrap_err().to_string().contains("report is a folder"));
    assert_eq!(names(base.path()), ["report"]);
}

#[test]
fn device_output_stays_a_device() {
    let device = Path::new("/dev/null");
    if !device.exists() {
        return;
    }
    let mut file = PartialFile::create(device).unwrap();
    file.write_all(b"x").unwrap();
    file.publish().unwrap();
    assert!(!fs::metadata(device).unwrap().is_file());
}

/// Writes files of these names with the same content.
fn write_all(outputs: &OutputFolder, names: &[String], says: &str) {
    for name in names {
        outputs.create(name).unwrap().write_all(says.as_bytes()).unwrap();
    }
}

#[test]
fn runs_into_one_folder_do_not_mix_files() {
    let base = tempfile::tempdir().unwrap();
    let all = ["image.png", "report.json"].map(str::to_owned);
    let says = || all.each_ref().map(|name| fs::read_to_string(base.path().join(name)).unwrap());
    let (first, second) = (OutputFolder::begin(base.path()).unwrap(), OutputFolder::begin(base.path()).unwrap());
    write_all(&first, &all, "first");
    write_all(&second, &all[..1], "second");
    first.publish("report.json", nothing).unwrap();
    assert_eq!(says(), ["first", "first"]);
    write_all(&second, &all[1..], "second");
    second.publish("report.json", nothing).unwrap();
    assert_eq!(says(), ["second", "second"]);
    assert_eq!(names(base.path()), all);
}

/// Publishes through `publish` while another process holds the lock of the folder. That process publishes `report.json` and
/// `image-0007.png`.
#[cfg(unix)]
fn publish_after_another_run(publish: fn(OutputFolder) -> std::io::Result<()>) -> Vec<String> {
    let base = tempfile::tempdir().unwrap();
    let outputs = OutputFolder::begin(base.path()).unwrap();
    write_all(&outputs, &["image.png".into()], "mine");
    let other = fs::File::open(base.path()).unwrap();
    other.lock().unwrap();
    let waits = std::thread::spawn(move || publish(outputs));
    std::thread::sleep(std::time::Duration::from_millis(200));
    assert!(!base.path().join("image.png").exists());
    [REPORT, "image-0007.png"].iter().for_each(|name| fs::write(base.path().join(name), "other").unwrap());
    drop(other);
    waits.join().unwrap().unwrap();
    names(base.path())
}

#[cfg(unix)]
#[test]
fn simultaneous_runs_publish_in_turn() {
    let found = publish_after_another_run(|outputs| outputs.publish("image.png", nothing));
    assert_eq!(found, ["image-0007.png", "image.png", REPORT]);
}

#[cfg(unix)]
#[test]
fn files_of_the_run_before_are_listed_in_turn() {
    fn visible(folder: &Path) -> Vec<String> {
        names(folder).into_iter().filter(|name| !name.starts_with('.')).collect()
    }
    assert_eq!(publish_after_another_run(|outputs| outputs.publish("image.png", visible)), ["image.png"]);
    assert_eq!(publish_after_another_run(|outputs| outputs.show("image.png", visible)), ["image.png"]);
}

/// Makes the remains of a killed run: a folder with an image, an empty folder, and a file.
fn make_remains(folder: &Path) {
    fs::create_dir(folder.join(".partial-0123456789abcdef")).unwrap();
    fs::write(folder.join(".partial-0123456789abcdef/lock"), "").unwrap();
    fs::write(folder.join(".partial-0123456789abcdef/image-0001.png"), "dead").unwrap();
    fs::create_dir(folder.join(".partial-00000000000000aa")).unwrap();
    fs::write(folder.join(".partial-ffffffffffffffff"), "dead").unwrap();
}

#[test]
fn remains_of_dead_runs_only_are_removed() {
    let base = tempfile::tempdir().unwrap();
    let place = base.path().join("t.bdl");
    make_remains(base.path());
    let (living, mut file) = (OutputFolder::begin(base.path()).unwrap(), PartialFile::create(&place).unwrap());
    file.write_all(b"mine").unwrap();
    write_all(&living, &["image.png".into()], "mine");
    assert_eq!(names(base.path()).len(), 2, "{:?}", names(base.path()));
    make_remains(base.path());
    drop(PartialFile::create(&place).unwrap());
    drop(OutputFolder::begin(base.path()).unwrap());
    assert_eq!(names(base.path()).len(), 2, "{:?}", names(base.path()));
    living.publish("image.png", nothing).unwrap();
    file.publish().unwrap();
    assert_eq!(names(base.path()), ["image.png", "t.bdl"]);
}

#[test]
fn files_of_the_user_are_no_remains() {
    let base = tempfile::tempdir().unwrap();
    let mine = [".partial", ".partial-", ".partial-17", ".partial-0123456789abcdeg", ".partial-0123456789abcdef0", "x"];
    mine.iter().for_each(|name| fs::write(base.path().join(name), "mine").unwrap());
    remove_remains(base.path());
    assert_eq!(names(base.path()).len(), mine.len());
}
