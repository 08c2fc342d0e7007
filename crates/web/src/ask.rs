//! Questions.

use basrelief_scene::ViewOptions;
use serde::Deserialize;

/// A question.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Ask {
    /// Which machines and demos there are.
    Catalogue,
    /// From now on this demo is drawn.
    Demo {
        name: String,
    },
    /// From now on this is drawn: a model or a display list, and the files beside it.
    Files {
        /// The one to open.
        name: String,
        files: Vec<File>,
    },
    /// From now on what the server offers is drawn that the page comes from: its address, for messages.
    From {
        server: String,
    },
    Run(RunAsk),
    /// The same run for what its pixels cost: pictures of that.
    Costs(RunAsk),
    /// What is known of a pixel of the run whose costs were asked for last; nothing where none were.
    Pixel {
        x: u32,
        y: u32,
    },
}

/// A file behind the question.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    /// Relative to the one to open, `/` between folders.
    pub(crate) name: String,
    /// Place and length.
    pub(crate) at: [usize; 2],
}

/// One run of what is drawn.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunAsk {
    pub(crate) machine: String,
    /// Settings over the defaults, by key.
    pub(crate) set: Vec<(String, String)>,
    pub(crate) view: View,
    /// Draw the exact picture too, and measure against it.
    #[serde(default)]
    pub(crate) exact: bool,
    /// Measure what limits the run, if it is short.
    #[serde(default)]
    pub(crate) limits: bool,
}

/// How a scene is looked at: as the options of the command line.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct View {
    pub(crate) size: Option<[u32; 2]>,
    pub(crate) turn: Option<[f64; 2]>,
    pub(crate) zoom: Option<f64>,
    pub(crate) light: Option<[f64; 3]>,
    pub(crate) frames: Option<u32>,
    pub(crate) orbit: Option<f64>,
}

impl View {
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
