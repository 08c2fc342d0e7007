//! The program, run in a folder of its own, with time and memory measured.

use super::PATIENCE_S;
use super::cases::Case;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The program under test.
#[derive(Clone, Debug)]
pub struct Program(PathBuf);

/// How a run has ended.
#[derive(Clone, Debug)]
pub struct Ended {
    /// Exit code; of a signal, 128 and its number.
    pub code: i32,
    /// Standard error.
    pub said: Vec<u8>,
    /// Largest resident memory.
    pub mebibytes: u64,
    /// Time of the processor that it took: on a busy host the clock says little.
    pub seconds: f64,
    /// What it has left: files and streams by name, without what is of the host.
    pub left: BTreeMap<String, Vec<u8>>,
}

/// How much longer the clock may run than a program may work.
const BUSY: u64 = 12;
/// Where GNU time writes what it measures; beside the folder of the run.
const MEASURED: &str = "measured";

impl Program {
    /// The program at a path.
    ///
    /// # Errors
    /// It is not there, or what measures it is not.
    pub fn new(path: &Path) -> Result<Self, String> {
        let path = path.canonicalize().map_err(|e| format!("{}: {e}", path.display()))?;
        for tool in ["time", "timeout"] {
            let there = Command::new(tool).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            there.map_err(|e| format!("{tool}: {e}; install GNU time and coreutils (apt-get install time coreutils)"))?;
        }
        Ok(Self(path))
    }

    /// Runs a case in a folder, emptied before.
    ///
    /// # Errors
    /// What keeps it from being run at all.
    pub fn run(&self, case: &Case, folder: &Path) -> Result<Ended, String> {
        let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
        let inside = folder.join("in");
        let measured = folder.join(MEASURED);
        if folder.exists() {
            fs::remove_dir_all(folder).map_err(failed)?;
        }
        fs::create_dir_all(&inside).map_err(failed)?;
        case.files.iter().try_for_each(|(name, bytes)| fs::write(inside.join(name), bytes)).map_err(failed)?;
        // `timeout` ends the program itself; killed from here, the one between would leave it behind.
        let output = Command::new("time")
            .args(["--quiet", "-f", "%M %U %S", "-o"])
            .arg(&measured)
            .args(["timeout", "-s", "KILL", &(BUSY * PATIENCE_S).to_string()])
            .arg(&self.0)
            .args(&case.arguments)
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
        Ok(Ended { code: output.status.code().unwrap_or(-1), said: output.stderr, mebibytes, seconds, left })
    }
}

/// The numbers in the last line of what GNU time has written.
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

/// A report without what it says of the host, in JSON, as a table and as text.
fn without_host(bytes: &[u8]) -> Vec<u8> {
    if let Ok(Value::Object(mut report)) = serde_json::from_slice::<Value>(bytes) {
        report.remove("host");
        return Value::Object(report).to_string().into_bytes();
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => {
            let kept = text.lines().filter(|line| !line.starts_with("Simulated in ") && !line.starts_with("host,"));
            kept.flat_map(|line| [line, "\n"]).collect::<String>().into_bytes()
        }
        Err(_) => bytes.to_vec(),
    }
}
