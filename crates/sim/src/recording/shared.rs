//! A recording that several threads resimulate again and again.

use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{CriticalPath, Netlist, Recording, ResimulateError, ResimulationMemory, RunReport, StageGroups};
use basrelief_threads::{lock, par_map};
use std::borrow::Cow;
use std::sync::Mutex;

/// A whole recording, with the memory of earlier resimulations.
pub(crate) struct SharedRecording<'a> {
    recording: Recording<'a>,
    spare: Mutex<Vec<ResimulationMemory>>,
}

impl<'a> SharedRecording<'a> {
    /// Reads a recording on all threads. See [`Recording::new`].
    pub(crate) fn new(chunks: impl Into<Cow<'a, [RecordingChunk]>>, netlist: &Netlist, room: u64) -> Self {
        let recording = Recording::read_by(chunks, netlist, room, |stages, read| par_map((0..stages).collect(), read));
        Self { recording, spare: Mutex::default() }
    }

    /// See [`Recording::resimulate`].
    pub(crate) fn resimulate(&self, netlist: Netlist) -> Result<RunReport, ResimulateError> {
        self.in_spare_memory(|memory| self.recording.resimulate(netlist, memory))
    }

    /// See [`Recording::cycles`].
    pub(crate) fn cycles(&self, netlist: Netlist) -> Result<Option<u64>, ResimulateError> {
        self.in_spare_memory(|memory| self.recording.cycles(netlist, memory))
    }

    /// See [`Recording::critical_path`].
    pub(crate) fn critical_path(
        &self,
        netlist: Netlist,
        most_steps: usize,
        groups: &[StageGroups],
    ) -> Result<Option<CriticalPath>, ResimulateError> {
        self.in_spare_memory(|memory| self.recording.critical_path(netlist, most_steps, groups, memory))
    }

    fn in_spare_memory<T>(&self, resimulate: impl FnOnce(&mut ResimulationMemory) -> T) -> T {
        let mut memory = lock(&self.spare).pop().unwrap_or_default();
        let result = resimulate(&mut memory);
        lock(&self.spare).push(memory);
        result
    }
}
