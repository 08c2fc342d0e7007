//! What a run writes while it goes on: pictures, dumps, progress.

use super::dump::Dumps;
use crate::outputs::Outputs;
use crate::progress::Progress;
use basrelief_reference::{Picture, metrics};
use basrelief_session::{DisplacementMap, FrameLog, Observer, Pictures, displacement_picture, divisions_picture, picture_name};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::cell::Cell;
use std::io::Write;
use std::rc::Rc;

/// Files, progress and pictures of a run.
pub struct Watcher {
    pub outputs: Outputs,
    pub progress: Progress,
    /// Bytes of a trace read so far; a scene counts commands instead.
    pub read: Option<Rc<Cell<u64>>>,
    pub dumps: Dumps,
    /// Of the pictures that machine `texel` has beside its own; `None` where they are not wanted.
    pub error_bound: Option<f64>,
    pub frames: usize,
    /// Of the pictures written so far, in the order in which they were.
    pub kinds: Vec<&'static str>,
    /// Of the frame that comes next.
    pub map: Option<DisplacementMap>,
}

impl Observer for Watcher {
    fn progress(&mut self, commands: u64, _: Option<u64>) -> bool {
        self.progress.at(self.read.as_ref().map_or(commands, |read| read.get()));
        true
    }

    fn texels(&mut self, index: usize, log: &FrameLog) -> Result<(), String> {
        self.map = self.error_bound.map(|_| log.map.clone());
        self.dumps.texels(index, log)
    }

    fn frame(&mut self, pictures: &Pictures<'_>) -> Result<(), String> {
        let index = pictures.index;
        self.frames = index + 1;
        self.save("image", index, pictures.machine)?;
        if let Some((exact, _)) = pictures.exact {
            self.save("reference", index, exact)?;
            let difference = metrics::difference(exact, pictures.machine).map_err(|e| e.to_string())?;
            self.save("difference", index, &difference)?;
        }
        let (Some(map), Some(error_bound)) = (self.map.take(), self.error_bound) else { return Ok(()) };
        self.save("displacement", index, &displacement_picture(&map, error_bound))?;
        self.save("divisions", index, &divisions_picture(pictures.machine, &map))
    }
}

impl Watcher {
    fn save(&mut self, kind: &'static str, index: usize, picture: &Picture) -> Result<(), String> {
        if !self.kinds.contains(&kind) {
            self.kinds.push(kind);
        }
        let name = picture_name(kind, index, true);
        let failed = |e: &dyn std::fmt::Display| format!("{name}: cannot be written: {e}");
        let mut file = self.outputs.create(&name).map_err(|e| failed(&e))?;
        PngEncoder::new(&mut file)
            .write_image(&picture.to_rgba(), picture.width, picture.height, ExtendedColorType::Rgba8)
            .map_err(|e| failed(&e))?;
        file.flush().map_err(|e| failed(&e))
    }
}
