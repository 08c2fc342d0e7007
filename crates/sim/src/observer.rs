//! Watching a run from outside.

use crate::exhibits::content::Exhibit;
use basrelief_kernel::MemoryRequest;
use basrelief_reference::{Picture, Quality};

/// A finished frame, as the machine and as the exact renderer drew it.
#[derive(Debug)]
pub struct Pictures<'a> {
    /// Number of the frame, from 0.
    pub index: usize,
    /// The machine's.
    pub machine: &'a Picture,
    /// The exact one, and how far the machine's is from it.
    pub exact: Option<(&'a Picture, Quality)>,
}

/// Requests that one memory has taken in since the last of them were shown, in its order: (arrival, port number, issue).
#[derive(Clone, Copy, Debug)]
pub struct MemoryRequests<'a> {
    /// Name of the memory.
    pub memory: &'a str,
    /// The requests.
    pub requests: &'a [MemoryRequest],
    /// Names of the machine's clients, by their number.
    pub clients: &'a [String],
}

/// Watches a run.
pub trait Observer {
    /// So many of `total` commands have entered the machine; `false` stops the run.
    fn progress(&mut self, commands: u64, total: Option<u64>) -> bool {
        let _ = (commands, total);
        true
    }

    /// A picture is finished: number of its frame, and its own within the frame, both from 0. Comes before anything is made of it.
    fn shown(&mut self, frame: u32, round: u32) {
        let _ = (frame, round);
    }

    /// A frame is finished and measured. The machine may have gone on meanwhile.
    ///
    /// # Errors
    /// What keeps the observer from taking it; stops the run.
    fn frame(&mut self, pictures: &Pictures<'_>) -> Result<(), String> {
        let _ = pictures;
        Ok(())
    }

    /// Something beside the finished pictures, of those that [`RunOptions::exhibits`](crate::RunOptions::exhibits) asks for; comes
    /// before the frame that it belongs to, but for the last picture of a frame that is shown several times.
    ///
    /// # Errors
    /// What keeps the observer from taking it; stops the run.
    fn exhibit(&mut self, exhibit: &Exhibit<'_>) -> Result<(), String> {
        let _ = exhibit;
        Ok(())
    }

    /// The next bytes of the run's tape, where [`RunOptions::tape`](crate::RunOptions::tape) asks for it: [`retime`](crate::retime)
    /// reads it, once it is whole. `is_short` until there is more work on it than [`IfShort`](crate::When::IfShort) has.
    ///
    /// # Errors
    /// What keeps the observer from taking them; stops the run.
    fn tape(&mut self, bytes: &[u8], is_short: bool) -> Result<(), String> {
        let _ = (bytes, is_short);
        Ok(())
    }

    /// A memory has taken requests in, where [`RunOptions::requests`](crate::RunOptions::requests) asks for them. What each
    /// memory takes in comes in its order, whatever the engine; how it is cut, and what comes of other memories between, is not
    /// the same for both.
    ///
    /// # Errors
    /// What keeps the observer from taking them; stops the run.
    fn requests(&mut self, requests: &MemoryRequests<'_>) -> Result<(), String> {
        let _ = requests;
        Ok(())
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;
impl Observer for Unobserved {}

/// Name of a picture's file: `image.png`, or `image-0001.png` and on where there are several.
pub fn picture_name(kind: &str, index: usize, several: bool) -> String {
    if several { format!("{kind}-{:04}.png", index + 1) } else { format!("{kind}.png") }
}
