//! Results of the runs as a table in Markdown.

use super::cases::InputKind;
use super::{RunFault, RunResult};
use std::fmt::{self, Display, Formatter};

/// One row per kind, and one for all.
#[derive(Clone, Debug, Default)]
pub struct RunTable(Vec<(&'static str, Row)>);

#[derive(Clone, Copy, Debug, Default)]
struct Row {
    runs: u64,
    compared: u64,
    /// Counts by exit code.
    codes: [u64; 3],
    crashes: u64,
    hangs: u64,
    over: u64,
    unequal: u64,
    mebibytes: u64,
    seconds: f64,
}

impl RunTable {
    /// Counts a case.
    pub fn add(&mut self, kind: InputKind, run: &RunResult, finding: Option<RunFault>, compared: bool) {
        for name in [kind.name(), "all"] {
            let row = self.row(name);
            row.runs += 1;
            row.compared += u64::from(compared);
            if let Some(count) = usize::try_from(run.code).ok().and_then(|code| row.codes.get_mut(code)) {
                *count += 1;
            }
            match finding {
                Some(RunFault::Crash) => row.crashes += 1,
                Some(RunFault::Hang) => row.hangs += 1,
                Some(RunFault::Memory) => row.over += 1,
                Some(RunFault::Unequal) => row.unequal += 1,
                None => {}
            }
            row.mebibytes = row.mebibytes.max(run.mebibytes);
            row.seconds = row.seconds.max(run.seconds);
        }
    }

    fn row(&mut self, name: &'static str) -> &mut Row {
        // The row of all is last.
        let at = self.0.iter().position(|(n, _)| *n == name).unwrap_or_else(|| {
            let at = self.0.len() - usize::from(self.0.last().is_some_and(|(n, _)| *n == "all"));
            self.0.insert(at, (name, Row::default()));
            at
        });
        &mut self.0[at].1
    }
}

impl Display for RunTable {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| damaged input | inputs | of these run twice | exit code 0 | 1 | 2 | panics, signals | hangs | over memory | \
             second run differs | largest memory MiB | longest run, s |"
        )?;
        writeln!(f, "|---|{}", "---:|".repeat(11))?;
        for (name, row) in &self.0 {
            let Row { runs, compared, codes: [done, bad, usage], crashes, hangs, over, unequal, mebibytes, seconds } = row;
            writeln!(
                f,
                "| {name} | {runs} | {compared} | {done} | {bad} | {usage} | {crashes} | {hangs} | {over} | {unequal} | {mebibytes} | {seconds:.2} |"
            )?;
        }
        Ok(())
    }
}
