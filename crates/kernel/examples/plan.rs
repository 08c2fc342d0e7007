//! Runs a plan and prints the result as canonical JSON: `plan PLAN.json [--engine timed|ticked]`.
//!
//! With a folder instead of a file, every `*.json` in it must be a `{"plan", "result"}` vector; each is run with both
//! engines and compared, and the exit code is 1 if any differs.

use basrelief_kernel::plan::{Plan, PlanMachine, result};
use basrelief_kernel::{Engine, run};
use serde_json::Value;
use std::{error::Error, fs, path::Path, process::ExitCode};

fn simulate(plan: &Plan, engine: Engine) -> Result<Value, String> {
    Ok(result(&run(&mut PlanMachine::new(plan)?, engine)))
}

/// Compares every vector of a folder; returns how many agree and how many differ.
fn compare(folder: &Path) -> Result<(usize, usize), Box<dyn Error>> {
    let (mut same, mut different) = (0, 0);
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_none_or(|e| e != "json") {
            continue;
        }
        let vector: Value = serde_json::from_slice(&fs::read(&path)?)?;
        let plan: Plan = serde_json::from_value(vector["plan"].clone())?;
        for engine in [Engine::Timed, Engine::Ticked] {
            if simulate(&plan, engine)? == vector["result"] {
                same += 1;
            } else {
                different += 1;
                println!("{}: {engine:?} differs", path.display());
            }
        }
    }
    Ok((same, different))
}

/// JSON with a space after each comma and colon, as Python writes it.
struct Spaced;
impl serde_json::ser::Formatter for Spaced {
    fn begin_object_key<W: ?Sized + std::io::Write>(&mut self, w: &mut W, first: bool) -> std::io::Result<()> {
        w.write_all(if first { b"" } else { b", " })
    }
    fn begin_object_value<W: ?Sized + std::io::Write>(&mut self, w: &mut W) -> std::io::Result<()> {
        w.write_all(b": ")
    }
    fn begin_array_value<W: ?Sized + std::io::Write>(&mut self, w: &mut W, first: bool) -> std::io::Result<()> {
        w.write_all(if first { b"" } else { b", " })
    }
}

fn print(value: &Value) -> Result<(), Box<dyn Error>> {
    let mut bytes = Vec::new();
    serde::Serialize::serialize(value, &mut serde_json::Serializer::with_formatter(&mut bytes, Spaced))?;
    println!("{}", String::from_utf8(bytes)?);
    Ok(())
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let engine = match arguments.iter().position(|a| a == "--engine").and_then(|i| arguments.get(i + 1)).map(String::as_str) {
        None | Some("timed") => Engine::Timed,
        Some("ticked") => Engine::Ticked,
        Some(other) => return Err(format!("--engine {other}: expected timed or ticked").into()),
    };
    let Some(path) = arguments.first().map(Path::new) else {
        return Err("usage: plan PLAN.json [--engine timed|ticked], or plan FOLDER".into());
    };
    if path.is_dir() {
        let (same, different) = compare(path)?;
        println!("{same} passed, {different} failed");
        return Ok(if different == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    let plan: Plan = serde_json::from_slice(&fs::read(path)?)?;
    print(&simulate(&plan, engine)?)?;
    Ok(ExitCode::SUCCESS)
}
