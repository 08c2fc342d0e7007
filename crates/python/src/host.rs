//! Services that Python provides to a sweep: files of a plan, and checks for Ctrl-C.

use crate::error::{CommandError, CommandResult};
use crate::scene::{DisplayList, RunSource, ViewArguments, text_of};
use basrelief_dse::{OpenError, OpenedInput, SweepHost, SweepProgress};
use basrelief_input::MemoryPool;
use basrelief_outputs::PartialFile;
use basrelief_reference::RgbPicture;
use basrelief_scene::{ImportOptions, SceneError, demo, load_path_with};
use basrelief_sim::{PreparedScene, RunInput, existing_in_plan, reason_and_cure, to_png};
use pyo3::{PyErr, Python};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Access to the files that a plan names.
pub struct PlanFiles {
    /// Path of the plan; empty for a sensitivity analysis, whose files are relative to the working directory.
    pub plan: PathBuf,
    pub budget: MemoryPool,
}

impl PlanFiles {
    fn path_of(&self, name: &str) -> PathBuf {
        self.plan.parent().map_or_else(|| name.into(), |folder| folder.join(name))
    }

    /// Returns the path of a file that the plan names and that exists.
    fn existing_path_of(&self, name: &str) -> Result<PathBuf, String> {
        existing_in_plan(&self.plan, self.path_of(name))
    }

    /// Reads a camera file. Returns its name and its text.
    fn camera(&self, name: &str) -> CommandResult<(String, String)> {
        let path = self.existing_path_of(name).map_err(CommandError::BadInput)?;
        Ok((path.display().to_string(), text_of(&path, &self.budget)?))
    }

    fn opened(&self, name: &str, options: &[(String, String)]) -> Result<OpenedInput, OpenError> {
        let budget = &self.budget;
        let resolved = |options: &[(String, String)]| {
            let view = ViewArguments::of_plan(options, |name| self.camera(name))?;
            view.options(budget).map(|resolved| (view, resolved)).map_err(|error| error.to_string())
        };
        let (view, resolved) = OpenError::in_view(options, resolved)?;
        let at_place = |error: &SceneError, of_input: String| {
            OpenError::at_place(&error.place, options, error.in_option().to_string(), of_input)
        };
        let kept = |scene| OpenedInput::Scene(PreparedScene::cached(Arc::new(scene), budget));
        if let Some(name) = name.strip_prefix("demo:") {
            let opened = demo(name, &resolved).map(kept);
            return opened.map_err(|error| at_place(&error, error.to_string()));
        }
        let path = self.existing_path_of(name).map_err(OpenError::Input)?;
        if DisplayList::of_plan(&path).is_one().map_err(|error| OpenError::Input(error.to_string()))? {
            let option = options.first().filter(|_| !view.is_default());
            return option.map_or(Ok(OpenedInput::Trace), |(option, _)| Err(OpenError::view_of_trace(name, option)));
        }
        let shown = path.display().to_string();
        let import = ImportOptions { budget: budget.clone(), ..ImportOptions::default() };
        let (scene, held) = load_path_with(&path, &resolved, &import).map_err(|error| {
            let within = if error.file == shown { String::new() } else { format!("{shown}: ") };
            at_place(&error, format!("{within}{error}"))
        })?;
        // Released with the memory limit of the plan.
        held.keep_forever();
        Ok(kept(scene))
    }
}

/// Services that Python provides to a sweep.
pub struct PythonHost<'a> {
    files: &'a PlanFiles,
    /// Exception raised by Ctrl-C.
    stopped: Mutex<Option<PyErr>>,
}

impl SweepHost for PythonHost<'_> {
    fn open(&self, name: &str, view: &[(String, String)]) -> Result<OpenedInput, OpenError> {
        self.files.opened(name, view)
    }

    fn trace(&self, name: &str) -> Result<RunInput, String> {
        RunSource::DisplayList(DisplayList::of_plan(&self.files.path_of(name))).input().map_err(|failure| failure.to_string())
    }

    fn text(&self, name: &str) -> Result<String, String> {
        text_of(&self.files.existing_path_of(name)?, &self.files.budget).map_err(|failure| failure.to_string())
    }

    fn png(&self, picture: &RgbPicture) -> Result<Vec<u8>, String> {
        to_png(picture)
    }

    fn publish(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.check_interrupt()?;
        let created = path.parent().map_or(Ok(()), std::fs::create_dir_all);
        let written = created.and_then(|()| PartialFile::write_whole(path, bytes));
        written.map_err(|error| io::Error::new(error.kind(), reason_and_cure(path, "be written", &error)))
    }

    fn progress(&self, _: &SweepProgress) {}

    fn is_stopped(&self) -> bool {
        self.check_interrupt().is_err()
    }

    fn budget(&self) -> &MemoryPool {
        &self.files.budget
    }
}

impl<'a> PythonHost<'a> {
    pub fn new(files: &'a PlanFiles) -> Self {
        Self { files, stopped: Mutex::default() }
    }

    /// Takes the exception that stopped the sweep.
    pub fn stopped(&self) -> Option<PyErr> {
        self.stopped.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Returns an error once the user has pressed Ctrl-C, so that nothing more is written.
    fn check_interrupt(&self) -> io::Result<()> {
        let mut stopped = self.stopped.lock().unwrap_or_else(PoisonError::into_inner);
        if stopped.is_none() {
            *stopped = Python::attach(|py| py.check_signals()).err();
        }
        if stopped.is_some() { Err(ErrorKind::Interrupted.into()) } else { Ok(()) }
    }
}
