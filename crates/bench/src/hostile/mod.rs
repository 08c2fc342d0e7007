//! Hostile runs: inputs and command lines damaged by a seeded generator, run through the program itself.
//!
//! Each run must end by itself, with exit code 0, 1 or 2, with an error message if it fails, and within the memory limit of
//! files. A second run must write the same bytes. Fuzz targets (`fuzz/`) find more in a reader. This driver tests the path
//! between a file and an exit code.

mod cases;
mod mutate;
mod options;
mod program;
mod random;
mod samples;
mod scripts;
mod server;
mod settings;
mod table;

pub use cases::InputKind;
pub use program::{PATIENCE_S, RunResult, TestedProgram};
pub use random::random_of;
pub use samples::{HostileCase, SampleInputs};
pub use server::{HostileServer, SampleScene};
pub use table::RunTable;

use std::path::Path;

/// Maximum resident memory \[MiB\]: the default limit for files, and the program's own memory.
pub const MOST_MEBIBYTES: u64 = 1024 + 64;

/// Fault of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunFault {
    /// A panic, a signal, an undefined exit code, or a failure without a message.
    Crash,
    /// The run did not end.
    Hang,
    /// The run exceeded its memory.
    Memory,
    /// The second run had other results.
    Unequal,
}

/// Runs a case in `folder`, and once more if its results are to be compared.
///
/// # Errors
/// Returns an error if the case cannot be run.
pub fn run_case(
    program: &TestedProgram,
    case: &HostileCase,
    folder: &Path,
    compares: bool,
) -> Result<(RunResult, Option<RunFault>), String> {
    let first = program.run(case, folder)?;
    let finding = judge(&first);
    if finding.is_some() || !compares {
        return Ok((first, finding));
    }
    let second = program.run(case, folder)?;
    let equal = first.left == second.left && first.code == second.code;
    let finding = judge(&second).or((!equal).then_some(RunFault::Unequal));
    Ok((if second.mebibytes > first.mebibytes { second } else { first }, finding))
}

fn judge(run: &RunResult) -> Option<RunFault> {
    let said = String::from_utf8_lossy(&run.said);
    // An empty command line prints help.
    let in_words = run.code == 0 || said.starts_with("error: ") && said.len() > 12 || said.contains("\nUsage: basrelief");
    match run.code {
        137 => Some(RunFault::Hang),
        _ if run.seconds > PATIENCE_S as f64 => Some(RunFault::Hang),
        0..=2 if in_words && !said.contains("panicked") => (run.mebibytes > MOST_MEBIBYTES).then_some(RunFault::Memory),
        _ => Some(RunFault::Crash),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(code: i32, said: &str, mebibytes: u64) -> RunResult {
        RunResult { code, said: said.into(), mebibytes, seconds: 0.0, left: Default::default() }
    }

    #[test]
    fn run_must_end_with_defined_code_and_message() {
        let verdict = |code, said: &str, mebibytes| judge(&ended(code, said, mebibytes));
        assert_eq!(verdict(0, "", 10), None);
        assert_eq!(verdict(1, "error: a.gltf: nothing to draw", 10), None);
        assert_eq!(verdict(1, "", 10), Some(RunFault::Crash));
        assert_eq!(verdict(2, "What it is\n\nUsage: basrelief [OPTIONS] <COMMAND>", 10), None);
        assert_eq!(verdict(101, "thread 'main' panicked at x", 10), Some(RunFault::Crash));
        assert_eq!(verdict(134, "memory allocation failed", 10), Some(RunFault::Crash));
        assert_eq!(verdict(137, "", 10), Some(RunFault::Hang));
        assert_eq!(verdict(0, "", 2000), Some(RunFault::Memory));
        assert_eq!(judge(&RunResult { seconds: 21.0, ..ended(0, "", 10) }), Some(RunFault::Hang));
    }

    #[test]
    fn same_seed_creates_same_cases() {
        let sources = SampleInputs::load().expect("the workspace is there");
        for kind in InputKind::ALL {
            let made: Vec<HostileCase> = (0..20).map(|n| kind.case(&sources, &mut random_of(7, kind as u64, n))).collect();
            let again: Vec<HostileCase> = (0..20).map(|n| kind.case(&sources, &mut random_of(7, kind as u64, n))).collect();
            assert_eq!(made, again, "{kind:?}");
            assert!((1..20).any(|n| made[n] != made[0]), "{kind:?}: all the same");
        }
    }
}
