//! Opens the inputs of a command: models, demos, traces and parameter files.

use crate::args::{MachineArgs, ViewArgs};
use crate::error::{CommandError, CommandResult};
use crate::global::GlobalOptions;
use crate::inputs_read;
use crate::scene_input::{demo_of, input_error, open_scene, scene_error};
use crate::views::ViewScript;
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget, json_weight, open_in_folder};
use basrelief_scene::{SceneSubject, ViewOptions, read_camera};
use basrelief_sim::{
    MACHINES, MachineConfig, MachineInfo, Overrides, OverridesError, PreparedScene, RunInput, looks_like_recording,
};
use basrelief_trace::{TraceForm, looks_like_trace};
use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// Input of a simulation.
pub enum Input {
    /// A scene, drawn by the geometry processor.
    Scene(PreparedScene),
    /// A trace: the output of a geometry processor.
    Trace(TraceFile),
}

impl Input {
    /// Prepares the input for several runs: work that does not depend on parameters is done once.
    pub fn for_several_runs(self, budget: &MemoryPool) -> Self {
        match self {
            Self::Scene(scene) => Self::Scene(PreparedScene::cached(Arc::clone(scene.scene()), budget)),
            trace => trace,
        }
    }

    /// Returns the input from its beginning, for one of several runs.
    ///
    /// # Errors
    /// The input can be read only once.
    pub fn reopen(&self) -> CommandResult<RunInput> {
        match self {
            Self::Scene(scene) => Ok(RunInput::Scene(scene.clone())),
            Self::Trace(trace) => trace.reopen().map(TraceFile::into_source),
        }
    }
}

/// An open trace.
pub struct TraceFile {
    /// Its bytes.
    pub reader: Box<dyn Read>,
    /// Size, if it is a file.
    pub bytes: Option<u64>,
    /// Bytes read so far.
    pub read: Rc<Cell<u64>>,
    /// Name given by the user.
    pub name: String,
    /// Path, if it can be read again.
    file: Option<PathBuf>,
    /// Folder of the files that it references.
    pub folder: PathBuf,
}

impl TraceFile {
    /// Opens a trace; `-` is standard input.
    pub fn open(path: &Path) -> CommandResult<Self> {
        let read = Rc::new(Cell::new(0));
        if path == Path::new("-") {
            let reader = Box::new(CountingReader(io::stdin(), Rc::clone(&read)));
            return Ok(Self { reader, bytes: None, read, name: "standard input".into(), file: None, folder: PathBuf::new() });
        }
        let file = File::open(path).map_err(CommandError::at_file(path, "be read"))?;
        let bytes = file.metadata().ok().filter(fs::Metadata::is_file).map(|m| m.len());
        let reader = Box::new(CountingReader(BufReader::new(file), Rc::clone(&read)));
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let again = bytes.map(|_| path.to_path_buf());
        Ok(Self { reader, bytes, read, name: path.display().to_string(), file: again, folder })
    }

    /// Opens the trace again from its beginning.
    pub fn reopen(&self) -> CommandResult<Self> {
        let once =
            || CommandError::Usage(format!("{}: can be read only once, but several runs need it; expected a file", self.name));
        Self::open(self.file.as_deref().ok_or_else(once)?)
    }

    /// Converts the trace into the input of a run.
    pub fn into_source(self) -> RunInput {
        let (mut open, folder) = (open_in_folder(&self.folder), self.folder.clone());
        let files = Box::new(move |name: &str| {
            inputs_read::add(&folder.join(name));
            open(name)
        });
        RunInput::Trace { reader: self.reader, files, name: self.name }
    }

    /// Returns true if the file is a trace: by its first bytes, or if they do not decide, as in a truncated file, by its name. The bytes
    /// are put back, because a pipe can be opened only once.
    fn is_one(&mut self) -> CommandResult<bool> {
        let mut start = Vec::new();
        self.reader.by_ref().take(64).read_to_end(&mut start).map_err(CommandError::at_file(Path::new(&self.name), "be read"))?;
        let is_one = looks_like_trace(&start) || TraceForm::for_file_name(&self.name).is_some();
        let rest = std::mem::replace(&mut self.reader, Box::new(io::empty()));
        self.reader = Box::new(Cursor::new(start).chain(rest));
        Ok(is_one)
    }

    /// Refuses the recording of a run, which is compressed like a trace.
    fn check_is_no_recording(&self) -> CommandResult {
        let mut decoder = self.file.as_deref().and_then(|path| zstd::Decoder::new(File::open(path).ok()?).ok());
        // No recording has a larger window than 2^23 bytes, and a trace with a larger window takes no memory here.
        let is_small = decoder.as_mut().is_some_and(|decoder| decoder.window_log_max(23).is_ok());
        if !is_small || !decoder.is_some_and(looks_like_recording) {
            return Ok(());
        }
        let cure = format!("the recording of a run, expected a model or a trace; `basrelief resimulate {}` reads it", self.name);
        Err(CommandError::in_input(&self.name)(cure))
    }
}

/// Counts bytes read.
struct CountingReader<R>(R, Rc<Cell<u64>>);

impl<R: Read> Read for CountingReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.0.read(buffer)?;
        self.1.set(self.1.get() + n as u64);
        Ok(n)
    }
}

/// Opens a model, a demo (`demo:NAME`) or a trace.
pub fn open(path: &Path, view: &ViewArgs, global: &GlobalOptions) -> CommandResult<Input> {
    open_seen(path, &resolve_view(view, &global.budget)?.without_times()?, global)
}

/// Opens an input with a resolved view.
pub fn open_seen(path: &Path, view: &ViewOptions, global: &GlobalOptions) -> CommandResult<Input> {
    if let Some(trace) = open_trace(path)? {
        if *view != ViewOptions::default() {
            let holds = if path == Path::new("-") { "standard input holds a trace, and " } else { "" };
            return Err(CommandError::Usage(format!(
                "{holds}a trace has its own view; --size, --camera, --turn, --zoom, --frames, --orbit, --light, --light-orbit and --views apply to scenes only"
            )));
        }
        return Ok(Input::Trace(trace));
    }
    open_scene(path, view, global).map(|scene| Input::Scene(scene.into())).map_err(input_error(path))
}

/// Opens a trace; `None` for a model or a demo.
pub fn open_trace(path: &Path) -> CommandResult<Option<TraceFile>> {
    if demo_of(path).is_some() {
        return Ok(None);
    }
    let mut trace = TraceFile::open(path)?;
    if path != Path::new("-") && !trace.is_one()? {
        return Ok(None);
    }
    trace.check_is_no_recording()?;
    Ok(Some(trace))
}

/// Opens a model or a demo (`demo:NAME`) without a view; `None` for a trace.
pub fn open_subject(path: &Path, global: &GlobalOptions) -> CommandResult<Option<SceneSubject>> {
    if let Some(name) = demo_of(path) {
        return SceneSubject::demo(name).map(Some).map_err(scene_error(path));
    }
    if path == Path::new("-") || TraceFile::open(path)?.is_one()? {
        return Ok(None);
    }
    let (subject, held) = SceneSubject::load_path_with(path, &global.import_options()).map_err(scene_error(path))?;
    // The memory stays reserved until the end of the program.
    held.keep_forever();
    Ok(Some(subject))
}

/// Reads a text file with this `content`, for example `a camera (JSON)`. Returns the text and its memory.
pub fn read_text(path: &Path, content: &str, budget: &MemoryPool) -> CommandResult<(String, MemoryReservation)> {
    let in_file = |error: String| CommandError::in_input(&path.display().to_string())(error);
    basrelief_input::read_text(path, budget).map_err(|e| match OverBudget::in_io_error(&e) {
        Some(error) => in_file(error.to_string()),
        None if e.kind() == io::ErrorKind::InvalidData => in_file(format!("not a text file in UTF-8; expected {content}")),
        None => CommandError::at_file(path, "be read")(e),
    })
}

/// The view and its times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResolvedView {
    /// View options of the importer.
    pub view: ViewOptions,
    /// Time at which each view is left \[ms from the start\]; `None` without times.
    left_at_ms: Option<Vec<f64>>,
}

impl ResolvedView {
    /// Returns the view for commands without times.
    ///
    /// # Errors
    /// The view has times.
    pub fn without_times(self) -> CommandResult<ViewOptions> {
        match self.left_at_ms {
            None => Ok(self.view),
            Some(_) => Err(CommandError::Usage("--views: only `run` and `demo` support times; remove `at_ms`".into())),
        }
    }

    /// Adds the times to the parameters of the machine.
    ///
    /// # Errors
    /// The machine does not support times.
    pub fn with_view_times(&self, args: &MachineArgs, demo: Option<&str>) -> CommandResult<MachineArgs> {
        let mut told = args.clone();
        let Some(times) = &self.left_at_ms else { return Ok(told) };
        let machine = args.machine.unwrap_or_else(|| MachineInfo::of_demo(demo.unwrap_or_default()));
        let parameter = machine.left_at.ok_or_else(|| {
            let knows = MACHINES.iter().filter(|m| m.left_at.is_some()).map(|m| format!("`{}`", m.name)).collect::<Vec<_>>();
            let (name, others) = (machine.name, knows.join(", "));
            CommandError::Usage(format!(
                "--views: gives times, but machine `{name}` cannot leave a view; use {others}, or remove `at_ms`"
            ))
        })?;
        told.settings.insert(0, (parameter.into(), format!("{times:?}")));
        Ok(told)
    }
}

/// Resolves the options of a view.
pub fn resolve_view(view: &ViewArgs, budget: &MemoryPool) -> CommandResult<ResolvedView> {
    let camera = match &view.camera {
        None => None,
        Some(path) => {
            let name = path.display().to_string();
            let (text, _held) = read_text(path, "a camera (JSON)", budget)?;
            let _held = budget
                .try_reserve(json_weight(text.as_bytes()), "the values of a camera")
                .map_err(CommandError::in_input(&name))?;
            Some(read_camera(&text, &name).map_err(CommandError::bad_input)?)
        }
    };
    let script = |path: &PathBuf| {
        let (text, _held) = read_text(path, "views (TOML or JSON)", budget)?;
        ViewScript::read(&text, budget).map_err(CommandError::in_input(&path.display().to_string()))
    };
    let ViewScript { views, left_at_ms } = view.views.as_ref().map(script).transpose()?.unwrap_or_default();
    let default = ViewOptions::default();
    let view = ViewOptions {
        size: view.size.unwrap_or(default.size),
        camera,
        turn: view.turn,
        zoom: view.zoom,
        frames: view.frames,
        orbit_degrees: view.orbit,
        light: view.light,
        light_orbit_degrees: view.light_orbit,
        views,
    };
    Ok(ResolvedView { view, left_at_ms })
}

/// Returns the parameters of the machine: the defaults, overridden by the file, overridden by single settings. A demo selects its machine.
pub fn config(args: &MachineArgs, demo: Option<&str>, budget: &MemoryPool) -> CommandResult<(MachineConfig, Overrides)> {
    let machine = args.machine.unwrap_or_else(|| MachineInfo::of_demo(demo.unwrap_or_default()));
    config_of(machine, args.config.as_deref(), &args.settings, budget)
}

/// Returns the parameters of this machine, and the overrides. The file is read once, because it can be a pipe.
pub fn config_of(
    machine: &MachineInfo,
    file: Option<&Path>,
    settings: &[(String, String)],
    budget: &MemoryPool,
) -> CommandResult<(MachineConfig, Overrides)> {
    let read = |path| read_text(path, "parameters of a machine (TOML or JSON)", budget);
    let (text, _held) = file.map_or_else(|| Ok((String::new(), budget.empty_reservation())), read)?;
    let name = file.map(|path| path.display().to_string()).unwrap_or_default();
    let in_place = |wrong| match wrong {
        OverridesError::File(error) => CommandError::BadInput(format!("{name}: {error}")),
        OverridesError::Settings(error) => CommandError::Usage(format!("--set: {error}")),
    };
    let given = Overrides::of_file(machine, text, settings.to_vec()).map_err(in_place)?;
    let config = given.load_checked(machine, budget).map_err(in_place)?;
    Ok((config, given))
}
