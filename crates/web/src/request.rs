//! Questions.

use basrelief_scene::ViewOptions;
use serde::Deserialize;

/// A question.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Request {
    /// Lists machines and demos.
    Catalogue,
    /// Selects a demo as input.
    Demo {
        name: String,
    },
    /// Selects a model or a display list as input, with its neighbouring files.
    Files {
        /// Name of the main file.
        name: String,
        files: Vec<RequestFile>,
    },
    /// Selects the scene of the page's server as input. Messages show the address `server`.
    From {
        server: String,
    },
    Run(RunRequest),
    /// Repeats a run as one side of a comparison, and keeps its recording.
    Record {
        side: ComparedSide,
        run: RunRequest,
    },
    /// Explains the difference between the two recorded runs.
    Explain,
    /// Repeats a run and returns pictures of its pixel costs.
    Costs(RunRequest),
    /// Takes a response that the page has fetched for a draft. The body is after the JSON of the question.
    Received {
        address: String,
        status: u16,
        tag: String,
    },
    /// Repeats a run and returns each step and each wait in its `cycles`.
    Steps(RunRequest),
    /// Returns the details of a pixel of the last `Costs` run; null if there was none.
    Pixel {
        x: u32,
        y: u32,
    },
}

/// Side of a comparison.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ComparedSide {
    A,
    B,
}

/// A file after the JSON of the question.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RequestFile {
    /// Path relative to the main file, with `/` between folders.
    pub(crate) name: String,
    /// Offset and length.
    pub(crate) at: [usize; 2],
}

/// Parameters of one run of the current input.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunRequest {
    pub(crate) machine: String,
    /// Settings that override the defaults, by key.
    pub(crate) set: Vec<(String, String)>,
    pub(crate) view: ViewRequest,
    /// Also draw the reference image and measure the difference.
    #[serde(default)]
    pub(crate) exact: bool,
    /// Measure the bottlenecks if the run is short.
    #[serde(default)]
    pub(crate) limits: bool,
    /// Addresses that the page fetches or has queued. If they are given, a server's scene is drawn with the tiles that are here. If tiles are
    /// missing, the answer is a draft with their addresses.
    #[serde(default)]
    pub(crate) draft: Option<Vec<String>>,
    /// First cycle and end of the cycles whose steps are listed.
    #[serde(default)]
    pub(crate) cycles: [u64; 2],
}

/// View of a scene, with the options of the command line.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct ViewRequest {
    pub(crate) size: Option<[u32; 2]>,
    pub(crate) turn: Option<[f64; 2]>,
    pub(crate) zoom: Option<f64>,
    pub(crate) light: Option<[f64; 3]>,
    pub(crate) frames: Option<u32>,
    pub(crate) orbit: Option<f64>,
}

impl ViewRequest {
    pub(crate) fn options(&self) -> ViewOptions {
        let default = ViewOptions::default();
        ViewOptions {
            size: self.size.unwrap_or(default.size),
            turn: self.turn,
            zoom: self.zoom,
            light: self.light,
            frames: self.frames,
            orbit_degrees: self.orbit,
            ..default
        }
    }
}
