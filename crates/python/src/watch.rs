//! Observer of a run or of a resimulation: collects pictures and the recording, and checks for Ctrl-C.

use crate::outputs::RequestsFile;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_reference::RgbPicture;
use basrelief_sim::{AnalysisPolicy, FramePictures, MemoryRequests, Observer};
use basrelief_trace::checked_encoder;
use pyo3::{PyErr, Python};
use std::io::{self, Write};
use std::time::{Duration, Instant};

/// Time between two checks for Ctrl-C. Each check waits for the interpreter lock.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Collects the pictures of the last frame, the recording, and the exception that stopped the run.
pub struct RunWatcher {
    pub last: Option<(RgbPicture, Option<RgbPicture>)>,
    /// The file of memory requests.
    pub requests: Option<RequestsFile>,
    recording: CompressedRecording,
    looked: Instant,
    stopped: Option<PyErr>,
}

impl RunWatcher {
    /// Makes an observer. The policy `recording` selects the recordings to keep, within the memory limit.
    pub fn new(recording: AnalysisPolicy, budget: &MemoryPool) -> io::Result<Self> {
        let recording = CompressedRecording::new(recording, budget)?;
        Ok(Self { last: None, requests: None, recording, looked: Instant::now(), stopped: None })
    }

    /// Checks for Ctrl-C. Returns false once the user has pressed it.
    fn check_interrupt(&mut self) -> bool {
        if self.stopped.is_none() && self.looked.elapsed() >= BETWEEN_LOOKS {
            self.stopped = Python::attach(|py| py.check_signals()).err();
            self.looked = Instant::now();
        }
        self.stopped.is_none()
    }

    /// Takes the exception that stopped the run.
    pub fn stopped(&mut self) -> Option<PyErr> {
        self.stopped.take()
    }

    /// Returns the compressed recording; `None` if it was not kept.
    pub fn into_recording(self) -> io::Result<Option<Vec<u8>>> {
        self.recording.encoder.map(zstd::Encoder::finish).transpose()
    }
}

impl Observer for RunWatcher {
    fn progress(&mut self, _: u64, _: Option<u64>) -> bool {
        self.check_interrupt()
    }

    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        self.last = Some((pictures.machine.clone(), pictures.exact.map(|(exact, _)| exact.clone())));
        Ok(())
    }

    fn requests(&mut self, requests: &MemoryRequests<'_>) -> Result<(), String> {
        self.requests.as_mut().map_or(Ok(()), |file| file.write(requests))
    }

    fn recording(&mut self, bytes: &[u8], is_short: bool) -> Result<(), String> {
        if !self.check_interrupt() {
            return Err("stopped".into());
        }
        self.recording.keep(bytes, is_short).map_err(|error| error.to_string())
    }
}

/// A compressed recording in memory.
struct CompressedRecording {
    always: bool,
    /// `None` if no recording is requested, or once the recording is too long.
    encoder: Option<zstd::Encoder<'static, Vec<u8>>>,
    held: MemoryReservation,
}

impl CompressedRecording {
    fn new(which: AnalysisPolicy, budget: &MemoryPool) -> io::Result<Self> {
        let encoder = (which != AnalysisPolicy::Never).then(|| checked_encoder(Vec::new())).transpose()?;
        Ok(Self { always: which == AnalysisPolicy::Always, encoder, held: budget.empty_reservation() })
    }

    fn keep(&mut self, bytes: &[u8], is_short: bool) -> io::Result<()> {
        self.encoder = self.encoder.take().filter(|_| is_short || self.always);
        let Some(encoder) = &mut self.encoder else { return Ok(()) };
        encoder.write_all(bytes)?;
        let more = (encoder.get_ref().len() as u64).saturating_sub(self.held.bytes());
        Ok(self.held.try_grow(more, "the recording, compressed")?)
    }
}
