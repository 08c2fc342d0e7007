//! What a run writes while it goes on: pictures, dumps, progress.

use super::dump::Dumps;
use crate::error::Failure;
use crate::exhibits::{self, round_name};
use crate::outputs::Outputs;
use crate::progress::Progress;
use basrelief_reference::{Picture, metrics};
use basrelief_session::{
    DisplacementMap, Exhibit, FrameLog, Observer, Pictures, displacement_picture, divisions_picture, picture_name,
};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::cell::Cell;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::rc::Rc;

/// Files, progress and pictures of a run.
pub struct Watcher {
    /// In front of the outputs: a dump that is given up must be gone before the folder that was made for both.
    pub dumps: Dumps,
    pub outputs: Outputs,
    pub progress: Progress,
    /// Bytes of a trace read so far; a scene counts commands instead.
    pub read: Option<Rc<Cell<u64>>>,
    /// Of the pictures that machine `texel` has beside its own; `None` where they are not wanted.
    pub error_bound: Option<f64>,
    pub frames: usize,
    /// Of the pictures written so far, in the order in which they were.
    pub kinds: Vec<&'static str>,
    /// Of the frame that comes next.
    pub map: Option<DisplacementMap>,
    /// Pictures of the current frame that are not its last; `None` where it has only one.
    pub rounds: Option<u32>,
    /// Names of the pictures that machine `defer` has beside its own.
    pub extra: Vec<String>,
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
        if let Some(rounds) = &mut self.rounds {
            let last = round_name(index as u32, std::mem::take(rounds));
            self.write(&last, pictures.machine)?;
            self.extra.push(last);
        }
        if let Some((exact, _)) = pictures.exact {
            self.save("reference", index, exact)?;
            let difference = metrics::difference(exact, pictures.machine).map_err(|e| e.to_string())?;
            self.save("difference", index, &difference)?;
        }
        let (Some(map), Some(error_bound)) = (self.map.take(), self.error_bound) else { return Ok(()) };
        self.save("displacement", index, &displacement_picture(&map, error_bound))?;
        self.save("divisions", index, &divisions_picture(pictures.machine, &map))
    }

    fn exhibit(&mut self, exhibit: &Exhibit) -> Result<(), String> {
        if let (Some(rounds), Exhibit::Round(_)) = (&mut self.rounds, exhibit) {
            *rounds += 1;
        }
        self.dumps.exhibit(exhibit)?;
        let Some((name, picture)) = exhibits::picture(exhibit) else { return Ok(()) };
        self.write(&name, &picture)?;
        self.extra.push(name);
        Ok(())
    }
}

impl Watcher {
    /// A run has failed: the best picture of a frame that was under way stays, if there was any.
    pub fn rescue(self, error: Failure) -> Failure {
        let Some(best) = self.rounds.and_then(|rounds| rounds.checked_sub(1)).map(|round| round_name(self.frames as u32, round))
        else {
            return error;
        };
        match self.outputs.copy(&best, "image.png").and_then(|()| self.outputs.publish("image.png")) {
            Ok(()) => error,
            Err(e) => Failure::Bad(format!("{error}\nThe best picture so far cannot be written: {e}")),
        }
    }

    fn save(&mut self, kind: &'static str, index: usize, picture: &Picture) -> Result<(), String> {
        if !self.kinds.contains(&kind) {
            self.kinds.push(kind);
        }
        self.write(&picture_name(kind, index, true), picture)
    }

    fn write(&mut self, name: &str, picture: &Picture) -> Result<(), String> {
        let failed = |e: &dyn std::fmt::Display| format!("{}: cannot be written: {e}", self.outputs.place(name).display());
        // In memory: the encoder would wrap what is wrong with the disk in words of its own.
        let mut png = Vec::new();
        PngEncoder::new(&mut png)
            .write_image(&picture.to_rgba(), picture.width, picture.height, ExtendedColorType::Rgba8)
            .map_err(|e| failed(&e))?;
        let write = |mut file: BufWriter<File>| file.write_all(&png).and_then(|()| file.flush());
        self.outputs.create(name).and_then(write).map_err(|e| failed(&e))
    }
}
