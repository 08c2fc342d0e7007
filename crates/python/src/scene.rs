//! Inputs of a run: scenes with a choice of view, and display lists with a fixed view.

use crate::error::{CommandError, CommandResult, PythonResult, budget};
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget, json_weight, open_in_folder};
use basrelief_parameters::nearest;
use basrelief_scene::{FolderFiles, MemoryFiles, ModelFiles, SceneError, ViewOptions, demo, load, read_camera, text};
use basrelief_sim::{PreparedScene, RunInput, is_demo};
use basrelief_trace::{TraceForm, looks_like_trace};
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::{PyAnyMethods, PyBytes, PyType};
use pyo3::{Bound, FromPyObject, IntoPyObject, Py, PyAny, PyRef, PyResult, Python, pyclass, pyfunction, pymethods};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// View of a scene, with the options of the command line.
#[derive(Clone, Default, PartialEq, FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub struct ViewArguments {
    size: Option<(i64, i64)>,
    /// Name and text of a camera file.
    camera: Option<(String, String)>,
    turn: Option<[f64; 2]>,
    zoom: Option<f64>,
    frames: Option<i64>,
    orbit: Option<f64>,
    light: Option<[f64; 3]>,
    light_orbit: Option<f64>,
}

/// Options of a view, as the command line defines them.
const OPTIONS: [&str; 8] = ["size", "camera", "turn", "zoom", "frames", "orbit", "light", "light_orbit"];

impl ViewArguments {
    /// Reads the view of a plan. `camera` reads the camera file of the given name.
    pub fn of_plan(
        options: &[(String, String)],
        camera: impl Fn(&str) -> CommandResult<(String, String)>,
    ) -> Result<Self, String> {
        let mut view = Self::default();
        for (name, value) in options {
            match name.as_str() {
                "size" => view.size = Some(text::size(value).map(|[width, height]| (width.into(), height.into()))?),
                "camera" => view.camera = Some(camera(value).map_err(|error| error.to_string())?),
                "turn" => view.turn = Some(text::angles(value)?),
                "zoom" => view.zoom = Some(text::finite(value)?),
                "frames" => view.frames = Some(value.parse().map_err(|_| "expected a whole number")?),
                "orbit" => view.orbit = Some(text::finite(value)?),
                "light" => view.light = Some(text::direction(value)?),
                "light_orbit" => view.light_orbit = Some(text::finite(value)?),
                _ => {
                    let hint =
                        nearest(name, OPTIONS.into_iter()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
                    return Err(format!("no option is called `{name}`{hint} (basrelief.scene has all)"));
                }
            }
        }
        Ok(view)
    }

    /// Returns true if every option has its default.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    pub fn options(&self, budget: &MemoryPool) -> CommandResult<ViewOptions> {
        let whole = |name: &str, n: i64| {
            u32::try_from(n).map_err(|_| {
                CommandError::usage(format_args!("{name}: {n}; expected a whole number from 1 on, of at most 32 bits"))
            })
        };
        let camera = |(name, text): &(String, String)| {
            let weight = budget.try_reserve(json_weight(text.as_bytes()), "the values of a camera");
            let _held = weight.map_err(CommandError::in_input(name))?;
            read_camera(text, name).map_err(CommandError::bad_input)
        };
        let default = ViewOptions::default();
        Ok(ViewOptions {
            size: self.size.map_or(Ok(default.size), |(width, height)| {
                Ok::<_, CommandError>([whole("size", width)?, whole("size", height)?])
            })?,
            camera: self.camera.as_ref().map(camera).transpose()?,
            turn: self.turn,
            zoom: self.zoom,
            frames: self.frames.map(|frames| whole("frames", frames)).transpose()?,
            orbit_degrees: self.orbit,
            light: self.light,
            light_orbit_degrees: self.light_orbit,
            ..default
        })
    }
}

/// Source of a scene: enough to rebuild it, also on another computer.
enum SceneOrigin {
    Demo,
    /// The bytes of the model and of the files that it refers to.
    Model(Vec<u8>, BTreeMap<String, Vec<u8>>),
}

/// A scene, ready to run. Work that is independent of parameters is done once and shared by all runs.
#[pyclass(frozen, module = "basrelief")]
pub struct Scene {
    /// Name of the demo, or the file name as given by the user.
    name: String,
    made: SceneOrigin,
    view: ViewArguments,
    memory_limit: Option<u64>,
    prepared: PreparedScene,
    _held: MemoryReservation,
}

#[pymethods]
impl Scene {
    /// Makes a demo scene.
    #[staticmethod]
    fn demo(py: Python<'_>, name: String, view: ViewArguments, memory_limit: Option<u64>) -> PythonResult<Self> {
        py.detach(|| {
            let budget = budget(memory_limit.unwrap_or(MemoryPool::DEFAULT));
            let scene = demo(&name, &view.options(&budget)?).map_err(CommandError::usage)?;
            let prepared = PreparedScene::cached(Arc::new(scene), &budget);
            Ok(Self { name, made: SceneOrigin::Demo, view, memory_limit, prepared, _held: budget.empty_reservation() })
        })
    }

    /// Opens a model: a .glb, .gltf or .obj file.
    #[staticmethod]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        view: ViewArguments,
        memory_limit: Option<u64>,
        allow_outside: bool,
    ) -> PythonResult<Self> {
        py.detach(|| {
            let budget = budget(memory_limit.unwrap_or(MemoryPool::DEFAULT));
            let name = path.display().to_string();
            let folder = ModelFolder::of(&path, allow_outside, &budget);
            let (bytes, held) = folder.main(&path, &budget).map_err(cannot_be_read(&name))?;
            if looks_like_trace(&bytes) || TraceForm::for_file_name(&name).is_some() {
                return Err(CommandError::usage(format_args!(
                    "{name}: a display list, which carries its own view: basrelief.display_list opens it"
                ))
                .into());
            }
            let mut scene = Self::loaded(name, bytes, &folder, view, memory_limit, &budget)?;
            let (files, of_files) = folder.into_read();
            if let SceneOrigin::Model(_, read) = &mut scene.made {
                *read = files;
            }
            scene._held.join(held);
            scene._held.join(of_files);
            Ok(scene)
        })
    }

    /// Makes a model from its files, as returned by `files`.
    #[staticmethod]
    fn of_files(
        py: Python<'_>,
        main: (String, PyBackedBytes),
        files: BTreeMap<String, PyBackedBytes>,
        view: ViewArguments,
        memory_limit: Option<u64>,
    ) -> PythonResult<Self> {
        py.detach(|| {
            let budget = budget(memory_limit.unwrap_or(MemoryPool::DEFAULT));
            let (name, main) = main;
            let files: BTreeMap<String, Vec<u8>> = files.into_iter().map(|(name, bytes)| (name, bytes.to_vec())).collect();
            let memory = files.iter().fold(MemoryFiles::default(), |memory, (name, bytes)| memory.with(name, bytes.as_slice()));
            let mut scene = Self::loaded(name, main.to_vec(), &memory, view, memory_limit, &budget)?;
            scene.made = SceneOrigin::Model(main.to_vec(), files);
            Ok(scene)
        })
    }

    /// Pickles a model as the bytes of its files and its view, and a demo as its name and view.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<RebuildCall<'py>> {
        let of = py.get_type::<Self>();
        let view = self.view.clone();
        Ok(match &self.made {
            SceneOrigin::Demo => RebuildCall::Demo(of.getattr("demo")?, (self.name.clone(), view, self.memory_limit)),
            SceneOrigin::Model(main, files) => {
                let bytes = |bytes: &Vec<u8>| PyBytes::new(py, bytes).unbind();
                let files = files.iter().map(|(name, of)| (name.clone(), bytes(of))).collect();
                RebuildCall::Model(of.getattr("of_files")?, ((self.name.clone(), bytes(main)), files, view, self.memory_limit))
            }
        })
    }

    /// Name as given by the user.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Number of pictures.
    #[getter]
    fn frames(&self) -> usize {
        self.prepared.scene().frames.len()
    }

    /// Width and height of the pictures [pixels].
    #[getter]
    fn size(&self) -> (u32, u32) {
        self.prepared.scene().frames.first().map_or((0, 0), |frame| (frame.width, frame.height))
    }

    /// Number of triangles of the model.
    #[getter]
    fn triangles(&self) -> usize {
        self.prepared.scene().objects.iter().map(|object| object.mesh.indices.len() / 3).sum()
    }

    /// Warnings of the import, one sentence for each omission or replacement.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.prepared.scene().warnings.clone()
    }

    fn __repr__(&self) -> String {
        let ((width, height), frames) = (self.size(), self.frames());
        format!("Scene({:?}, {width} x {height}, {frames} frame{})", self.name, if frames == 1 { "" } else { "s" })
    }
}

impl Scene {
    /// Loads a model. The caller adds the other files of the model.
    fn loaded(
        name: String,
        main: Vec<u8>,
        files: &dyn ModelFiles,
        view: ViewArguments,
        memory_limit: Option<u64>,
        budget: &MemoryPool,
    ) -> CommandResult<Self> {
        // The error may be in a file that the model refers to. The message then names the model as well.
        let failed = |e: SceneError| if e.file == name { CommandError::bad_input(e) } else { CommandError::in_input(&name)(e) };
        let (scene, held) = load(&main, &name, files, &view.options(budget)?, budget).map_err(failed)?;
        let prepared = PreparedScene::cached(Arc::new(scene), budget);
        Ok(Self { name, made: SceneOrigin::Model(main, BTreeMap::new()), view, memory_limit, prepared, _held: held })
    }
}

/// Arguments of [`Scene::of_files`].
type OfFiles = ((String, Py<PyBytes>), BTreeMap<String, Py<PyBytes>>, ViewArguments, Option<u64>);

/// Constructor and arguments that rebuild a scene.
#[derive(IntoPyObject)]
pub enum RebuildCall<'py> {
    Demo(Bound<'py, PyAny>, (String, ViewArguments, Option<u64>)),
    Model(Bound<'py, PyAny>, OfFiles),
}

/// The folder of a model. Keeps the files read from it, to rebuild the scene elsewhere.
struct ModelFolder {
    folder: FolderFiles,
    read: RefCell<(BTreeMap<String, Vec<u8>>, MemoryReservation)>,
}

impl ModelFolder {
    fn of(path: &Path, allow_outside: bool, budget: &MemoryPool) -> Self {
        let folder = path.parent().unwrap_or(Path::new(""));
        let folder = FolderFiles::new(folder).allow_outside(allow_outside);
        Self { folder, read: RefCell::new((BTreeMap::new(), budget.empty_reservation())) }
    }

    /// Reads the model itself.
    fn main(&self, path: &Path, budget: &MemoryPool) -> io::Result<(Vec<u8>, MemoryReservation)> {
        let name = path.file_name().and_then(|name| name.to_str());
        self.folder.read(name.ok_or_else(|| io::Error::other("expected a file with a name in UTF-8"))?, budget)
    }

    fn into_read(self) -> (BTreeMap<String, Vec<u8>>, MemoryReservation) {
        self.read.into_inner()
    }
}

impl ModelFiles for ModelFolder {
    fn read(&self, relative: &str, budget: &MemoryPool) -> io::Result<(Vec<u8>, MemoryReservation)> {
        let (bytes, held) = self.folder.read(relative, budget)?;
        let (files, kept) = &mut *self.read.borrow_mut();
        kept.try_grow(bytes.len() as u64, "files of a model")?;
        files.insert(relative.into(), bytes.clone());
        Ok((bytes, held))
    }
}

/// A display list, the output of a geometry processor. Each run reads it again. It pickles as its path.
#[pyclass(frozen, module = "basrelief")]
#[derive(Clone)]
pub struct DisplayList {
    /// Name as given by the user.
    name: String,
    path: PathBuf,
}

#[pymethods]
impl DisplayList {
    #[new]
    fn new(path: PathBuf) -> PythonResult<Self> {
        let name = path.display().to_string();
        let path = std::path::absolute(&path).map_err(cannot_be_read(&name))?;
        let list = Self { name, path };
        if list.is_one()? {
            return Ok(list);
        }
        Err(CommandError::usage(format_args!("{}: not a display list: basrelief.scene opens a model", list.name)).into())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, (PathBuf,)) {
        (py.get_type::<Self>(), (self.path.clone(),))
    }

    /// Name as given by the user.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    fn __repr__(&self) -> String {
        format!("DisplayList({:?})", self.name)
    }
}

impl DisplayList {
    /// Makes a display list from a file that a plan names.
    pub fn of_plan(path: &Path) -> Self {
        Self { name: path.display().to_string(), path: path.into() }
    }

    /// Returns true for a display list, recognized by its first bytes or by its name.
    pub fn is_one(&self) -> CommandResult<bool> {
        let mut start = Vec::new();
        self.opened()?.take(64).read_to_end(&mut start).map_err(cannot_be_read(&self.name))?;
        Ok(looks_like_trace(&start) || TraceForm::for_file_name(&self.name).is_some())
    }

    /// Opens the file. Rejects pipes, because each run reads the file from its beginning.
    fn opened(&self) -> CommandResult<File> {
        let cannot = cannot_be_read(&self.name);
        if !fs::metadata(&self.path).map_err(&cannot)?.is_file() {
            return Err(cannot(io::Error::other("not a regular file")));
        }
        File::open(&self.path).map_err(&cannot)
    }
}

fn cannot_be_read(name: &str) -> impl Fn(io::Error) -> CommandError {
    move |error| match OverBudget::in_io_error(&error) {
        Some(error) => CommandError::in_input(name)(error),
        None if is_demo(name) => {
            CommandError::bad_input(format_args!("{name}: cannot be read: {error}; basrelief.demo opens a demo"))
        }
        None => CommandError::at_file(Path::new(name), "be read")(error),
    }
}

/// Reads a text file, such as a configuration or a camera.
#[pyfunction]
pub fn read_text(py: Python<'_>, path: PathBuf) -> PythonResult<String> {
    Ok(py.detach(|| text_of(&path, &budget(MemoryPool::DEFAULT)))?)
}

/// Reads a text file within a memory limit.
pub fn text_of(path: &Path, budget: &MemoryPool) -> CommandResult<String> {
    let read = basrelief_input::read_text(path, budget);
    read.map(|(text, _)| text).map_err(cannot_be_read(&path.display().to_string()))
}

/// Input of a run.
#[derive(FromPyObject)]
pub enum RunSubject<'py> {
    #[pyo3(transparent)]
    Scene(PyRef<'py, Scene>),
    #[pyo3(transparent)]
    DisplayList(PyRef<'py, DisplayList>),
}

/// Input of a run, usable without the interpreter lock.
pub enum RunSource {
    Scene(PreparedScene),
    DisplayList(DisplayList),
}

impl RunSubject<'_> {
    pub fn source(&self) -> RunSource {
        match self {
            Self::Scene(scene) => RunSource::Scene(scene.prepared.clone()),
            Self::DisplayList(list) => RunSource::DisplayList((*list).clone()),
        }
    }
}

impl RunSource {
    /// Returns the input of one run, from its beginning.
    pub fn input(&self) -> CommandResult<RunInput> {
        match self {
            Self::Scene(prepared) => Ok(RunInput::Scene(prepared.clone())),
            Self::DisplayList(list) => {
                let reader = Box::new(BufReader::new(list.opened()?));
                let folder = list.path.parent().unwrap_or(Path::new(""));
                Ok(RunInput::Trace { reader, files: Box::new(open_in_folder(folder)), name: list.name.clone() })
            }
        }
    }

    /// Returns the file that every run reads, if there is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Scene(_) => None,
            Self::DisplayList(list) => Some(&list.path),
        }
    }
}
