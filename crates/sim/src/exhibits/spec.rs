//! An exhibit as a machine lists it: a name, a form, and how it is made of an entry of the log.

use super::content::{Content, Exhibit, ExhibitInfo, Form};
use crate::observer::Observer;
use basrelief_reference::Picture;
use std::io::{self, Write};

/// An exhibit of a machine with configuration `S` and entries `L` in its log.
pub struct ExhibitSpec<S, L> {
    pub(crate) info: ExhibitInfo,
    make: Make<S, L>,
}

type LineWriter<L> = fn(u32, &L, &mut dyn Write) -> io::Result<()>;

/// How an exhibit is made, by the machine's configuration.
enum Make<S, L> {
    /// It is a picture that the machine finished.
    Round,
    /// Of an entry of the log, where it is one of those.
    Picture(fn(&S, &L) -> Option<Picture>),
    /// Of an entry of the log, by the number of its frame; of other entries, no lines.
    Lines(LineWriter<L>),
}

impl<S, L> ExhibitSpec<S, L> {
    pub(super) const fn picture(
        name: &'static str,
        form: Form,
        about: &'static str,
        make: fn(&S, &L) -> Option<Picture>,
    ) -> Self {
        Self { info: ExhibitInfo { name, about, form, judges: false }, make: Make::Picture(make) }
    }

    pub(super) const fn rounds(name: &'static str, about: &'static str) -> Self {
        Self { info: ExhibitInfo { name, about, form: Form::PicturePerRound, judges: false }, make: Make::Round }
    }

    pub(super) const fn lines(name: &'static str, about: &'static str, make: LineWriter<L>) -> Self {
        Self { info: ExhibitInfo { name, about, form: Form::Lines, judges: false }, make: Make::Lines(make) }
    }

    pub(super) const fn judging(mut self) -> Self {
        self.info.judges = true;
        self
    }

    /// Makes it of an entry of the log of frame `frame`, and shows it.
    pub(crate) fn show(&self, spec: &S, (frame, entry): &(u32, L), observer: &mut dyn Observer) -> Result<(), String> {
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

    #[test]
    fn pictures_of_later_frames_carry_their_number() {
        assert_eq!([round_name("image", 0, 2), round_name("image", 4, 0)], ["image-round-2.png", "image-0005-round-0.png"]);
        let info = |form| ExhibitInfo { name: "layer-depth", about: "", form, judges: false };
        let named = |frame| file_name(info(Form::NamedPicturePerFrame), frame);
        assert_eq!([named(0), named(1)], [Some("layer-depth.png".into()), Some("layer-depth-0002.png".into())]);
        assert_eq!(file_name(info(Form::PicturePerFrame), 1), None, "numbered when it is known how many there are");
    }
}
