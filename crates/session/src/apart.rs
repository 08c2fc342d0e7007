//! Work on this thread and time on another: the machine draws as fast as it can, and its steps are timed as they come. What a step
//! does depends on no time (law 6), so that nobody waits for an answer.

use crate::tape::{REEL_BYTES, bytes_of};
use basrelief_kernel::tape::Reel;
use basrelief_kernel::{Machine, NoProbe, RetimeError, RunReport, Shape, retime, run_to_tape};
use basrelief_threads as threads;
use std::borrow::Cow;
use std::cell::Cell;
use std::sync::mpsc::sync_channel;

/// Bytes of work that are handed to the other thread at a time: some 5,000 steps.
const PIECE_BYTES: usize = 32 << 10;
/// How many pieces may wait between the two threads: so what they hold does not grow with the run.
const PIECES: usize = 8;

/// Runs a machine to its end, without a limit of cycles, and gives the report that the timed engine gives, or a fault. None where there
/// is no other thread: then nothing is done. `keep`: who is given the tape.
pub(crate) fn run_apart<M: Machine>(
    machine: &mut M,
    progress: &mut dyn FnMut(&mut M) -> bool,
    mut keep: Option<&mut dyn FnMut(Reel)>,
) -> Option<Result<RunReport, String>> {
    let shape = match Shape::of(machine) {
        Ok(shape) => shape,
        Err(error) => return Some(Err(error.to_string())),
    };
    let (send, pieces) = sync_channel::<Reel>(PIECES);
    let time = move || retime(shape, &mut |_| Ok(pieces.recv().ok().map(Cow::Owned)), &mut NoProbe, u64::MAX);
    let work = || {
        // Once this is dropped there are no more pieces.
        let send = send;
        let (mut gathered, is_over) = (Gathered::default(), Cell::new(false));
        let worked = run_to_tape(
            machine,
            &mut |machine| !is_over.get() && progress(machine),
            (PIECE_BYTES, &mut |piece| {
                if let Some(keep) = &mut keep {
                    gathered.add(piece.clone()).into_iter().for_each(&mut *keep);
                }
                // Nobody takes it where a step is found to be a fault.
                is_over.set(send.send(piece).is_err());
            }),
        );
        if let (Some(keep), Some(last)) = (keep, gathered.reel) {
            keep(last);
        }
        worked
    };
    let (timed, worked) = threads::apart(time, work)?;
    let timed = timed.map_err(|error| match error {
        RetimeError::Fault(fault) => fault,
        other => other.to_string(),
    });
    Some(worked.map_err(|error| error.to_string()).and(timed))
}

/// Pieces that become reels of the usual size.
#[derive(Default)]
struct Gathered {
    reel: Option<Reel>,
}

impl Gathered {
    /// Takes a piece in; the reel before it, where that is full.
    fn add(&mut self, piece: Reel) -> Option<Reel> {
        let full = self.reel.take_if(|reel| bytes_of(reel) >= REEL_BYTES);
        match &mut self.reel {
            Some(reel) => reel.append(piece),
            none => *none = Some(piece),
        }
        full
    }
}
