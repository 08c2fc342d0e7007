//! Opening what a command works on: models, demos, display lists, configurations.

use crate::args::{MachineArgs, ViewArgs};
use crate::error::{Done, Failure};
use crate::views::Script;
use basrelief_input::{Budget, Held, OverBudget, beside, json_weight};
use basrelief_scene::{ImportOptions, SceneError, Subject, ViewOptions, demo, load_path_with, read_camera};
use basrelief_signals::Scene;
use basrelief_sim::{MACHINES, MachineConfig, MachineInfo, Overrides, OverridesError, PreparedScene, RunInput};
use basrelief_trace::{Form, looks_like_trace};
use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is simulated.
pub enum Input {
    /// Goes through the geometry processor.
    Scene(PreparedScene),
    /// What a geometry processor handed on.
    Trace(TraceFile),
}

impl Input {
    /// To be run more than once: what settings do not change is done once.
    pub fn for_several_runs(self, budget: &Budget) -> Self {
        match self {
            Self::Scene(scene) => Self::Scene(PreparedScene::cached(Arc::clone(scene.scene()), budget)),
            trace => trace,
        }
    }

    /// As what a run takes, from its beginning: for each of several runs.
    ///
    /// # Errors
    /// What can be read only once.
    pub fn again(&self) -> Done<RunInput> {
        match self {
            Self::Scene(scene) => Ok(RunInput::Scene(scene.clone())),
            Self::Trace(trace) => trace.again().map(TraceFile::into_source),
        }
    }
}

/// An open display list.
pub struct TraceFile {
    /// Its bytes.
    pub reader: Box<dyn Read>,
    /// Its size, where it is a file.
    pub bytes: Option<u64>,
    /// Bytes read so far.
    pub read: Rc<Cell<u64>>,
    /// As the user named it.
    pub name: String,
    /// Where it is, if it can be read again.
    file: Option<PathBuf>,
    /// Where files that it refers to lie.
    pub folder: PathBuf,
}

impl TraceFile {
    /// Opens a display list; `-` is standard input.
    pub fn open(path: &Path) -> Done<Self> {
        let read = Rc::new(Cell::new(0));
        if path == Path::new("-") {
            let reader = Box::new(Counting(io::stdin(), Rc::clone(&read)));
            return Ok(Self { reader, bytes: None, read, name: "standard input".into(), file: None, folder: PathBuf::new() });
        }
        let file = File::open(path).map_err(Failure::file(path, "be read"))?;
        let bytes = file.metadata().ok().filter(fs::Metadata::is_file).map(|m| m.len());
        let reader = Box::new(Counting(BufReader::new(file), Rc::clone(&read)));
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let again = bytes.map(|_| path.to_path_buf());
        Ok(Self { reader, bytes, read, name: path.display().to_string(), file: again, folder })
    }

    /// Opens it again, from its beginning.
    pub fn again(&self) -> Done<Self> {
        let once = || Failure::Usage(format!("{}: can be read only once, and several runs need it: give a file", self.name));
        Self::open(self.file.as_deref().ok_or_else(once)?)
    }

    /// As what a run takes.
    pub fn into_source(self) -> RunInput {
        let files = Box::new(beside(&self.folder));
        RunInput::Trace { reader: self.reader, files, name: self.name }
    }

    /// Whether it is a display list: by its first bytes, and only where these say nothing, as in a file cut short, by
    /// its name. What was looked at is put back: a pipe can be opened only once.
    fn is_one(&mut self) -> Done<bool> {
        let mut start = Vec::new();
        self.reader.by_ref().take(64).read_to_end(&mut start).map_err(Failure::file(Path::new(&self.name), "be read"))?;
        let is_one = looks_like_trace(&start) || Form::for_file_name(&self.name).is_some();
        let rest = std::mem::replace(&mut self.reader, Box::new(io::empty()));
        self.reader = Box::new(Cursor::new(start).chain(rest));
        Ok(is_one)
    }
}

/// Counts what passes.
struct Counting<R>(R, Rc<Cell<u64>>);

impl<R: Read> Read for Counting<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.0.read(buffer)?;
        self.1.set(self.1.get() + n as u64);
        Ok(n)
    }
}

/// Models may name files outside their folders: `--allow-outside`.
static ALLOW_OUTSIDE: AtomicBool = AtomicBool::new(false);

/// Sets `--allow-outside` for all models that the program opens.
pub fn set_allow_outside(allow_outside: bool) {
    ALLOW_OUTSIDE.store(allow_outside, Ordering::Relaxed);
}

fn import_options(budget: &Budget) -> ImportOptions {
    ImportOptions { budget: budget.clone(), allow_outside: ALLOW_OUTSIDE.load(Ordering::Relaxed) }
}

/// Opens a model, a demo (`demo:NAME`) or a display list.
pub fn open(path: &Path, view: &ViewArgs, budget: &Budget) -> Done<Input> {
    open_seen(path, &look(view, budget)?.without_times()?, budget)
}

/// The same, seen as that.
pub fn open_seen(path: &Path, view: &ViewOptions, budget: &Budget) -> Done<Input> {
    if let Some(name) = demo_of(path) {
        return demo_scene(name, view).map(|scene| Input::Scene(scene.into()));
    }
    let mut trace = TraceFile::open(path)?;
    if path == Path::new("-") || trace.is_one()? {
        if *view != ViewOptions::default() {
            return Err(Failure::Usage("a display list carries its own view: --size, --camera, --turn, --zoom, --frames, --orbit, --light, --light-orbit and --views are for scenes".into()));
        }
        return Ok(Input::Trace(trace));
    }
    let (scene, held) = load_path_with(path, view, &import_options(budget)).map_err(failed_within(path))?;
    // It is there to the end of the program.
    held.keep();
    Ok(Input::Scene(Arc::new(scene).into()))
}

/// Opens a model or a demo (`demo:NAME`) that nobody looks at yet; none where it is a display list.
pub fn open_subject(path: &Path, budget: &Budget) -> Done<Option<Subject>> {
    if let Some(name) = demo_of(path) {
        return Subject::demo(name).map(Some).map_err(|e| Failure::Usage(e.to_string()));
    }
    if path == Path::new("-") || TraceFile::open(path)?.is_one()? {
        return Ok(None);
    }
    let (subject, held) = Subject::load_path_with(path, &import_options(budget)).map_err(failed_within(path))?;
    // It is there to the end of the program.
    held.keep();
    Ok(Some(subject))
}

/// What is wrong may lie in a file that the model refers to; the model is named all the same.
fn failed_within(path: &Path) -> impl Fn(SceneError) -> Failure {
    let shown = path.display().to_string();
    move |e| if e.file == shown { Failure::bad(e) } else { Failure::within(&shown)(e) }
}

/// An embedded scene.
pub fn demo_scene(name: &str, view: &ViewOptions) -> Done<Arc<Scene>> {
    demo(name, view).map(Arc::new).map_err(|e| Failure::Usage(e.to_string()))
}

/// A text file, and what it takes.
pub fn read_text(path: &Path, budget: &Budget) -> Done<(String, Held)> {
    basrelief_input::read_text(path, budget).map_err(|e| match OverBudget::within(&e) {
        Some(error) => Failure::within(&path.display().to_string())(error),
        None => Failure::file(path, "be read")(e),
    })
}

/// What is looked at, and when.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// As the importer takes it.
    pub view: ViewOptions,
    /// When each view is left for the next \[ms from the start\]; none where nobody says.
    left_at_ms: Option<Vec<f64>>,
}

impl Look {
    /// For who knows no times.
    ///
    /// # Errors
    /// Times.
    pub fn without_times(self) -> Done<ViewOptions> {
        match self.left_at_ms {
            None => Ok(self.view),
            Some(_) => Err(Failure::Usage("--views: gives times, which are for `run` and `demo`: leave `at_ms` out".into())),
        }
    }

    /// Tells the machine its times, ahead of other settings.
    ///
    /// # Errors
    /// A machine that knows none.
    pub fn tell(&self, args: &MachineArgs, demo: Option<&str>) -> Done<MachineArgs> {
        let mut told = args.clone();
        let Some(times) = &self.left_at_ms else { return Ok(told) };
        let machine = args.machine.unwrap_or_else(|| MachineInfo::of_demo(demo.unwrap_or_default()));
        let parameter = machine.left_at.ok_or_else(|| {
            let knows = MACHINES.iter().filter(|m| m.left_at.is_some()).map(|m| format!("`{}`", m.name)).collect::<Vec<_>>();
            let (name, others) = (machine.name, knows.join(", "));
            Failure::Usage(format!(
                "--views: gives times, and machine `{name}` leaves no view; take {others}, or leave `at_ms` out"
            ))
        })?;
        told.settings.insert(0, (parameter.into(), format!("{times:?}")));
        Ok(told)
    }
}

/// What the options of a view come to.
pub fn look(view: &ViewArgs, budget: &Budget) -> Done<Look> {
    let camera = match &view.camera {
        None => None,
        Some(path) => {
            let name = path.display().to_string();
            let (text, _held) = read_text(path, budget)?;
            let _held = budget.take(json_weight(text.as_bytes()), "what a camera says").map_err(Failure::within(&name))?;
            Some(read_camera(&text, &name).map_err(Failure::bad)?)
        }
    };
    let script =
        |path: &PathBuf| Script::read(&read_text(path, budget)?.0, budget).map_err(Failure::within(&path.display().to_string()));
    let Script { views, left_at_ms } = view.views.as_ref().map(script).transpose()?.unwrap_or_default();
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
    Ok(Look { view, left_at_ms })
}

/// The name of the demo that an input stands for.
pub fn demo_of(path: &Path) -> Option<&str> {
    path.to_str()?.strip_prefix("demo:")
}

/// The machine's parameters: defaults, then the file, then single settings. A demo knows which machine it is made for.
pub fn config(args: &MachineArgs, demo: Option<&str>, budget: &Budget) -> Done<(MachineConfig, Overrides)> {
    let machine = args.machine.unwrap_or_else(|| MachineInfo::of_demo(demo.unwrap_or_default()));
    config_of(machine, args.config.as_deref(), &args.settings, budget)
}

/// The parameters of this machine: defaults, then the file, then single settings; and these as they were given. The file is read
/// once: it can be a pipe.
pub fn config_of(
    machine: &MachineInfo,
    file: Option<&Path>,
    settings: &[(String, String)],
    budget: &Budget,
) -> Done<(MachineConfig, Overrides)> {
    let (toml, _held) = file.map_or_else(|| Ok((String::new(), budget.nothing())), |path| read_text(path, budget))?;
    let name = file.map(|path| path.display().to_string()).unwrap_or_default();
    let given = Overrides { toml, settings: settings.to_vec() };
    let config = given.checked(machine, budget).map_err(|wrong| match wrong {
        OverridesError::File(error) => Failure::Bad(format!("{name}: {error}")),
        OverridesError::Settings(error) => Failure::Usage(format!("--set: {error}")),
    })?;
    Ok((config, given))
}
