//! Hostile runs of the program: `hostile PROGRAM [--cases N] [--seed S]` prints a table in Markdown, and fails if there is any
//! finding. Every fourth case runs twice, and its results are compared. Findings are stored in `target/hostile-findings/`.

use basrelief_bench::hostile::{
    HostileCase, HostileServer, InputKind, RunTable, SampleInputs, TestedProgram, random_of, run_case,
};
use std::fs;
use std::path::{Path, PathBuf};

const USAGE: &str = "usage: hostile PROGRAM [--cases N] [--seed S]";
/// Default number of cases of each kind.
const CASES: u64 = 400;
/// Time above which a run is reported \[s\]. It is no fault by itself, because the host may have been busy.
const SLOW_S: f64 = 5.0;
/// One of so many cases runs twice.
const COMPARED: u64 = 4;
const FINDINGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/hostile-findings");

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [program, options @ ..] = &arguments[..] else { return Err(USAGE.into()) };
    let (mut cases, mut seed) = (CASES, 1);
    for option in options.chunks(2) {
        let [name, number] = option else { return Err(USAGE.into()) };
        let number = number.parse().map_err(|_| format!("{name}: expected a number"))?;
        match name.as_str() {
            "--cases" => cases = number,
            "--seed" => seed = number,
            _ => return Err(USAGE.into()),
        }
    }
    let sources = SampleInputs::load()?;
    let program = TestedProgram::new(Path::new(program), HostileServer::start(sources.sample_scene().clone())?)?;
    let folder = std::env::temp_dir().join(format!("basrelief-hostile-{}", std::process::id()));
    let (mut table, mut found) = (RunTable::default(), 0);
    for kind in InputKind::ALL {
        for number in 0..cases {
            let case = kind.case(&sources, &mut random_of(seed, kind as u64, number));
            let (run, finding) = run_case(&program, &case, &folder, number % COMPARED == 0)?;
            table.add(kind, &run, finding, number % COMPARED == 0);
            if run.seconds > SLOW_S {
                eprintln!("{:.1} s: {}", run.seconds, keep(kind, number, &case)?.display());
            }
            if let Some(finding) = finding {
                found += 1;
                eprintln!("{finding:?}: {}", keep(kind, number, &case)?.display());
            }
        }
    }
    fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    print!("{table}");
    if found == 0 { Ok(()) } else { Err(format!("{found} findings; {FINDINGS} holds them")) }
}

/// Stores the files of a case, and its command line.
fn keep(kind: InputKind, number: u64, case: &HostileCase) -> Result<PathBuf, String> {
    let folder = Path::new(FINDINGS).join(format!("{kind:?}-{number}"));
    let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
    fs::create_dir_all(&folder).map_err(failed)?;
    case.files.iter().try_for_each(|(name, bytes)| fs::write(folder.join(name), bytes)).map_err(failed)?;
    if let Some(served) = &case.served {
        fs::write(folder.join("served-scene"), &served.scene).map_err(failed)?;
        fs::write(folder.join("served-seed"), served.seed.to_string()).map_err(failed)?;
    }
    fs::write(folder.join("command-line"), case.arguments.join(" ") + "\n").map_err(failed)?;
    Ok(folder)
}
