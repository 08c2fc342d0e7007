//! `basrelief capture`: runs an application under apitrace and imports one of its frames.

use super::import_gl::{Dump, OutputPaths, import_dumps};
use crate::args::CaptureArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::interrupt;
use crate::outputs::PartialFile;
use basrelief_input::{MemoryPool, MemoryReservation, read_to_end};
use basrelief_opengl::{FrameCalls, StateDump, frames, with_draws};
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Captures a frame.
pub fn capture(args: &CaptureArgs, global: &GlobalOptions) -> CommandResult {
    OutputPaths::new(&args.scene.out)?;
    let folder = CaptureFolder::create(&args.scene.out)?;
    interrupt::set_message("interrupted; no scene was written; the .capture folder holds an unfinished trace");
    folder.record(args)?;
    interrupt::set_message("interrupted; no scene was written; the .capture folder holds the trace");
    let (text, _text) = folder.dump(&[], &global.budget)?;
    let frame = chosen(&frames(&text), args)?;
    let draws = draws_of(&frame, &args.calls)?;
    drop(text);
    if !global.quiet {
        let s = if draws.len() == 1 { "" } else { "s" };
        print(&format!("{} draw call{s} of the frame up to call {}\n", draws.len(), frame.last))?;
    }
    let states = draws.iter().map(|call| folder.state(*call, &global.budget)).collect::<CommandResult<Vec<_>>>()?;
    let (text, _text) = folder.dump(&["--blobs", &format!("--calls=0-{}", frame.last)], &global.budget)?;
    let blobs = |name: &str| folder.blob(name, &global.budget);
    let complete = with_draws(&text, &blobs, states, &global.budget).map_err(CommandError::in_input(&folder.shown("trace")))?;
    folder.remove_blobs();
    let dumps = complete.into_iter().map(|state| folder.keep(state)).collect::<CommandResult<Vec<_>>>()?;
    import_dumps(&dumps, &args.scene, global)
}

/// Returns the frame that the options select.
fn chosen(frames: &[FrameCalls], args: &CaptureArgs) -> CommandResult<FrameCalls> {
    let found = match args.frame {
        Some(number) => frames.get(number),
        None => frames.iter().rev().find(|frame| frame.is_complete).or(frames.last()),
    };
    found.cloned().ok_or_else(|| match args.frame {
        Some(number) => CommandError::Usage(format!("--frame {number}: expected a number below {}", frames.len())),
        None => CommandError::BadInput(
            "the application made no draw call; expected an OpenGL program (for EGL, add --api egl)".into(),
        ),
    })
}

/// Returns the draw calls to import.
fn draws_of(frame: &FrameCalls, calls: &[u64]) -> CommandResult<Vec<u64>> {
    if let Some(call) = calls.iter().find(|call| !frame.draws.contains(call)) {
        let draws = frame.draws.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
        return Err(CommandError::Usage(format!("--calls {call}: is no draw call of the frame; expected some of {draws}")));
    }
    let is_chosen = |call: &&u64| calls.is_empty() || calls.contains(call);
    Ok(frame.draws.iter().filter(is_chosen).copied().collect())
}

/// Returns the file name of a dump. Names have the order of the calls.
fn dump_name(call: u64) -> String {
    format!("{call:010}.json")
}

/// Returns the call of a file name of a dump.
fn call_of(name: &str) -> Option<u64> {
    name.strip_suffix(".json")?.parse().ok()
}

/// Folder of a trace and its dumps.
struct CaptureFolder {
    path: PathBuf,
}

impl CaptureFolder {
    fn create(out: &Path) -> CommandResult<Self> {
        let path = out.with_extension("capture");
        fs::create_dir_all(&path).map_err(CommandError::at_file(&path, "be created"))?;
        // apitrace runs in this folder.
        let path = path.canonicalize().map_err(CommandError::at_file(&path, "be read"))?;
        for entry in fs::read_dir(&path).map_err(CommandError::at_file(&path, "be read"))?.flatten() {
            let name = entry.file_name();
            // Dumps of an earlier capture belong to another frame.
            if name.to_str().and_then(call_of).is_some_and(|call| *dump_name(call) == *name) {
                fs::remove_file(entry.path()).map_err(CommandError::at_file(&entry.path(), "be removed"))?;
            }
        }
        Ok(Self { path })
    }

    fn shown(&self, name: &str) -> String {
        self.path.join(name).display().to_string()
    }

    /// Runs the application. Its exit code does not matter, as long as there is a trace.
    fn record(&self, args: &CaptureArgs) -> CommandResult {
        let trace = self.path.join("trace");
        let _ = fs::remove_file(&trace);
        let mut command = Command::new("apitrace");
        // Standard output is reserved for this program.
        command.args(["trace", "--api", &args.api, "--output"]).arg(&trace).args(&args.program).stdout(io::stderr());
        command.status().map_err(not_started)?;
        if trace.is_file() {
            return Ok(());
        }
        let program = args.program.first().map(|name| name.display().to_string()).unwrap_or_default();
        Err(CommandError::BadInput(format!("`{program}` left no trace; expected an OpenGL program that can be started here")))
    }

    /// Returns the text of the calls.
    fn dump(&self, options: &[&str], budget: &MemoryPool) -> CommandResult<(String, MemoryReservation)> {
        let blobs = self.path.join("blobs");
        fs::create_dir_all(&blobs).map_err(CommandError::at_file(&blobs, "be created"))?;
        let mut command = Command::new("apitrace");
        command.args(["dump", "--color=never", "--multiline=no"]).args(options).arg(self.path.join("trace")).current_dir(&blobs);
        let (bytes, held) = output(&mut command, budget)?;
        String::from_utf8(bytes).map(|text| (text, held)).map_err(|e| CommandError::BadInput(format!("apitrace dump: {e}")))
    }

    /// Returns the state behind a draw call. An X server that resets after its last client may refuse the next one, so that a replay is
    /// repeated.
    fn state(&self, call: u64, budget: &MemoryPool) -> CommandResult<StateDump> {
        let replay = || {
            let mut command = Command::new("apitrace");
            command.args(["replay", "--headless", "-D", &call.to_string()]).arg(self.path.join("trace"));
            output(&mut command, budget).map(|(bytes, held)| StateDump { call, bytes, held })
        };
        replay().or_else(|_| replay()).or_else(|_| replay())
    }

    /// Writes a dump into the folder, and returns it for the import.
    fn keep(&self, state: StateDump) -> CommandResult<Dump> {
        let path = self.path.join(dump_name(state.call));
        PartialFile::write_whole(&path, &state.bytes).map_err(CommandError::at_file(&path, "be written"))?;
        Ok(Dump::new(&path, state.bytes, state.held))
    }

    fn blob(&self, name: &str, budget: &MemoryPool) -> io::Result<(Vec<u8>, MemoryReservation)> {
        // Names come from apitrace, which numbers them.
        let name = Path::new(name).file_name().ok_or(ErrorKind::InvalidInput)?;
        read_to_end(&mut File::open(self.path.join("blobs").join(name))?, 0, budget, "a blob of a trace")
    }

    fn remove_blobs(&self) {
        // Blobs that stay do no harm.
        let _ = fs::remove_dir_all(self.path.join("blobs"));
    }
}

/// Returns the standard output of a program of apitrace.
fn output(command: &mut Command, budget: &MemoryPool) -> CommandResult<(Vec<u8>, MemoryReservation)> {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().map_err(not_started)?;
    let mut stdout = child.stdout.take();
    let read = stdout.as_mut().map(|stdout| read_to_end(stdout, 0, budget, "output of apitrace"));
    drop(stdout);
    let status = child.wait().map_err(CommandError::in_input("apitrace"))?;
    let output = read.transpose().map_err(CommandError::in_input("apitrace"))?.filter(|(bytes, _)| !bytes.is_empty());
    output.filter(|_| status.success()).ok_or_else(|| {
        let call = command.get_args().map(|arg| arg.display().to_string()).collect::<Vec<_>>().join(" ");
        CommandError::BadInput(format!("`apitrace {call}` failed; expected a trace that can be replayed here, with a display"))
    })
}

fn not_started(error: io::Error) -> CommandError {
    if error.kind() == ErrorKind::NotFound {
        let cure = "install the package `apitrace`, for example with `apt-get install apitrace`";
        return CommandError::BadInput(format!("apitrace is not installed; {cure}"));
    }
    CommandError::BadInput(format!("apitrace: cannot be started: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_dumps_have_the_order_of_calls() {
        let names = [999, 1000, 20_000].map(dump_name);
        assert!(names.is_sorted(), "{names:?}");
        assert_eq!(names.map(|name| call_of(&name)), [Some(999), Some(1000), Some(20_000)]);
        assert_eq!([call_of("notes.json"), call_of("7.txt")], [None, None]);
    }
}
