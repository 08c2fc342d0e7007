//! Exhibits: what a machine shows beside its finished pictures. Each machine lists its own ([`ExhibitSpec`]): a name, a form,
//! and how it is made of an entry of the machine's log. Whoever runs the machine says which it wants, and is handed those.

pub(crate) mod defer;
mod heat_map;
mod lettering;
pub(crate) mod texel;
mod tile_lines;
mod tile_pictures;

use crate::machines::MachineSpec;
use crate::observer::Observer;
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

/// An exhibit of a machine.
pub struct ExhibitSpec<S: MachineSpec> {
    pub(crate) info: ExhibitInfo,
    make: Make<S>,
}

type LineWriter<S> = fn(u32, &<S as MachineSpec>::Log, &mut dyn Write) -> io::Result<()>;

/// How an exhibit is made, by the machine's configuration.
enum Make<S: MachineSpec> {
    /// It is a picture that the machine finished.
    Round,
    /// Of an entry of the log, where it is one of those.
    Picture(fn(&S, &S::Log) -> Option<Picture>),
    /// Of an entry of the log, by the number of its frame; of other entries, no lines.
    Lines(LineWriter<S>),
}

impl<S: MachineSpec> ExhibitSpec<S> {
    const fn picture(name: &'static str, form: Form, about: &'static str, make: fn(&S, &S::Log) -> Option<Picture>) -> Self {
        Self { info: ExhibitInfo { name, about, form, judges: false }, make: Make::Picture(make) }
    }

    const fn rounds(name: &'static str, about: &'static str) -> Self {
        Self { info: ExhibitInfo { name, about, form: Form::PicturePerRound, judges: false }, make: Make::Round }
    }

    const fn lines(name: &'static str, about: &'static str, make: LineWriter<S>) -> Self {
        Self { info: ExhibitInfo { name, about, form: Form::Lines, judges: false }, make: Make::Lines(make) }
    }

    const fn judging(mut self) -> Self {
        self.info.judges = true;
        self
    }

    /// Makes it of an entry of the log of frame `frame`, and shows it.
    pub(crate) fn show(&self, spec: &S, (frame, entry): &(u32, S::Log), observer: &mut dyn Observer) -> Result<(), String> {
        let (info, frame) = (self.info, *frame);
        match self.make {
            Make::Round => Ok(()),
            Make::Lines(make) => {
                let lines = |out: &mut dyn Write| make(frame, entry, out);
                observer.exhibit(&Exhibit { info, frame, content: Content::Lines(&lines) })
            }
            Make::Picture(make) => {
                let Some(picture) = make(spec, entry) else { return Ok(()) };
                let content = match file_name(info, frame) {
                    Some(name) => Content::NamedPicture(name, &picture),
                    None => Content::Picture(&picture),
                };
                observer.exhibit(&Exhibit { info, frame, content })
            }
        }
    }
}

/// Shows a picture of a frame that is shown several times.
pub(crate) fn show_round(
    info: ExhibitInfo,
    [frame, round]: [u32; 2],
    picture: &Picture,
    observer: &mut dyn Observer,
) -> Result<(), String> {
    let content = Content::NamedPicture(round_name(info.name, frame, round), picture);
    observer.exhibit(&Exhibit { info, frame, content })
}

fn file_name(info: ExhibitInfo, frame: u32) -> Option<String> {
    match info.form {
        Form::NamedPicturePerFrame if frame > 0 => Some(format!("{}-{:04}.png", info.name, frame + 1)),
        Form::NamedPicturePerFrame | Form::PictureAtEnd => Some(format!("{}.png", info.name)),
        Form::PicturePerFrame | Form::PicturePerRound | Form::Lines => None,
    }
}

fn round_name(name: &str, frame: u32, round: u32) -> String {
    if frame == 0 { format!("{name}-round-{round}.png") } else { format!("{name}-{:04}-round-{round}.png", frame + 1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::MACHINES;

    #[test]
    fn pictures_of_later_frames_carry_their_number() {
        assert_eq!([round_name("image", 0, 2), round_name("image", 4, 0)], ["image-round-2.png", "image-0005-round-0.png"]);
        let info = |form| ExhibitInfo { name: "layer-depth", about: "", form, judges: false };
        let named = |frame| file_name(info(Form::NamedPicturePerFrame), frame);
        assert_eq!([named(0), named(1)], [Some("layer-depth.png".into()), Some("layer-depth-0002.png".into())]);
        assert_eq!(file_name(info(Form::PicturePerFrame), 1), None, "numbered when it is known how many there are");
    }

    /// Lines are asked for by name alone, and a picture's name is that of its file.
    #[test]
    fn no_two_exhibits_of_a_form_have_one_name() {
        let all: Vec<_> = MACHINES.iter().flat_map(|m| m.exhibits()).collect();
        let lines = |e: &ExhibitInfo| e.form == Form::Lines;
        for (n, one) in all.iter().enumerate() {
            let same = |other: &&ExhibitInfo| other.name == one.name && lines(other) == lines(one);
            assert_eq!(all[n..].iter().filter(same).count(), 1, "{}", one.name);
        }
    }
}
