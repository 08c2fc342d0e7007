//! Runs a plan and prints the result as canonical JSON: `plan PLAN.json [--engine timed|ticked]`.
//!
//! With a folder instead of a file, every `*.json` in it must be a `{"plan", "result"}` vector. Both engines run each vector, and a
//! recording made with deeper FIFOs is resimulated. The exit code is 1 if any result differs.

use basrelief_kernel::{Engine, Netlist, RunLimits, resimulate, run, run_recorded};
use basrelief_kernel_conformance::plan::{Plan, PlanMachine, result};
use serde_json::Value;
use serde_json::ser::Formatter;
use std::borrow::Cow;
use std::io::{Result as Written, Write};
use std::{fs, path::Path, process::ExitCode};

const USAGE: &str = "usage: plan PLAN.json [--engine timed|ticked], or plan FOLDER";

/// Size of a chunk of a recording \[bytes\]: small, so that most recordings have several.
const CHUNK_BYTES: usize = 256;

fn simulate(plan: &Plan, engine: Engine) -> Result<Value, String> {
    let mut machine = PlanMachine::new(plan).map_err(|e| e.to_string())?;
    Ok(result(&run(&mut machine, engine)))
}

/// Records the plan with deeper FIFOs, and computes the timing of the recording with the depths of the plan.
fn resimulated(plan: &Plan) -> Result<Value, String> {
    let mut deeper = plan.clone();
    deeper.fifos.iter_mut().for_each(|fifo| fifo.depth += 1);
    let machine = |plan: &Plan| PlanMachine::new(plan).map_err(|e| e.to_string());
    let mut chunks = Vec::new();
    let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_: &mut PlanMachine| true };
    run_recorded(&mut machine(&deeper)?, Engine::Timed, None, limits, CHUNK_BYTES, &mut |chunk| chunks.push(chunk));
    let shape = Netlist::of(&mut machine(plan)?).map_err(|e| e.to_string())?;
    let mut chunks = chunks.iter().map(Cow::Borrowed);
    let report = resimulate(shape, &mut |_| Ok(chunks.next()), u64::MAX);
    Ok(result(&report.map_err(|e| e.to_string())?))
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| e.to_string())
}

fn parse_plan(text: &str) -> Result<Plan, String> {
    serde_json::from_str(text).map_err(|e| format!("not a plan: {e}"))
}

/// A way to the result of a plan.
type Method = (&'static str, fn(&Plan) -> Result<Value, String>);

const METHODS: [Method; 3] = [
    ("timed", |plan| simulate(plan, Engine::Timed)),
    ("ticked", |plan| simulate(plan, Engine::Ticked)),
    ("resimulation", resimulated),
];

/// Computes the result of a vector. Returns true if it equals the stored result.
fn agrees(text: &str, compute: fn(&Plan) -> Result<Value, String>) -> Result<bool, String> {
    let not = |e: serde_json::Error| format!("not a {{\"plan\", \"result\"}} vector: {e}");
    let vector: Value = serde_json::from_str(text).map_err(not)?;
    let plan: Plan = serde_json::from_value(vector["plan"].clone()).map_err(not)?;
    Ok(compute(&plan)? == vector["result"])
}

/// Compares every vector of a folder, in order of name. Returns the number of equal and of different results.
fn compare(folder: &Path) -> Result<(usize, usize), String> {
    let entries = fs::read_dir(folder).map_err(|e| e.to_string())?;
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "json"));
    paths.sort();
    let (mut same, mut different) = (0, 0);
    for path in paths {
        let text = read(&path)?;
        for (name, compute) in METHODS {
            if agrees(&text, compute).map_err(|e| format!("{}: {e}", path.display()))? {
                same += 1;
            } else {
                different += 1;
                println!("{}: {name} differs", path.display());
            }
        }
    }
    Ok((same, different))
}

/// Writes JSON as Python does: a space after each comma and colon, and only ASCII.
struct Spaced;

impl Formatter for Spaced {
    fn begin_object_key<W: ?Sized + Write>(&mut self, w: &mut W, first: bool) -> Written<()> {
        w.write_all(if first { b"" } else { b", " })
    }
    fn begin_object_value<W: ?Sized + Write>(&mut self, w: &mut W) -> Written<()> {
        w.write_all(b": ")
    }
    fn begin_array_value<W: ?Sized + Write>(&mut self, w: &mut W, first: bool) -> Written<()> {
        w.write_all(if first { b"" } else { b", " })
    }
    fn write_string_fragment<W: ?Sized + Write>(&mut self, w: &mut W, fragment: &str) -> Written<()> {
        for c in fragment.chars() {
            match c {
                ' '..='~' => write!(w, "{c}")?,
                _ => c.encode_utf16(&mut [0; 2]).iter().try_for_each(|unit| write!(w, "\\u{unit:04x}"))?,
            }
        }
        Ok(())
    }
}

fn canonical(value: &Value) -> Result<String, String> {
    let mut bytes = Vec::new();
    let mut serializer = serde_json::Serializer::with_formatter(&mut bytes, Spaced);
    serde::Serialize::serialize(value, &mut serializer).map_err(|e| e.to_string())?;
    String::from_utf8(bytes).map_err(|e| e.to_string())
}

/// Parses the path and the engine from the command line.
fn arguments() -> Result<(String, Engine), String> {
    let (mut path, mut engine) = (None, Engine::Timed);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--engine" => {
                engine = match words.next().as_deref() {
                    Some("timed") => Engine::Timed,
                    Some("ticked") => Engine::Ticked,
                    other => return Err(format!("--engine {}: expected timed or ticked", other.unwrap_or("without a name"))),
                }
            }
            option if option.starts_with('-') => return Err(format!("unknown option {option}; {USAGE}")),
            _ if path.is_none() => path = Some(word),
            _ => return Err(format!("one path at a time, {word} is the second; {USAGE}")),
        }
    }
    Ok((path.ok_or(USAGE)?, engine))
}

fn try_main() -> Result<ExitCode, String> {
    let (path, engine) = arguments()?;
    let named = |e: String| format!("{path}: {e}");
    if Path::new(&path).is_dir() {
        let (same, different) = compare(Path::new(&path)).map_err(named)?;
        println!("{same} passed, {different} failed");
        return Ok(if different == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    let plan = read(Path::new(&path)).and_then(|text| parse_plan(&text)).map_err(named)?;
    println!("{}", canonical(&simulate(&plan, engine).map_err(named)?)?);
    Ok(ExitCode::SUCCESS)
}

fn main() -> ExitCode {
    try_main().unwrap_or_else(|error| {
        eprintln!("plan: {error}");
        ExitCode::from(2)
    })
}
