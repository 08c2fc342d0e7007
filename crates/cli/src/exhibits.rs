//! What a machine shows beside its pictures: more pictures, and files of lines.

use crate::error::{Done, Failure};
use crate::outputs::PartialFile;
use basrelief_reference::Picture;
use basrelief_session::{Exhibit, MachineInfo, dump};
use std::path::PathBuf;

/// What `--dump` can write, and the machine that has it.
const DUMPS: [(&str, &str); 2] = [("reference-buffer", "defer"), ("tiles", "defer")];

/// A file of lines that is being written.
#[derive(Debug)]
struct Dump {
    what: &'static str,
    path: PathBuf,
    file: PartialFile,
}

/// Files of `--dump`.
#[derive(Debug, Default)]
pub struct Dumps(Vec<Dump>);

impl Dumps {
    /// Opens the files that `--dump` names, in pairs of what and where.
    pub fn begin(asked: &[String], machine: &MachineInfo) -> Done<Self> {
        let dump = |pair: &[String]| {
            let (what, path) = (pair[0].as_str(), PathBuf::from(&pair[1]));
            let what = known(what, machine).map_err(Failure::Usage)?;
            let file = PartialFile::create(&path).map_err(Failure::file(&path, "be written"))?;
            Ok(Dump { what, path, file })
        };
        asked.chunks_exact(2).map(dump).collect::<Done<_>>().map(Self)
    }

    /// Writes the lines of an exhibit into the files that want them.
    pub fn write(&mut self, exhibit: &Exhibit) -> Result<(), String> {
        for Dump { what, path, file } in &mut self.0 {
            let written = match (*what, exhibit) {
                ("reference-buffer", Exhibit::ReferenceBuffer(filled)) => dump::write_reference_buffer(filled, file),
                ("tiles", Exhibit::Tiles { frame, tiles }) => dump::write_tiles(*frame, tiles, file),
                _ => Ok(()),
            };
            written.map_err(|e| format!("{}: cannot be written: {e}", path.display()))?;
        }
        Ok(())
    }

    /// Puts all files in their place.
    pub fn publish(self) -> Done {
        self.0.into_iter().try_for_each(|d| d.file.publish().map_err(Failure::file(&d.path, "be written")))
    }
}

/// The name as it stands in [`DUMPS`].
fn known(what: &str, machine: &MachineInfo) -> Result<&'static str, String> {
    let names: Vec<&str> = DUMPS.iter().map(|d| d.0).collect();
    match DUMPS.iter().find(|d| d.0 == what) {
        None => Err(format!("--dump `{what}`: expected {}", names.join(" or "))),
        Some((_, of)) if *of != machine.name => {
            Err(format!("--dump {what}: machine `{}` has none; it is kept by machine `{of}`", machine.name))
        }
        Some((name, _)) => Ok(name),
    }
}

/// The picture that an exhibit makes, and its name.
pub fn picture(exhibit: &Exhibit) -> Option<(String, Picture)> {
    match exhibit {
        Exhibit::Round(shown) => {
            let p = &shown.picture;
            let picture = Picture { width: p.width, height: p.height, rgb: p.rgb.clone(), covered: p.covered.clone() };
            Some((round_name(p.index, shown.round), picture))
        }
        Exhibit::ReferenceBuffer(filled) => Some((depth_name(filled.frame), dump::layer_depth(filled))),
        Exhibit::TileLists(lists) => Some(("tiles.png".into(), dump::tile_map(lists))),
        Exhibit::Tiles { .. } => None,
    }
}

/// `image-round-0.png`, and with the number of the frame for all but the first.
pub fn round_name(frame: u32, round: u32) -> String {
    if frame == 0 { format!("image-round-{round}.png") } else { format!("image-{:04}-round-{round}.png", frame + 1) }
}

/// `layer-depth.png`, and with the number of the frame for all but the first.
fn depth_name(frame: u32) -> String {
    if frame == 0 { "layer-depth.png".into() } else { format!("layer-depth-{:04}.png", frame + 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dump_that_the_machine_does_not_have_is_refused_with_the_machine_that_has_it() {
        let [bump, defer] = ["bump", "defer"].map(|name| MachineInfo::named(name).unwrap());
        assert_eq!(known("tiles", defer), Ok("tiles"));
        assert!(known("tiles", bump).unwrap_err().contains("kept by machine `defer`"));
        assert!(known("tile", defer).unwrap_err().contains("expected reference-buffer or tiles"));
    }

    #[test]
    fn pictures_of_later_frames_carry_their_number() {
        assert_eq!([round_name(0, 2), round_name(4, 0)], ["image-round-2.png", "image-0005-round-0.png"]);
        assert_eq!([depth_name(0), depth_name(1)], ["layer-depth.png", "layer-depth-0002.png"]);
    }
}
