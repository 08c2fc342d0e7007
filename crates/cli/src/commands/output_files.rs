//! Outputs during a run: images, auxiliary outputs, progress.

use super::dump::DumpFiles;
use super::html::HtmlFile;
use super::real_times::RealTimes;
use super::recording::{RecordingFile, ShortRecording};
use super::reporting::publish_report;
use super::requests::RequestsFile;
use crate::args::SimulationArgs;
use crate::error::{CommandError, CommandResult};
use crate::interrupt;
use crate::outputs::{OutputFolder, PartialFile, earlier_files};
use crate::progress::InputProgress;
use basrelief_reference::metrics;
use basrelief_report::Report;
use basrelief_sim::{AuxContent, AuxForm, AuxOutput, FramePictures, MemoryRequests, Observer, RunOptions, picture_name, to_png};
use basrelief_threads as threads;
use basrelief_tile_server::preview::LivePreview;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

/// Outputs of a run.
pub struct OutputFiles {
    /// Dropped before `outputs`: a discarded dump must be removed before the folder created for both.
    pub dumps: DumpFiles,
    /// Dropped before `outputs` likewise.
    pub requests: Option<RequestsFile>,
    /// Dropped before `outputs` likewise.
    pub recording: Option<RecordingFile>,
    pub run_recording: ShortRecording,
    pub page: Option<HtmlFile>,
    pub outputs: OutputFolder,
    pub progress: InputProgress,
    pub frames: usize,
    /// Kinds of images written per frame: image, reference and difference, then auxiliary outputs.
    pub kinds: [Vec<&'static str>; 2],
    /// Names of further images.
    pub extra: Vec<String>,
    /// The last image of an unfinished frame, and its frame.
    pub shown: Option<(u32, String)>,
    /// Image times of a scene from a server.
    pub real: Option<RealTimes>,
    /// The live preview.
    pub watched: Option<LivePreview>,
}

impl Observer for OutputFiles {
    fn progress(&mut self, commands: u64, _: Option<u64>) -> bool {
        self.progress.set_position(commands);
        true
    }

    fn picture_shown(&mut self, frame: u32, round: u32) {
        if let Some(real) = &mut self.real {
            real.record_image(frame, round);
        }
    }

    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        let index = pictures.index;
        self.frames = index + 1;
        let exact = pictures.exact.map(|(exact, _)| exact);
        if let Some(page) = &mut self.page {
            page.frame(pictures.machine, exact);
        }
        let difference =
            exact.map(|exact| metrics::difference(exact, pictures.machine)).transpose().map_err(|e| e.to_string())?;
        let drawn = [("image", Some(pictures.machine)), ("reference", exact), ("difference", difference.as_ref())];
        let drawn = drawn.into_iter().filter_map(|(kind, picture)| Some((kind, picture?))).collect();
        for (kind, png) in threads::par_map(drawn, |(kind, picture)| (kind, to_png(picture))) {
            if let (Some(watched), "image", Ok(png)) = (&self.watched, kind, &png) {
                watched.show(&picture_name(kind, index, true), png);
            }
            self.save([0, index], kind, png)?;
        }
        Ok(())
    }

    fn aux_output(&mut self, exhibit: &AuxOutput<'_>) -> Result<(), String> {
        match &exhibit.content {
            AuxContent::Lines(write) => self.dumps.write(exhibit.info, write),
            AuxContent::Picture(picture) => self.save([1, exhibit.frame as usize], exhibit.info.name, to_png(picture)),
            AuxContent::NamedPicture(name, picture) => {
                let png = to_png(picture);
                if let (Some(watched), AuxForm::PicturePerRound, Ok(png)) = (&self.watched, exhibit.info.form, &png) {
                    watched.show(name, png);
                }
                self.write(name, png)?;
                self.extra.push(name.clone());
                if exhibit.info.form == AuxForm::PicturePerRound {
                    if let Some(real) = &self.real {
                        let failed = |e| format!("{}: cannot be written: {e}", self.outputs.place(name).display());
                        self.outputs.show(name, earlier_files).map_err(failed)?;
                        interrupt::set_message(real.interrupted);
                    }
                    self.shown = Some((exhibit.frame, name.clone()));
                }
                Ok(())
            }
        }
    }

    fn requests(&mut self, requests: &MemoryRequests<'_>) -> Result<(), String> {
        self.requests.as_mut().map_or(Ok(()), |file| file.write(requests))
    }

    fn recording(&mut self, bytes: &[u8], is_short: bool) -> Result<(), String> {
        self.run_recording.recording(bytes, is_short)?;
        self.recording.as_mut().map_or(Ok(()), |file| file.write(bytes))
    }
}

/// A finished file and its final path.
type FinishedFile = (PartialFile, PathBuf);

/// Finished outputs, to be published together.
pub struct FinishedFiles {
    /// Files beside the folder. Dropped before `outputs`, as in [`OutputFiles`].
    beside: Vec<FinishedFile>,
    dumps: DumpFiles,
    /// `None` if the recording cannot be resimulated.
    run_recording: Option<ShortRecording>,
    outputs: OutputFolder,
    pub frames: usize,
    /// Kinds of images written for each frame.
    kinds: Vec<&'static str>,
    /// Names of further images.
    extra: Vec<String>,
}

/// Maximum number of further images in the message.
const MOST_NAMED: usize = 8;

impl FinishedFiles {
    /// Renames the images of a single frame, adds report and recording, and publishes everything. Returns the names of the
    /// written files.
    pub fn publish(self, report: &Report, args: &SimulationArgs) -> CommandResult<String> {
        let failed = || CommandError::at_file(&args.out, "be written");
        if self.frames == 1 {
            for kind in &self.kinds {
                self.outputs.rename(&picture_name(kind, 0, true), &picture_name(kind, 0, false)).map_err(failed())?;
            }
        }
        let mut names = self.image_names(report.image.len() > 1);
        let published = publish_report(self.outputs, report, args.csv, self.run_recording).map_err(failed())?;
        names.extend(published.into_iter().map(str::to_owned));
        self.dumps.publish()?;
        for (file, path) in self.beside {
            file.publish().map_err(CommandError::at_file(&path, "be written"))?;
        }
        Ok(names.join(", "))
    }

    fn image_names(&self, several: bool) -> Vec<String> {
        let name = |kind: &&str| if several { format!("{kind}-0001.png ...") } else { picture_name(kind, 0, false) };
        let more = self.extra.iter().take(MOST_NAMED).cloned().chain((self.extra.len() > MOST_NAMED).then(|| "...".to_owned()));
        self.kinds.iter().map(name).chain(more).collect()
    }
}

impl OutputFiles {
    /// Opens all outputs of the command line.
    pub fn open(
        simulation: &SimulationArgs,
        settings: &RunOptions,
        outputs: OutputFolder,
        progress: InputProgress,
    ) -> CommandResult<Self> {
        Ok(Self {
            dumps: DumpFiles::open(&simulation.dump, &settings.config)?,
            requests: RequestsFile::open(simulation, &settings.config, &outputs)?,
            recording: simulation.recording.as_deref().map(RecordingFile::open).transpose()?,
            run_recording: ShortRecording::new(settings.bottlenecks)?,
            page: simulation.html.as_deref().map(HtmlFile::open).transpose()?,
            outputs,
            progress,
            frames: 0,
            kinds: Default::default(),
            extra: vec![],
            shown: None,
            real: None,
            watched: None,
        })
    }

    /// Completes all files.
    pub fn finish(
        self,
        report: &Report,
        recording_is_complete: bool,
        simulation: &SimulationArgs,
    ) -> CommandResult<FinishedFiles> {
        let Self { mut dumps, requests, recording, run_recording, page, outputs, progress, frames, kinds, extra, .. } = self;
        drop(progress);
        dumps.flush()?;
        let requests = requests.map(RequestsFile::finish).transpose()?;
        // An incomplete run has no recording.
        let recording = recording.filter(|_| recording_is_complete).map(RecordingFile::finish).transpose()?;
        let page = page.map(|page| page.finish(report)).transpose()?;
        let beside = [(requests, &simulation.requests), (recording, &simulation.recording), (page, &simulation.html)];
        let beside = beside.into_iter().filter_map(|(file, path)| Some((file?, path.clone()?))).collect();
        // Without a bottleneck analysis the recording cannot be resimulated either.
        let run_recording = (recording_is_complete && report.bottlenecks.is_some()).then_some(run_recording);
        Ok(FinishedFiles { beside, dumps, run_recording, outputs, frames, kinds: kinds.concat(), extra })
    }

    /// Keeps the best image of the unfinished frame of a failed run.
    pub fn keep_best_image(self, error: CommandError) -> CommandError {
        let Some((_, best)) = self.shown.filter(|(frame, _)| *frame as usize >= self.frames) else { return error };
        match self.outputs.copy(&best, "image.png").and_then(|()| self.outputs.publish("image.png", earlier_files)) {
            Ok(()) => error,
            Err(e) => CommandError::BadInput(format!("{error}\nThe best image so far cannot be written: {e}")),
        }
    }

    /// Writes an image of frame `index`; `exhibit` is 1 for an auxiliary output and 0 otherwise.
    fn save(&mut self, [exhibit, index]: [usize; 2], kind: &'static str, png: Result<Vec<u8>, String>) -> Result<(), String> {
        let kinds = &mut self.kinds[exhibit];
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
        self.write(&picture_name(kind, index, true), png)
    }

    fn write(&mut self, name: &str, png: Result<Vec<u8>, String>) -> Result<(), String> {
        let failed = |e: &dyn std::fmt::Display| format!("{}: cannot be written: {e}", self.outputs.place(name).display());
        let png = png.map_err(|e| failed(&e))?;
        let write = |mut file: BufWriter<File>| file.write_all(&png).and_then(|()| file.flush());
        self.outputs.create(name).and_then(write).map_err(|e| failed(&e))
    }
}
