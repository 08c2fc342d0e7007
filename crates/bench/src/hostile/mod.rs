//! Hostile runs: inputs and command lines that a seeded generator has spoiled, through the program itself.
//!
//! Each must end by itself, with exit code 0, 1 or 2, with an error in words where it fails, within the memory that files may
//! take, and a second time with the same bytes everywhere. Fuzz targets (`fuzz/`) find more in a reader; this finds what lies
//! between a file and an exit code.

mod cases;
mod chance;
mod mutate;
mod options;
mod program;
mod settings;
mod table;

pub use cases::{Case, Kind, Sources};
pub use chance::Chance;
pub use program::{Ended, Program};
pub use table::Table;

use std::path::Path;

/// Longest that a run may work before it counts as a hang \[s of the processor\]; who does nothing is waited for longer.
pub const PATIENCE_S: u64 = 20;
/// What may be resident: what files may take by default, and what the program takes by itself \[MiB\].
pub const MOST_MEBIBYTES: u64 = 1024 + 64;

/// What is wrong with a run, if anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// A panic, a signal, an exit code that means nothing, or a failure without a word.
    Crash,
    /// It did not end.
    Hang,
    /// It took more than it may.
    Memory,
    /// The second run came to something else.
    Unequal,
}

/// Runs a case twice in `folder`.
///
/// # Errors
/// What keeps it from being run at all.
pub fn run_twice(program: &Program, case: &Case, folder: &Path) -> Result<(Ended, Option<Finding>), String> {
    let first = program.run(case, folder)?;
    if let Some(finding) = judge(&first) {
        return Ok((first, Some(finding)));
    }
    let second = program.run(case, folder)?;
    let equal = first.left == second.left && first.code == second.code;
    let finding = judge(&second).or((!equal).then_some(Finding::Unequal));
    Ok((if second.mebibytes > first.mebibytes { second } else { first }, finding))
}

fn judge(run: &Ended) -> Option<Finding> {
    let said = String::from_utf8_lossy(&run.said);
    // An empty command line is answered with help.
    let in_words = run.code == 0 || said.starts_with("error: ") && said.len() > 12 || said.contains("\nUsage: basrelief");
    match run.code {
        137 => Some(Finding::Hang),
        _ if run.seconds > PATIENCE_S as f64 => Some(Finding::Hang),
        0..=2 if in_words && !said.contains("panicked") => (run.mebibytes > MOST_MEBIBYTES).then_some(Finding::Memory),
        _ => Some(Finding::Crash),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(code: i32, said: &str, mebibytes: u64) -> Ended {
        Ended { code, said: said.into(), mebibytes, seconds: 0.0, left: Default::default() }
    }

    #[test]
    fn a_run_ends_with_a_code_that_means_something_and_in_words() {
        let verdict = |code, said: &str, mebibytes| judge(&ended(code, said, mebibytes));
        assert_eq!(verdict(0, "", 10), None);
        assert_eq!(verdict(1, "error: a.gltf: nothing to draw", 10), None);
        assert_eq!(verdict(1, "", 10), Some(Finding::Crash));
        assert_eq!(verdict(2, "What it is\n\nUsage: basrelief [OPTIONS] <COMMAND>", 10), None);
        assert_eq!(verdict(101, "thread 'main' panicked at x", 10), Some(Finding::Crash));
        assert_eq!(verdict(134, "memory allocation failed", 10), Some(Finding::Crash));
        assert_eq!(verdict(137, "", 10), Some(Finding::Hang));
        assert_eq!(verdict(0, "", 2000), Some(Finding::Memory));
        assert_eq!(judge(&Ended { seconds: 21.0, ..ended(0, "", 10) }), Some(Finding::Hang));
    }

    #[test]
    fn the_same_seed_makes_the_same_cases_of_every_kind() {
        let sources = Sources::load().expect("the workspace is there");
        for kind in Kind::ALL {
            let made: Vec<Case> = (0..20).map(|n| kind.case(&sources, &mut Chance::of(7, kind as u64, n))).collect();
            let again: Vec<Case> = (0..20).map(|n| kind.case(&sources, &mut Chance::of(7, kind as u64, n))).collect();
            assert_eq!(made, again, "{kind:?}");
            assert!((1..20).any(|n| made[n] != made[0]), "{kind:?}: all the same");
        }
    }
}
