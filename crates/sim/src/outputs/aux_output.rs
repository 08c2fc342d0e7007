//! Auxiliary output, as the observer receives it.

use basrelief_reference::RgbPicture;
use std::fmt;
use std::io::{self, Write};

/// Description of an auxiliary output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AuxOutputInfo {
    /// Name of the output and of its files.
    pub name: &'static str,
    /// Description in a few words.
    pub about: &'static str,
    /// AuxForm of the output.
    pub form: AuxForm,
    /// True if the output compares the machine with exact results. It is then made only together with the reference image.
    pub judges: bool,
}

/// AuxForm of an auxiliary output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AuxForm {
    /// One picture per frame, numbered like the machine's images.
    PicturePerFrame,
    /// One picture per frame with its own file name: `layer-depth.png`, then `layer-depth-0002.png`.
    NamedPicturePerFrame,
    /// All pictures of a frame that is shown in increasing quality: `image-round-0.png`. The names contain the number of the frame, except
    /// for the first frame.
    PicturePerRound,
    /// One picture at the end of the run.
    PictureAtEnd,
    /// JSON lines.
    Lines,
}

/// Auxiliary output of a run.
#[derive(Debug)]
pub struct AuxOutput<'a> {
    /// Description.
    pub info: AuxOutputInfo,
    /// Number of its frame, from 0; 0 for an output at the end of the run.
    pub frame: u32,
    /// AuxContent.
    pub content: AuxContent<'a>,
}

/// AuxContent of an auxiliary output.
pub enum AuxContent<'a> {
    /// A picture of a frame.
    Picture(&'a RgbPicture),
    /// A picture with its file name.
    NamedPicture(String, &'a RgbPicture),
    /// Writes JSON lines.
    Lines(&'a dyn Fn(&mut dyn Write) -> io::Result<()>),
}

impl fmt::Debug for AuxContent<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Picture(_) => "Picture",
            Self::NamedPicture(..) => "NamedPicture",
            Self::Lines(_) => "Lines",
        })
    }
}
