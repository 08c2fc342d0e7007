//! `basrelief verify`: replays traces and checks their expectations.

use super::convert::to_trace_file;
use crate::args::VerifyArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::input::TraceFile;
use crate::interrupt;
use basrelief_input::{MemoryPool, MemoryReservation, open_in_folder};
use basrelief_kernel::Engine;
use basrelief_report::Report;
use basrelief_sim::{MACHINES, MachineInfo, check_expectation, expectation_of, run_quietly};
use basrelief_trace::{
    ExpectedResults, PlacedExpectation, TraceCommand, TraceForm, TracePlace, TraceResolver, TraceWriter, open,
};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Checks or blesses every trace.
pub fn verify(args: &VerifyArgs, global: &GlobalOptions) -> CommandResult {
    let mut traces = TraceFiles::default();
    args.paths.iter().try_for_each(|path| traces.add(path))?;
    let traces = traces.found;
    if traces.is_empty() {
        let places = args.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        let expected = "expected .jsonl or .bdl files, or either with .zst appended";
        return Err(CommandError::BadInput(format!("{places}: found no traces; {expected}")));
    }
    if args.bless {
        interrupt::set_message("interrupted; each trace has either new expectations or its old ones");
    }
    let engines = args.engine.map_or(vec![Engine::Timed, Engine::Ticked], |e| vec![e.into()]);
    let (mut wrong, mut bare, mut failures) = (0, 0, Vec::new());
    for trace in &traces {
        let result =
            if args.bless { bless(trace, &global.budget).map(|()| vec![]) } else { check(trace, &engines, &global.budget) };
        let (verdict, why) = match result {
            Ok(why) if why.is_empty() => (if args.bless { "blessed" } else { "ok" }, why),
            Ok(why) => {
                *(if why == [NO_EXPECTATIONS] { &mut bare } else { &mut wrong }) += 1;
                ("FAILED", why)
            }
            Err(failure) => {
                failures.push(failure.to_string());
                ("FAILED", vec![])
            }
        };
        if !global.quiet || verdict == "FAILED" {
            print(&format!("{verdict:<7} {}\n", trace.display()))?;
            why.iter().try_for_each(|w| print(&format!("        {w}\n")))?;
        }
    }
    report_failures([wrong, bare], failures, traces.len())
}

/// Reason of a trace without expectations.
const NO_EXPECTATIONS: &str = "has no expectations; `basrelief record --expect` or `basrelief verify --bless` adds them";

/// Reports failures: traces that differ, and traces without expectations. New expectations help only for traces that run.
fn report_failures([wrong, bare]: [usize; 2], failures: Vec<String>, of: usize) -> CommandResult {
    let wrong = (wrong > 0).then(|| {
        format!("{wrong} of {of} traces differ from their expectations; after review, `basrelief verify --bless` updates them")
    });
    let bare = (bare > 0).then(|| format!("{bare} of {of} traces: no expectations; `basrelief verify --bless` adds them"));
    let failed = failures.len();
    let failed = (failed > 0).then(|| format!("{failed} of {of} traces cannot be read, run or written"));
    let sentences: Vec<String> = failures.into_iter().chain(wrong).chain(bare).chain(failed).collect();
    if sentences.is_empty() { Ok(()) } else { Err(CommandError::BadInput(sentences.join("\n"))) }
}

/// The traces of the given paths.
#[derive(Default)]
struct TraceFiles {
    found: Vec<PathBuf>,
    /// Visited folders, because a link can lead back to one.
    seen: BTreeSet<PathBuf>,
}

impl TraceFiles {
    /// Adds a trace, or the traces of a folder in order of name.
    fn add(&mut self, path: &Path) -> CommandResult {
        if path == Path::new("-") {
            return Err(CommandError::Usage(
                "verify reads each trace several times; expected files or folders, not standard input".into(),
            ));
        }
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => self.add_folder(path),
            Ok(found) if !found.is_file() => {
                Err(in_trace(path)("neither a file nor a folder; verify reads each trace several times, so copy it into a file"))
            }
            // A missing file is reported when it is read.
            _ => {
                self.found.push(path.to_path_buf());
                Ok(())
            }
        }
    }

    fn add_folder(&mut self, folder: &Path) -> CommandResult {
        let failed = || CommandError::at_file(folder, "be read");
        if !self.seen.insert(folder.canonicalize().map_err(failed())?) {
            return Ok(());
        }
        let entries = fs::read_dir(folder).map_err(failed())?;
        let mut inside: Vec<PathBuf> = entries.map(|e| e.map(|e| e.path())).collect::<Result<_, _>>().map_err(failed())?;
        inside.sort();
        for path in inside {
            if path.is_dir() {
                self.add_folder(&path)?;
            } else if TraceForm::for_file_name(&path.to_string_lossy()).is_some()
                && fs::metadata(&path).is_ok_and(|m| m.is_file())
            {
                self.found.push(path);
            }
        }
        Ok(())
    }
}

fn in_trace<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> CommandError + use<E> {
    CommandError::in_input(&path.display().to_string())
}

/// Reads the expectations of a whole trace. Returns them with their memory.
fn read_expectations(path: &Path, budget: &MemoryPool) -> CommandResult<(Vec<PlacedExpectation>, MemoryReservation)> {
    let file = TraceFile::open(path)?;
    let mut resolver = TraceResolver::new(file.reader, open_in_folder(&file.folder), budget).map_err(in_trace(path))?;
    resolver.by_ref().try_for_each(|c| c.map(|_| ())).map_err(in_trace(path))?;
    Ok(resolver.into_expectations())
}

/// Replays a trace with the machine and the parameters of an expectation.
fn replay(path: &Path, expectation: &PlacedExpectation, engine: Engine, budget: &MemoryPool) -> CommandResult<Report> {
    let PlacedExpectation { place, results: expected } = expectation;
    let settings: Vec<(String, String)> = expected.config.iter().map(|(k, v)| (k.clone(), v.to_string())).collect();
    let borrowed: Vec<(&str, &str)> = settings.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
    let in_field = |field: &str, error: String| in_trace(path)(format!("{place}: expect.{field}: {error}"));
    let machine = expected.machine.as_deref().map_or(Ok(&MACHINES[0]), MachineInfo::named);
    let machine = machine.map_err(|error| in_field("machine", error.to_string()))?;
    let choice = |name: &str| format!("set expect.machine to \"{name}\"");
    let config = machine.load("", &borrowed).map_err(|error| in_field("config", machine.explain(&error, choice)))?;
    config.check().map_err(|problem| in_field("config", problem.to_string()))?;
    let file = TraceFile::open(path)?;
    run_quietly(file.into_source(), &config, engine, budget).map(|run| run.report)
}

fn check(path: &Path, engines: &[Engine], budget: &MemoryPool) -> CommandResult<Vec<String>> {
    let (expectations, _held) = read_expectations(path, budget)?;
    if expectations.is_empty() {
        return Ok(vec![NO_EXPECTATIONS.into()]);
    }
    let mut wrong = Vec::new();
    for expected in &expectations {
        if expected.results.is_empty() {
            wrong.push(format!("{}: expects nothing; `basrelief verify --bless` adds cycles, bytes and images", expected.place));
            continue;
        }
        for &engine in engines {
            let report = replay(path, expected, engine, budget)?;
            wrong.extend(
                check_expectation(&expected.results, &report).into_iter().map(|w| format!("{engine:?}: {w}").to_lowercase()),
            );
        }
    }
    Ok(wrong)
}

/// Replaces the expectations by the current results.
fn bless(path: &Path, budget: &MemoryPool) -> CommandResult {
    let (mut old, _held) = read_expectations(path, budget)?;
    if old.is_empty() {
        old.push(PlacedExpectation { place: TracePlace::Start, results: ExpectedResults::default() });
    }
    let mut new = Vec::new();
    for expected in old {
        let report = replay(path, &expected, Engine::Timed, budget)?;
        new.push(expectation_of(&report, expected.results.config));
    }
    let input = TraceFile::open(path)?;
    to_trace_file(path, |file, form| {
        let mut writer = TraceWriter::new(file, form).map_err(in_trace(path))?;
        for command in open(input.reader, budget).map_err(in_trace(path))? {
            match command.map_err(in_trace(path))? {
                TraceCommand::Expect(_) => {}
                TraceCommand::End(_) => break,
                other => writer.write(&other).map_err(in_trace(path))?,
            }
        }
        for expectation in new {
            writer.write(&TraceCommand::Expect(Box::new(expectation))).map_err(in_trace(path))?;
        }
        writer.finish().map(|_| ()).map_err(in_trace(path))
    })
}
