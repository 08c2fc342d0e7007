//! Ratios, instruction counts, long traces. The crate documentation lists the commands.

use basrelief_bench::instructions::{InstructionBudgets, compiler, count_all};
use basrelief_bench::ratios::{TimeRatio, ratios};
use basrelief_bench::workload::WorkloadSize;
use basrelief_bench::{traces, workloads};
use std::fs;
use std::path::Path;

const USAGE: &str = "usage: measure ratios [--rounds N] [--json FILE] | instructions [--bless] | trace POLYGONS";
/// Path of the budgets.
const BUDGETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/budgets.json");
const ROUNDS: usize = 15;

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["ratios", ref options @ ..] => compare(options),
        ["instructions"] => check(),
        ["instructions", "--bless"] => bless(),
        ["count", name] => run(name),
        ["trace", polygons] => generate(polygons),
        _ => Err(USAGE.into()),
    }
}

fn compare(options: &[&str]) -> Result<(), String> {
    let (mut rounds, mut file) = (ROUNDS, None);
    for option in options.chunks(2) {
        match *option {
            ["--rounds", n] => rounds = n.parse().ok().filter(|n| *n > 0).ok_or("--rounds: expected a number above 0")?,
            ["--json", path] => file = Some(path),
            _ => return Err(USAGE.into()),
        }
    }
    println!("medians of {rounds} pairs of runs in turn, quartiles, ns per fragment or byte of each");
    let all: Vec<TimeRatio> = ratios(WorkloadSize::Full, rounds, |r| {
        println!("{:<52} {:>6.3}  {:>6.3} .. {:<6.3} {:>8.2} {:>8.2}", r.name, r.median, r.low, r.high, r.ns[0], r.ns[1]);
    });
    file.map_or(Ok(()), |path| write_json(path, &all))
}

fn write_json(path: &str, value: &impl serde::Serialize) -> Result<(), String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| e.to_string())?;
    fs::write(path, text + "\n").map_err(|e| format!("{path}: {e}"))
}

/// Returns the budgets with the counts of this build.
fn counted() -> Result<InstructionBudgets, String> {
    let names: Vec<String> = workloads(WorkloadSize::Small).into_iter().map(|w| w.name).collect();
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let instructions = count_all(Path::new(&program), &names)?;
    Ok(InstructionBudgets { compiler: compiler()?, architecture: std::env::consts::ARCH.into(), instructions })
}

fn check() -> Result<(), String> {
    let text = fs::read_to_string(BUDGETS).map_err(|e| format!("{BUDGETS}: {e}"))?;
    let budgets: InstructionBudgets = serde_json::from_str(&text).map_err(|e| format!("{BUDGETS}: {e}"))?;
    let (here, of) = ((compiler()?, std::env::consts::ARCH), (budgets.compiler.clone(), budgets.architecture.as_str()));
    if here != of {
        println!(
            "!!! SKIPPED: budgets hold for {} on {}, this is {} on {}: `instructions --bless` makes new ones",
            of.0, of.1, here.0, here.1
        );
        return Ok(());
    }
    let verdict = budgets.compare(&counted()?.instructions);
    verdict.lines.iter().for_each(|line| println!("{line}"));
    if verdict.failures.is_empty() {
        return Ok(());
    }
    verdict.failures.iter().for_each(|failure| println!("OVER BUDGET: {failure}"));
    Err(format!(
        "{} workloads are over budget; make them faster, or justify new budgets: `instructions --bless`",
        verdict.failures.len()
    ))
}

fn bless() -> Result<(), String> {
    write_json(BUDGETS, &counted()?)
}

/// Runs a workload for callgrind. It uses one thread, because the division of work between several threads varies.
fn run(name: &str) -> Result<(), String> {
    basrelief_threads::disable_threads();
    let found = workloads(WorkloadSize::Small).into_iter().find(|w| w.name == name);
    found.ok_or_else(|| format!("no workload is called `{name}`"))?.prepare()();
    Ok(())
}

fn generate(polygons: &str) -> Result<(), String> {
    let polygons = polygons.parse().map_err(|_| format!("{polygons}: expected a number of polygons"))?;
    traces::generate(polygons, std::io::stdout().lock()).map_err(|e| e.to_string())
}
