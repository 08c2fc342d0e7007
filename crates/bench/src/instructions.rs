//! Instruction counts of the small workloads by callgrind, checked against committed budgets. A count hardly depends on the load
//! of the host, so a slow-down is a failed check.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Tolerance of a count above its budget \[%\].
pub const TOLERANCE_PERCENT: u64 = 3;

/// Instruction budgets of the workloads.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstructionBudgets {
    /// Compiler of the counts, as named by `rustc --version`.
    pub compiler: String,
    /// Architecture of the counts.
    pub architecture: String,
    /// Budgets by workload.
    pub instructions: BTreeMap<String, u64>,
}

/// Result of a comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BudgetVerdict {
    /// One line per workload.
    pub lines: Vec<String>,
    /// Workloads over budget, without a budget, or no longer existing.
    pub failures: Vec<String>,
}

impl InstructionBudgets {
    /// Compares counts with the budgets.
    pub fn compare(&self, counts: &BTreeMap<String, u64>) -> BudgetVerdict {
        let mut verdict = BudgetVerdict::default();
        for (name, &count) in counts {
            let Some(&budget) = self.instructions.get(name) else {
                verdict.failures.push(format!("{name}: has no budget"));
                continue;
            };
            let percent = (count as f64 / budget as f64 - 1.0) * 100.0;
            verdict.lines.push(format!("{count:>13}  budget {budget:>13}  {percent:>+7.2} %  {name}"));
            if count * 100 > budget * (100 + TOLERANCE_PERCENT) {
                let allowed = TOLERANCE_PERCENT;
                verdict.failures.push(format!(
                    "{name}: {count} instructions, {percent:.2} % above the budget of {budget}; {allowed} % are allowed"
                ));
            }
        }
        let gone = self.instructions.keys().filter(|name| !counts.contains_key(*name));
        verdict.failures.extend(gone.map(|name| format!("{name}: has a budget, but there is no such workload")));
        verdict
    }
}

/// Returns the current compiler.
///
/// # Errors
/// Returns an error if it cannot be run.
pub fn compiler() -> Result<String, String> {
    let rustc = std::env::var("RUSTC").unwrap_or("rustc".into());
    let output = Command::new(&rustc).arg("--version").output().map_err(|e| format!("{rustc} --version: {e}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().into())
}

/// Counts the instructions of the measured part of `program count NAME`.
///
/// # Errors
/// Returns an error if valgrind is absent, fails, or counts nothing.
pub fn count(program: &Path, name: &str) -> Result<u64, String> {
    let mut callgrind = Command::new("valgrind");
    callgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*::measured*"]);
    let output = callgrind
        .arg(program)
        .args(["count", name])
        .output()
        .map_err(|e| format!("valgrind: {e}; install it (apt-get install valgrind)"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let counted = || text.lines().find_map(|line| line.split_once("Collected :")).and_then(|(_, n)| n.trim().parse().ok());
    match counted().filter(|_| output.status.success()) {
        Some(0) => Err(format!("{name}: no instruction was counted; callgrind did not find the function `measured`")),
        Some(instructions) => Ok(instructions),
        None => Err(format!("{name}: valgrind failed: {text}")),
    }
}

/// Counts all workloads on as many threads as there are cores. Counts do not influence each other.
///
/// # Errors
/// Returns the error of [`count`].
pub fn count_all(program: &Path, names: &[String]) -> Result<BTreeMap<String, u64>, String> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        let mut counts = Vec::new();
        while let Some(name) = names.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
            counts.push((name.clone(), count(program, name)?));
        }
        Ok(counts)
    };
    let parts: Result<Vec<Vec<_>>, String> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        threads.into_iter().map(|thread| thread.join().expect("counting does not panic")).collect()
    });
    Ok(parts?.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(pairs: &[(&str, u64)]) -> BTreeMap<String, u64> {
        pairs.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
    }

    #[test]
    fn only_excess_beyond_tolerance_fails() {
        let budgets = InstructionBudgets {
            instructions: counts(&[("a", 1000), ("b", 1000), ("c", 1000)]),
            ..InstructionBudgets::default()
        };
        let verdict = budgets.compare(&counts(&[("a", 1030), ("b", 1031), ("c", 500)]));
        assert_eq!(verdict.failures, ["b: 1031 instructions, 3.10 % above the budget of 1000; 3 % are allowed"]);
        assert_eq!(verdict.lines.len(), 3);
    }

    #[test]
    fn budgets_and_workloads_match() {
        let budgets = InstructionBudgets { instructions: counts(&[("gone", 1)]), ..InstructionBudgets::default() };
        let failures = budgets.compare(&counts(&[("new", 1)])).failures;
        assert_eq!(failures, ["new: has no budget", "gone: has a budget, but there is no such workload"]);
    }
}
