//! A program around a sweep, for tests: demos, display lists in memory, a disk that can fill up.

use basrelief_dse::{OpenError, OpenedInput, Plan, SweepFolder, SweepHost, SweepJob, SweepProgress, execute, tables};
use basrelief_input::MemoryPool;
use basrelief_reference::RgbPicture;
use basrelief_scene::{ViewOptions, demo};
use basrelief_sim::{PreparedScene, RunInput, doc_trace};
use std::fs;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Fields that every plan needs.
pub const HEAD: &str = "input = \"demo:ellipsoid@1\"\nmachine = \"bump\"\nobjectives = [\"cycles min\"]\n";

/// The program.
pub struct Program {
    budget: MemoryPool,
    /// Files that may still be written.
    room: AtomicUsize,
}

impl Program {
    pub fn new() -> Self {
        Self::with_room(usize::MAX)
    }

    pub fn with_room(files: usize) -> Self {
        Self { budget: MemoryPool::default(), room: AtomicUsize::new(files) }
    }
}

impl SweepHost for Program {
    fn open(&self, name: &str, view: &[(String, String)]) -> Result<OpenedInput, OpenError> {
        if name == "quad.dl.jsonl" {
            return Ok(OpenedInput::Trace);
        }
        let Some(name) = name.strip_prefix("demo:") else { return Err(OpenError::Input(format!("{name}: cannot be read"))) };
        if let Some((name, _)) = view.iter().find(|(name, _)| !["frames", "orbit", "turn"].contains(&name.as_str())) {
            return Err(OpenError::View { option: name.clone(), message: format!("no option is called `{name}`") });
        }
        let value = |option: &str| view.iter().find(|(name, _)| name == option).map(|(_, value)| value.as_str());
        let frames = value("frames").map(|frames| frames.parse().unwrap());
        let turn = value("turn").and_then(|turn| turn.split_once(',')).map(|(x, y)| [x, y].map(|angle| angle.parse().unwrap()));
        let orbit_degrees = value("orbit").map(|degrees| degrees.parse().unwrap());
        let options = ViewOptions { size: [40, 30], frames, turn, orbit_degrees, ..ViewOptions::default() };
        let scene = demo(name, &options)
            .map_err(|error| OpenError::at_place(&error.place, view, error.in_option().to_string(), error.to_string()))?;
        Ok(OpenedInput::Scene(PreparedScene::cached(Arc::new(scene), &self.budget)))
    }

    fn trace(&self, name: &str) -> Result<RunInput, String> {
        Ok(RunInput::trace(Cursor::new(doc_trace()), name))
    }

    fn text(&self, name: &str) -> Result<String, String> {
        match name {
            "wide.toml" => Ok("replacement.lanes = 16".into()),
            "wrong.toml" => Ok("[replacement]\nlanes = 0".into()),
            "broken.toml" => Ok("[replacement".into()),
            _ => Err(format!("{name}: cannot be read")),
        }
    }

    fn png(&self, picture: &RgbPicture) -> Result<Vec<u8>, String> {
        Ok(picture.to_rgba())
    }

    fn publish(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let left = self.room.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |room| room.checked_sub(1));
        left.map_err(|_| io::ErrorKind::StorageFull)?;
        fs::create_dir_all(path.parent().unwrap())?;
        fs::write(path, bytes)
    }

    fn progress(&self, _: &SweepProgress) {}

    fn budget(&self) -> &MemoryPool {
        &self.budget
    }
}

/// A plan that is right.
pub fn plan(text: &str, host: &Program) -> Plan {
    Plan::read(text, host).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Runs a plan on so many threads, and writes its tables.
pub fn sweep(text: &str, folder: &Path, threads: usize) -> (Plan, SweepProgress) {
    let host = Program::new();
    let plan = plan(text, &host);
    let folder = SweepFolder::new(folder);
    let points: Vec<_> = plan.points.iter().collect();
    let work = SweepJob { points: &points, retry_failed: false, pictures: true, threads };
    let tally = execute(&plan, &work, &folder, &host).unwrap();
    tables(&plan, &folder, &host).unwrap();
    (plan, tally)
}

/// All files below, by their paths, with their bytes.
pub fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    collect(folder, folder, &mut all);
    all.sort();
    all
}

fn collect(top: &Path, folder: &Path, all: &mut Vec<(PathBuf, Vec<u8>)>) {
    for path in fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            collect(top, &path, all);
        } else {
            all.push((path.strip_prefix(top).unwrap().into(), fs::read(&path).unwrap()));
        }
    }
}
