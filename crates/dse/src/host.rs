//! Services that the program provides to a sweep.

use basrelief_input::MemoryPool;
use basrelief_reference::RgbPicture;
use basrelief_sim::{PreparedScene, RunInput};
use std::io;
use std::path::Path;

/// An input that a plan names.
#[derive(Clone, Debug)]
pub enum OpenedInput {
    /// A scene, kept for many runs.
    Scene(PreparedScene),
    /// A display list, which is [opened](SweepHost::trace) for each run.
    Trace,
}

/// Progress of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepProgress {
    /// Points of the sweep.
    pub points: usize,
    /// Points that existed, or that another process added meanwhile.
    pub existing: usize,
    /// Run points.
    pub run: usize,
    /// Resimulated points.
    pub resimulated: usize,
    /// Failed points of those run here.
    pub failed: usize,
    /// Points of another build of the simulator, which are run again.
    pub outdated: usize,
}

impl SweepProgress {
    /// Adds the numbers of another tally.
    pub(crate) fn add(&mut self, other: &Self) {
        self.points += other.points;
        self.existing += other.existing;
        self.run += other.run;
        self.resimulated += other.resimulated;
        self.failed += other.failed;
        self.outdated += other.outdated;
    }

    /// Returns the number of points with results.
    pub fn done(&self) -> usize {
        self.existing + self.run + self.resimulated
    }
}

impl OpenedInput {
    /// The input of one run, from its beginning.
    pub(crate) fn input(&self, name: &str, host: &dyn SweepHost) -> Result<RunInput, String> {
        match self {
            Self::Scene(prepared) => Ok(RunInput::Scene(prepared.clone())),
            Self::Trace => host.trace(name),
        }
    }
}

/// The program around a sweep: it opens files, and writes them so that nothing half-written is ever seen.
pub trait SweepHost: Sync {
    /// Opens a model, `demo:NAME` or a display list, seen with these options: name and value, as the command line takes them.
    ///
    /// # Errors
    /// A sentence that names the input, or the option.
    fn open(&self, name: &str, view: &[(String, String)]) -> Result<OpenedInput, String>;

    /// Opens a display list from its beginning.
    ///
    /// # Errors
    /// A sentence that names the file.
    fn trace(&self, name: &str) -> Result<RunInput, String>;

    /// A text file that the plan names.
    ///
    /// # Errors
    /// A sentence that names the file.
    fn text(&self, name: &str) -> Result<String, String>;

    /// A picture as a PNG file.
    ///
    /// # Errors
    /// A sentence.
    fn png(&self, picture: &RgbPicture) -> Result<Vec<u8>, String>;

    /// Puts a file with these bytes in its place by renaming, folders above it created where absent.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn publish(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;

    /// Reports the progress.
    fn progress(&self, tally: &SweepProgress);

    /// Returns true once the user has stopped the program. Then nothing more is run for results that stay in memory.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Memory limit for inputs and recordings.
    fn budget(&self) -> &MemoryPool;
}
