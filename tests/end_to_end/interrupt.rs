//! Signals at any time: the exit code is 128 plus the number of the signal, and no unfinished output remains.

use crate::support::{Place, wait};
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

const SOON: Duration = Duration::from_secs(10);

/// Returns the command with the default action for SIGHUP. A test that runs under `nohup` would pass on its ignored signal.
#[cfg(target_os = "linux")]
fn hang_up_ends(command: &Command) -> Command {
    let mut wrapped = Command::new("env");
    wrapped.arg("--default-signal=HUP").arg(command.get_program()).args(command.get_args());
    wrapped.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    wrapped.current_dir(command.get_current_dir().expect("a folder"));
    wrapped
}

#[cfg(not(target_os = "linux"))]
fn hang_up_ends(command: &Command) -> Command {
    let mut same = Command::new(command.get_program());
    same.args(command.get_args()).current_dir(command.get_current_dir().expect("a folder"));
    same
}

fn start(place: &Place, line: &str, stdin: Stdio) -> Child {
    hang_up_ends(&place.command(line))
        .stdin(stdin)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
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

/// Sends the signal and checks for its exit code.
fn interrupt(child: &mut Child, signal: &str) {
    let code = match signal {
        "-INT" => 130,
        "-TERM" => 143,
        _ => 129,
    };
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    assert!(sent.success(), "the program had ended before");
    let status = wait(child, SOON).expect("ends soon");
    assert_eq!(status.code(), Some(code), "{status}");
}

/// Returns true if the folder contains, at any depth, a file or folder with this text in its name.
fn has(folder: &PathBuf, part: &str) -> bool {
    fs::read_dir(folder).is_ok_and(|mut entries| {
        entries.any(|e| {
            e.is_ok_and(|e| e.file_name().to_string_lossy().contains(part) || (e.path().is_dir() && has(&e.path(), part)))
        })
    })
}

#[test]
fn interrupted_run_leaves_no_files_or_folders() {
    let place = Place::new();
    let line = "run PATCH --size 64x48 --frames 3000 --orbit 360 --out new/out --timeline line.pftrace";
    let mut child = start(&place, line, Stdio::null());
    wait_until("pictures", || has(&place.path("new"), "image-0002"));
    interrupt(&mut child, "-INT");
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
}

#[test]
fn interrupted_run_keeps_earlier_results() {
    let place = Place::new();
    place.ok("run PATCH --size 16x12");
    let before = place.text("out/report.json");
    let mut child = start(&place, "run PATCH --size 64x48 --frames 3000", Stdio::null());
    wait_until("pictures", || has(&place.path("out"), "image-0001"));
    interrupt(&mut child, "-TERM");
    assert_eq!(place.names("out"), ["difference.png", "image.png", "reference.png", "report.json", "run.recording"]);
    assert_eq!(place.text("out/report.json"), before);
}

#[test]
fn silent_input_pipe_can_be_interrupted() {
    let place = Place::new();
    for line in ["run - --out new", "convert - t.bdl"] {
        let mut child = start(&place, line, Stdio::piped());
        wait_until("a start", || has(&place.path(""), ".partial"));
        interrupt(&mut child, "-HUP");
        assert!(place.names("").is_empty(), "{line}: {:?}", place.names(""));
    }
}

#[test]
fn interrupted_record_leaves_no_files() {
    let place = Place::new();
    let mut child = start(&place, "record PATCH --frames 100000 --orbit 360 --out t.jsonl", Stdio::null());
    wait_until("a start", || has(&place.path(""), ".partial"));
    interrupt(&mut child, "-INT");
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
}

#[test]
fn closed_standard_error_does_not_block_signals() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        for line in [
            "run PATCH --size 64x48 --frames 3000",
            "record PATCH --frames 100000 --orbit 360 --out t.jsonl",
            "serve PATCH --listen 127.0.0.1:0",
            "run - --out new",
        ] {
            let place = Place::new();
            let mut child = hang_up_ends(&place.command(line))
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            drop(child.stderr.take());
            if line.starts_with("serve") {
                let mut first = String::new();
                BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut first).unwrap();
            } else {
                wait_until("a start", || has(&place.path(""), ".partial"));
            }
            interrupt(&mut child, signal);
        }
    }
}

#[test]
fn closed_standard_error_keeps_the_exit_code() {
    let place = Place::new();
    for (line, code) in [("run missing.glb", 1), ("demo teapot", 2), ("retime missing", 1)] {
        let mut child = place.command(line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stderr.take());
        assert_eq!(wait(&mut child, SOON).expect("ends soon").code(), Some(code), "{line}");
    }
}
