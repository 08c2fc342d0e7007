//! Observer of a run.

use crate::outputs::aux_output::AuxOutput;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_kernel::MemoryRequest;
use basrelief_reference::{QualityMetrics, RgbPicture};

/// Pictures of a finished frame.
#[derive(Debug)]
pub struct FramePictures<'a> {
    /// Frame number, from 0.
    pub index: usize,
    /// The machine's image.
    pub machine: &'a RgbPicture,
    /// The reference image, and the quality of the machine's image against it.
    pub exact: Option<(&'a RgbPicture, QualityMetrics)>,
}

/// Requests that a memory has accepted since the previous call, ordered by arrival, port number and issue.
#[derive(Clone, Copy, Debug)]
pub struct MemoryRequests<'a> {
    /// Name of the memory.
    pub memory: &'a str,
    /// The requests.
    pub requests: &'a [MemoryRequest],
    /// Names of the machine's memory clients, by number.
    pub clients: &'a [String],
}

/// Observer of a run. By default it ignores everything.
pub trait Observer {
    /// Reports that `commands` of `total` commands have entered the machine. Returns `false` to stop the run.
    fn progress(&mut self, commands: u64, total: Option<u64>) -> bool {
        let _ = (commands, total);
        true
    }

    /// Reports a finished picture, by the number of its frame and its number within the frame, both from 0. Called before the picture is
    /// compared or encoded.
    fn picture_shown(&mut self, frame: u32, round: u32) {
        let _ = (frame, round);
    }

    /// Receives a finished frame with its quality. The machine may have continued meanwhile.
    ///
    /// # Errors
    /// An error stops the run.
    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        let _ = pictures;
        Ok(())
    }

    /// Receives an auxiliary output selected by [`RunOptions::aux_outputs`](crate::RunOptions::aux_outputs). Called before the frame that
    /// the output belongs to, except for the last picture of a frame that is shown in increasing quality.
    ///
    /// # Errors
    /// An error stops the run.
    fn aux_output(&mut self, aux_output: &AuxOutput<'_>) -> Result<(), String> {
        let _ = aux_output;
        Ok(())
    }

    /// Receives the next bytes of the recording selected by [`RunOptions::recording`](crate::RunOptions::recording). A complete recording
    /// can be passed to [`resimulate`](crate::resimulate). `is_short` is true while the recording is within the limit of
    /// [`IfShort`](crate::AnalysisPolicy::IfShort).
    ///
    /// # Errors
    /// An error stops the run.
    fn recording(&mut self, bytes: &[u8], is_short: bool) -> Result<(), String> {
        let _ = (bytes, is_short);
        Ok(())
    }

    /// Receives memory requests if [`RunOptions::requests`](crate::RunOptions::requests) is set. The order of each memory's requests is the
    /// same for all engines. Their division into calls, and the order between memories, may differ.
    ///
    /// # Errors
    /// An error stops the run.
    fn requests(&mut self, requests: &MemoryRequests<'_>) -> Result<(), String> {
        let _ = requests;
        Ok(())
    }
}

/// Observer that ignores everything.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoObserver;
impl Observer for NoObserver {}

/// Returns the file name of a picture: `image.png`, or `image-0001.png` and so on if there are several.
pub fn picture_name(kind: &str, index: usize, several: bool) -> String {
    if several { format!("{kind}-{:04}.png", index + 1) } else { format!("{kind}.png") }
}

/// Observer that keeps the recording of a run in memory.
#[derive(Debug)]
pub struct KeptRecording {
    bytes: Vec<u8>,
    held: MemoryReservation,
}

impl KeptRecording {
    /// Creates an empty recording, whose bytes count against this limit.
    pub fn new(budget: &MemoryPool) -> Self {
        Self { bytes: vec![], held: budget.empty_reservation() }
    }

    /// Returns the bytes of the recording file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl AsRef<[u8]> for KeptRecording {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}

impl Observer for KeptRecording {
    fn recording(&mut self, bytes: &[u8], _: bool) -> Result<(), String> {
        self.held.try_grow(bytes.len() as u64, "a recording").map_err(|error| error.to_string())?;
        self.bytes.extend_from_slice(bytes);
        Ok(())
    }
}
