//! The program, run in a folder of its own, with time and memory measured.

use super::samples::HostileCase;
use super::server::HostileServer;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Processor time after which a run counts as a hang \[s\]. Idle runs are given more time.
pub const PATIENCE_S: u64 = 20;

/// Program under test.
#[derive(Clone, Debug)]
pub struct TestedProgram {
    path: PathBuf,
    server: HostileServer,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// Exit code. For a signal it is 128 plus its number.
    pub code: i32,
    /// Standard error.
    pub said: Vec<u8>,
    /// Largest resident memory.
    pub mebibytes: u64,
    /// Processor time used, because elapsed time means little on a busy host.
    pub seconds: f64,
    /// Files and streams by name, without host data.
    pub left: BTreeMap<String, Vec<u8>>,
}

/// Factor between the limit of elapsed time and that of processor time.
const BUSY: u64 = 12;
/// File in which GNU time writes its measurements, beside the folder of the run.
const MEASURED: &str = "measured";

impl TestedProgram {
    /// Creates a program at a path.
    ///
    /// # Errors
    /// Returns an error if the program, or its measuring tool, does not exist.
    pub fn new(path: &Path, server: HostileServer) -> Result<Self, String> {
        let path = path.canonicalize().map_err(|e| format!("{}: {e}", path.display()))?;
        for tool in ["time", "timeout"] {
            let there = Command::new(tool).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            there.map_err(|e| format!("{tool}: {e}; install GNU time and coreutils (apt-get install time coreutils)"))?;
        }
        Ok(Self { path, server })
    }

    /// Runs a case in a folder that is emptied first.
    ///
    /// # Errors
    /// Returns an error if the case cannot be run.
    pub fn run(&self, case: &HostileCase, folder: &Path) -> Result<RunResult, String> {
        let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
        let inside = folder.join("in");
        let measured = folder.join(MEASURED);
        if folder.exists() {
            fs::remove_dir_all(folder).map_err(failed)?;
        }
        fs::create_dir_all(&inside).map_err(failed)?;
        case.files.iter().try_for_each(|(name, bytes)| fs::write(inside.join(name), bytes)).map_err(failed)?;
        case.served.iter().for_each(|answers| self.server.set(answers));
        let url = self.server.url();
        let arguments = case.arguments.iter().map(|word| if word == "SERVER" { &url } else { word });
        // `timeout` ends the program itself. A kill from here would leave it behind.
        let output = Command::new("time")
            .args(["--quiet", "-f", "%M %U %S", "-o"])
            .arg(&measured)
            .args(["timeout", "-s", "KILL", &(BUSY * PATIENCE_S).to_string()])
            .arg(&self.path)
            .args(arguments)
            .current_dir(&inside)
            .env("NO_COLOR", "1")
            .env("COLUMNS", "100")
            .stdin(Stdio::null())
            .output()
            .map_err(|e| format!("time: {e}"))?;
        let mut left = BTreeMap::new();
        collect(&inside, "", &mut left).map_err(failed)?;
        left.insert("standard output".into(), without_host(&output.stdout));
        left.insert("standard error".into(), output.stderr.clone());
        let [kibibytes, user, system] = measured_in(&fs::read_to_string(&measured).map_err(failed)?)
            .ok_or("time: does not say how much memory and time was used: GNU time is needed")?;
        let (mebibytes, seconds) = ((kibibytes as u64).div_ceil(1024), user + system);
        Ok(RunResult { code: output.status.code().unwrap_or(-1), said: output.stderr, mebibytes, seconds, left })
    }
}

/// Returns the numbers in the last line of the output of GNU time.
fn measured_in(text: &str) -> Option<[f64; 3]> {
    let numbers = text.lines().last()?.split(' ').map(str::parse);
    numbers.collect::<Result<Vec<f64>, _>>().ok()?.try_into().ok()
}

fn collect(folder: &Path, prefix: &str, into: &mut BTreeMap<String, Vec<u8>>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let (entry, name) = entry.map(|e| (e.path(), format!("{prefix}{}", e.file_name().to_string_lossy())))?;
        if entry.is_dir() {
            collect(&entry, &format!("{name}/"), into)?;
        } else {
            into.insert(name, without_host(&fs::read(&entry)?));
        }
    }
    Ok(())
}

/// Removes host data from a report, in JSON, as a table and as text.
fn without_host(bytes: &[u8]) -> Vec<u8> {
    if let Ok(Value::Object(mut report)) = serde_json::from_slice::<Value>(bytes) {
        report.remove("host");
        return Value::Object(report).to_string().into_bytes();
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => {
            let of_host = |line: &&str| ["Simulated in ", "Real path: ", "host,"].iter().any(|start| line.starts_with(start));
            let kept = text.lines().filter(|line| !of_host(line));
            kept.flat_map(|line| [line, "\n"]).collect::<String>().into_bytes()
        }
        Err(_) => bytes.to_vec(),
    }
}
