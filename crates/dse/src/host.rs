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

/// Error of an input that cannot be opened, with the part of the plan that is at fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// The input is at fault.
    #[error("{0}")]
    Input(String),
    /// An option of the view is wrong, or does not fit the input.
    #[error("{option}: {message}")]
    View {
        /// Name in the plan.
        option: String,
        /// The error, the expectation and the cure.
        message: String,
    },
}

impl OpenError {
    /// Resolves the options of a view.
    ///
    /// # Errors
    /// The error of `resolve`, for the first option that is wrong, alone or together with the options before it.
    pub fn in_view<T>(view: &[(String, String)], resolve: impl Fn(&[(String, String)]) -> Result<T, String>) -> Result<T, Self> {
        resolve(view).map_err(|whole| {
            let of_part = |count: usize| Some((count, resolve(&view[..count]).err()?));
            let (count, message) = (1..view.len()).find_map(of_part).unwrap_or((view.len(), whole));
            let option = view[..count].last().map(|(name, _)| name.clone()).unwrap_or_default();
            Self::View { option, message }
        })
    }

    /// Creates the error of a view option for a trace.
    pub fn view_of_trace(trace: &str, option: &str) -> Self {
        let message = format!("{trace} is a trace, which has its own view; move it into a plan without views");
        Self::View { option: option.into(), message }
    }

    /// Creates the error of a place in a scene. If the place is an option of the view, such as `camera` in `/camera/to_light`, the error is
    /// that of the option and has the message `of_option`. Otherwise, it is that of the input and has the message `of_input`.
    pub fn at_place(place: &str, view: &[(String, String)], of_option: String, of_input: String) -> Self {
        let name = place.trim_start_matches('/').split('/').next().unwrap_or_default();
        match view.iter().find(|(option, _)| option == name) {
            Some((option, _)) => Self::View { option: option.clone(), message: of_option },
            None => Self::Input(of_input),
        }
    }
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
    /// An input that cannot be read, or a wrong option.
    fn open(&self, name: &str, view: &[(String, String)]) -> Result<OpenedInput, OpenError>;

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
