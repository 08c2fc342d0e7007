//! Whole recordings, for resimulation after resimulation.

use super::resimulate::{
    ResimulateError, ResimulationGoal, ResimulationMemory, ResimulationTask, advance_stored, new_readers, timed_again,
};
use crate::netlist::Netlist;
use crate::probe::NoProbe;
use crate::recording::{RecordingChunk, RecordingReader};
use crate::report::RunReport;
use crate::{CriticalPath, Outcome, StageGroups};
use std::borrow::Cow;

/// A recording that is resimulated several times. Its steps are read once, and their look-ups are made once, for the first
/// machine and all machines with the same caches.
#[derive(Clone, Debug)]
pub struct Recording<'a> {
    chunks: Cow<'a, [RecordingChunk]>,
    /// By stage; `None` if the recording is too long or invalid.
    readers: Option<Vec<RecordingReader>>,
    /// Maximum memory for the steps of a stage \[bytes\].
    room: u64,
}

/// The steps of one stage of a [`Recording`].
#[derive(Clone, Debug)]
pub struct StageRecording(Option<RecordingReader>);

impl<'a> Recording<'a> {
    /// Reads a whole recording for a machine with this netlist. Its steps stay in memory if they take no more than about `room`
    /// bytes; otherwise each resimulation reads it again.
    pub fn new(chunks: impl Into<Cow<'a, [RecordingChunk]>>, shape: &Netlist, room: u64) -> Self {
        Self::read_by(chunks, shape, room, |stages, read| (0..stages).map(read).collect())
    }

    /// As [`Recording::new`]. `read_all` calls its function for each stage below a number, in parallel or not, and returns the results in
    /// order.
    pub fn read_by(
        chunks: impl Into<Cow<'a, [RecordingChunk]>>,
        shape: &Netlist,
        room: u64,
        read_all: impl FnOnce(usize, &(dyn Fn(usize) -> StageRecording + Sync)) -> Vec<StageRecording>,
    ) -> Self {
        let stages = shape.stages.len();
        let mut recording = Self { chunks: chunks.into(), readers: None, room: room / stages.max(1) as u64 };
        if recording.chunks.iter().all(|chunk| chunk.stages.len() == stages) {
            let read = read_all(stages, &|stage| StageRecording(recording.read(stage, shape)));
            recording.readers = read.into_iter().map(|StageRecording(reader)| reader).collect();
        }
        recording
    }

    fn read(&self, stage: usize, shape: &Netlist) -> Option<RecordingReader> {
        let parts = self.chunks.iter().filter_map(|chunk| chunk.stage_part(stage));
        RecordingReader::of_whole_stream(&shape.stages[stage], &shape.memories, parts, self.room)
    }

    /// As [`resimulate`](super::resimulate()).
    ///
    /// # Errors
    /// See [`ResimulateError`].
    pub fn resimulate(&self, shape: Netlist, memory: &mut ResimulationMemory) -> Result<RunReport, ResimulateError> {
        Ok(self.timed_again(shape, ResimulationGoal::Report, memory)?.0)
    }

    /// Returns only the cycles [up to the last mark](RunReport::marked_cycles), with fewer instructions. Returns `None` if the run is not
    /// complete.
    ///
    /// # Errors
    /// See [`ResimulateError`].
    pub fn cycles(&self, shape: Netlist, memory: &mut ResimulationMemory) -> Result<Option<u64>, ResimulateError> {
        let (report, _) = self.timed_again(shape, ResimulationGoal::Cycles, memory)?;
        Ok((report.outcome == Outcome::Complete).then(|| report.marked_cycles()))
    }

    /// As [`critical_path`](super::critical_path()).
    ///
    /// # Errors
    /// See [`ResimulateError`].
    pub fn critical_path(
        &self,
        shape: Netlist,
        most_steps: usize,
        groups: &[StageGroups],
        memory: &mut ResimulationMemory,
    ) -> Result<Option<CriticalPath>, ResimulateError> {
        Ok(self.timed_again(shape, ResimulationGoal::Path { most_steps, groups }, memory)?.1)
    }

    fn timed_again(
        &self,
        shape: Netlist,
        goal: ResimulationGoal<'_>,
        memory: &mut ResimulationMemory,
    ) -> Result<(RunReport, Option<CriticalPath>), ResimulateError> {
        let fitting = |(stage, reader): (usize, &RecordingReader)| {
            let fits = reader.fits(&shape.stages[stage], &shape.memories);
            if fits { Some(reader.clone()) } else { self.read(stage, &shape) }
        };
        let readers = self.readers.as_ref().filter(|readers| readers.len() == shape.stages.len());
        let readers: Option<Vec<RecordingReader>> = readers.and_then(|readers| readers.iter().enumerate().map(fitting).collect());
        let mut chunks = self.chunks.iter().map(Cow::Borrowed).skip(if readers.is_some() { self.chunks.len() } else { 0 });
        let readers = readers.unwrap_or_else(|| new_readers(&shape));
        let (chunks, probe) = (&mut |_| Ok(chunks.next()), &mut NoProbe);
        let is_traced = matches!(goal, ResimulationGoal::Path { .. });
        let task = ResimulationTask { goal, max_cycles: u64::MAX, memory };
        match is_traced {
            true => timed_again(shape, readers, chunks, probe, task, advance_stored::<true, NoProbe>),
            false => timed_again(shape, readers, chunks, probe, task, advance_stored::<false, NoProbe>),
        }
    }
}
