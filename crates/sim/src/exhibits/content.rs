//! An exhibit as whoever watches a run is handed it.

use basrelief_reference::Picture;
use std::fmt;
use std::io::{self, Write};

/// What there is to know of an exhibit before the machine runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExhibitInfo {
    /// Names it, and its files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// As what it comes.
    pub form: Form,
    /// It holds the machine against what is exact, as the exact picture does, and goes with that.
    pub judges: bool,
}

/// As what an exhibit comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A picture per frame, numbered as the machine's own are.
    PicturePerFrame,
    /// A picture per frame, its file named while the run goes on: the first without a number, `layer-depth.png`, then
    /// `layer-depth-0002.png`.
    NamedPicturePerFrame,
    /// Every picture of a frame that is shown several times, each better than the one before: `image-round-0.png`, and with
    /// the number of the frame for all frames but the first.
    PicturePerRound,
    /// One picture at the end of the run.
    PictureAtEnd,
    /// Lines of JSON.
    Lines,
}

/// An exhibit of a run.
#[derive(Debug)]
pub struct Exhibit<'a> {
    /// Which.
    pub info: ExhibitInfo,
    /// Number of the frame that it belongs to, from 0; at the end of a run, 0.
    pub frame: u32,
    /// Itself.
    pub content: Content<'a>,
}

/// What is shown.
pub enum Content<'a> {
    /// A picture of a frame.
    Picture(&'a Picture),
    /// A picture with the name of its file.
    NamedPicture(String, &'a Picture),
    /// Writes lines of JSON.
    Lines(&'a dyn Fn(&mut dyn Write) -> io::Result<()>),
}

impl fmt::Debug for Content<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Picture(_) => "Picture",
            Self::NamedPicture(..) => "NamedPicture",
            Self::Lines(_) => "Lines",
        })
    }
}
