//! Ctrl-C at any time: exit code 130, and nothing is left.

use crate::support::{Place, wait};
use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

const SOON: Duration = Duration::from_secs(10);

fn start(place: &Place, line: &str, stdin: Stdio) -> Child {
    place.command(line).stdin(stdin).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

fn wait_until(what: &str, happens: impl Fn() -> bool) {
    for _ in 0..5000 {
        if happens() {
            return;
        }
        sleep(Duration::from_millis(2));
    }
    panic!("never: {what}");
}

/// Sends the signal, and expects the exit code.
fn interrupt(child: &mut Child, signal: &str) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    assert!(sent.success(), "the program had ended before");
    let status = wait(child, SOON).expect("ends soon");
    assert_eq!(status.code(), Some(130), "{status}");
}

/// Whether there is a file or folder with this in its name, at any depth.
fn has(folder: &PathBuf, part: &str) -> bool {
    fs::read_dir(folder).is_ok_and(|mut entries| {
        entries.any(|e| {
            e.is_ok_and(|e| e.file_name().to_string_lossy().contains(part) || (e.path().is_dir() && has(&e.path(), part)))
        })
    })
}

#[test]
fn a_long_run_leaves_nothing_not_even_the_folders_made_for_it() {
    let place = Place::new();
    let line = "run PATCH --size 64x48 --frames 3000 --orbit 360 --out new/out --timeline line.pftrace";
    let mut child = start(&place, line, Stdio::null());
    wait_until("pictures", || has(&place.path("new"), "image-0002"));
    interrupt(&mut child, "-INT");
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
}

#[test]
fn results_of_an_earlier_run_stay() {
    let place = Place::new();
    place.ok("run PATCH --size 16x12");
    let before = place.text("out/report.json");
    let mut child = start(&place, "run PATCH --size 64x48 --frames 3000", Stdio::null());
    wait_until("pictures", || has(&place.path("out"), "image-0001"));
    interrupt(&mut child, "-TERM");
    assert_eq!(place.names("out"), ["difference.png", "image.png", "reference.png", "report.json", "run.tape"]);
    assert_eq!(place.text("out/report.json"), before);
}

#[test]
fn a_pipe_into_which_nobody_writes_does_not_hold_it_up() {
    let place = Place::new();
    for line in ["run - --out new", "convert - t.bdl"] {
        let mut child = start(&place, line, Stdio::piped());
        wait_until("a start", || has(&place.path(""), ".partial"));
        interrupt(&mut child, "-INT");
        assert!(place.names("").is_empty(), "{line}: {:?}", place.names(""));
    }
}

#[test]
fn a_long_recording_leaves_nothing() {
    let place = Place::new();
    let mut child = start(&place, "record PATCH --frames 100000 --orbit 360 --out t.jsonl", Stdio::null());
    wait_until("a start", || has(&place.path(""), ".partial"));
    interrupt(&mut child, "-INT");
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
}
