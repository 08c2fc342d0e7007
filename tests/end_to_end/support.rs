//! Helpers that run the program and read its outputs.

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_basrelief");

/// Time limit for a run: ten times that of the slowest run in a debug build.
const PATIENCE: Duration = Duration::from_secs(240);

/// Returns the top folder of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the workspace is there")
}

/// Returns the model of a small bumpy patch in front of a plain board. It uses both paths through the machine.
pub fn patch() -> PathBuf {
    workspace().join("tests/models/patch.gltf")
}

/// Returns the folder of foreign inputs, or prints a warning and returns `None`.
pub fn inputs(below: &str) -> Option<PathBuf> {
    let folder =
        std::env::var_os("BASRELIEF_INPUTS").map_or_else(|| workspace().join("../shared/inputs"), PathBuf::from).join(below);
    if !folder.is_dir() {
        println!("SKIPPED: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

/// Result of a run.
pub struct Outcome {
    pub status: ExitStatus,
    pub out: String,
    pub err: String,
    pub seconds: f64,
}

impl Outcome {
    /// Returns the exit code, or fails the test if a signal ended the run.
    pub fn code(&self) -> i32 {
        self.status.code().unwrap_or_else(|| panic!("ended by {}: {}", self.status, self.err))
    }

    /// Checks the exit code and returns the error message.
    pub fn error(&self, code: i32) -> &str {
        assert_eq!(self.code(), code, "{}", self.err);
        let message = self.err.strip_prefix("error: ").unwrap_or_else(|| panic!("no error message: {:?}", self.err));
        assert!(!message.contains("panicked"), "{message}");
        message
    }
}

/// A folder to work in.
pub struct Place {
    folder: TempDir,
}

impl Place {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn text(&self, name: &str) -> String {
        let path = self.path(name);
        fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.text(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Reads the report in a folder.
    pub fn report(&self, folder: &str) -> Value {
        self.json(&format!("{folder}/report.json"))
    }

    /// Returns the frame cycles in the report of this folder.
    pub fn frame_cycles(&self, folder: &str) -> u64 {
        let report = self.report(folder);
        let frames = report["cycles"]["frames"].as_array().expect("frames");
        frames.iter().map(|cycles| cycles.as_u64().expect("cycles")).sum()
    }

    /// Returns the names in the folder, including hidden ones.
    pub fn names(&self, below: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(below)).unwrap_or_else(|e| panic!("{below}: {e}"));
        let mut names: Vec<String> = entries.map(|e| e.expect("readable").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Makes a command to run in this folder. Spaces separate the arguments of the line, and `PATCH` is the small model.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(PROGRAM);
        command.current_dir(self.folder.path()).env("NO_COLOR", "1").env("COLUMNS", "100");
        command.stdin(Stdio::null());
        for word in line.split_whitespace() {
            if word == "PATCH" {
                command.arg(patch())
            } else {
                command.arg(word)
            };
        }
        command
    }

    /// Runs a command line.
    pub fn run(&self, line: &str) -> Outcome {
        finish(&mut self.command(line))
    }

    /// Runs a command line that must succeed.
    pub fn ok(&self, line: &str) -> Outcome {
        let outcome = self.run(line);
        assert_eq!(outcome.code(), 0, "{line}: {}", outcome.err);
        outcome
    }

    /// Runs a command line with files limited to 1 KiB, which acts like a full disk and needs no privileges.
    #[cfg(unix)]
    pub fn on_a_full_disk(&self, line: &str) -> Outcome {
        let limited = self.command(line);
        let mut shell = Command::new("sh");
        shell.arg("-c").arg("ulimit -f 1; \"$0\" \"$@\" >/dev/null").arg(PROGRAM).args(limited.get_args());
        finish(shell.current_dir(self.path("")).stdin(Stdio::null()))
    }

    /// Runs a command line that must succeed, with standard input from a file.
    pub fn ok_from(&self, input: &str, line: &str) -> Outcome {
        let input = File::open(self.path(input)).expect("input");
        let outcome = finish(self.command(line).stdin(input));
        assert_eq!(outcome.code(), 0, "{line}: {}", outcome.err);
        outcome
    }
}

/// Runs a command to its end, within [`PATIENCE`].
pub fn finish(command: &mut Command) -> Outcome {
    // Files need no reader while the program runs, unlike pipes.
    let streams = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| streams.path().join(name);
    let create = |name: &str| File::create(file(name)).expect("a temporary file");
    let began = Instant::now();
    let mut child = command.stdout(create("out")).stderr(create("err")).spawn().expect("the program starts");
    let status = wait(&mut child, PATIENCE).unwrap_or_else(|| panic!("{command:?} hangs"));
    let read = |name: &str| String::from_utf8_lossy(&fs::read(file(name)).expect("output")).into_owned();
    Outcome { status, out: read("out"), err: read("err"), seconds: began.elapsed().as_secs_f64() }
}

/// Waits for the end of a process, or kills it.
pub fn wait(child: &mut Child, patience: Duration) -> Option<ExitStatus> {
    let began = Instant::now();
    while began.elapsed() < patience {
        if let Some(status) = child.try_wait().expect("a child") {
            return Some(status);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().expect("a child");
    child.wait().expect("a child");
    None
}

/// Returns a picture's size and the SHA-256 of its RGB8 rows.
pub fn picture(path: &Path) -> (u32, u32, String) {
    let picture = image::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).into_rgb8();
    (picture.width(), picture.height(), sha256(picture.as_raw()))
}

pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// Checks a report against its schema.
pub fn is_valid(report: &Value, place: &Place) {
    let schema: Value = serde_json::from_str(&place.ok("schema report").out).expect("a schema");
    let validator = jsonschema::validator_for(&schema).expect("a valid schema");
    let wrong: Vec<String> = validator.iter_errors(report).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Returns a report without the host's figures.
pub fn without_host(mut report: Value) -> Value {
    report.as_object_mut().expect("a report").remove("host").expect("host figures");
    report
}
