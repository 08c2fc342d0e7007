//! Declaration of an auxiliary output: a name, a form, and a function that makes the output from an entry of the log.

use super::aux_output::{AuxContent, AuxForm, AuxOutput, AuxOutputInfo};
use crate::observer::Observer;
use basrelief_reference::RgbPicture;
use std::io::{self, Write};

/// Auxiliary output of a machine with configuration `S` and log entries `L`.
pub struct AuxOutputSpec<S, L> {
    pub(crate) info: AuxOutputInfo,
    make: OutputMaker<S, L>,
}

type LineWriter<L> = fn(u32, &L, &mut dyn Write) -> io::Result<()>;

/// Source of an auxiliary output.
enum OutputMaker<S, L> {
    /// A picture that the machine has finished.
    Round,
    /// A picture made from an entry of the log; `None` for other entries.
    Picture(fn(&S, &L) -> Option<RgbPicture>),
    /// Lines made from an entry of the log and the number of its frame; no lines for other entries.
    Lines(LineWriter<L>),
}

impl<S, L> AuxOutputSpec<S, L> {
    pub(super) const fn picture(
        name: &'static str,
        form: AuxForm,
        about: &'static str,
        make: fn(&S, &L) -> Option<RgbPicture>,
    ) -> Self {
        Self { info: AuxOutputInfo { name, about, form, judges: false }, make: OutputMaker::Picture(make) }
    }

    pub(super) const fn rounds(name: &'static str, about: &'static str) -> Self {
        Self { info: AuxOutputInfo { name, about, form: AuxForm::PicturePerRound, judges: false }, make: OutputMaker::Round }
    }

    pub(super) const fn lines(name: &'static str, about: &'static str, make: LineWriter<L>) -> Self {
        Self { info: AuxOutputInfo { name, about, form: AuxForm::Lines, judges: false }, make: OutputMaker::Lines(make) }
    }

    pub(super) const fn with_judgement(mut self) -> Self {
        self.info.judges = true;
        self
    }

    /// Makes the output from an entry of the log, and passes it to the observer.
    pub(crate) fn show(&self, spec: &S, (frame, entry): &(u32, L), observer: &mut dyn Observer) -> Result<(), String> {
        let (info, frame) = (self.info, *frame);
        match self.make {
            OutputMaker::Round => Ok(()),
            OutputMaker::Lines(make) => {
                let lines = |out: &mut dyn Write| make(frame, entry, out);
                observer.aux_output(&AuxOutput { info, frame, content: AuxContent::Lines(&lines) })
            }
            OutputMaker::Picture(make) => {
                let Some(picture) = make(spec, entry) else { return Ok(()) };
                let content = match file_name(info, frame) {
                    Some(name) => AuxContent::NamedPicture(name, &picture),
                    None => AuxContent::Picture(&picture),
                };
                observer.aux_output(&AuxOutput { info, frame, content })
            }
        }
    }
}

/// Passes a picture of a frame that is shown in increasing quality to the observer.
pub(crate) fn show_round(
    info: AuxOutputInfo,
    [frame, round]: [u32; 2],
    picture: &RgbPicture,
    observer: &mut dyn Observer,
) -> Result<(), String> {
    let content = AuxContent::NamedPicture(round_name(info.name, frame, round), picture);
    observer.aux_output(&AuxOutput { info, frame, content })
}

fn file_name(info: AuxOutputInfo, frame: u32) -> Option<String> {
    match info.form {
        AuxForm::NamedPicturePerFrame if frame > 0 => Some(format!("{}-{:04}.png", info.name, frame + 1)),
        AuxForm::NamedPicturePerFrame | AuxForm::PictureAtEnd => Some(format!("{}.png", info.name)),
        AuxForm::PicturePerFrame | AuxForm::PicturePerRound | AuxForm::Lines => None,
    }
}

fn round_name(name: &str, frame: u32, round: u32) -> String {
    if frame == 0 { format!("{name}-round-{round}.png") } else { format!("{name}-{:04}-round-{round}.png", frame + 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_later_frames_have_numbers() {
        assert_eq!([round_name("image", 0, 2), round_name("image", 4, 0)], ["image-round-2.png", "image-0005-round-0.png"]);
        let info = |form| AuxOutputInfo { name: "layer-depth", about: "", form, judges: false };
        let named = |frame| file_name(info(AuxForm::NamedPicturePerFrame), frame);
        assert_eq!([named(0), named(1)], [Some("layer-depth.png".into()), Some("layer-depth-0002.png".into())]);
        assert_eq!(file_name(info(AuxForm::PicturePerFrame), 1), None, "numbered once the number of frames is known");
    }
}
