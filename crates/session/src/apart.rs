//! Work on this thread and time on another: the machine draws as fast as it can, and who tells the times of its steps comes behind.

use crate::tape::REEL_BYTES;
use basrelief_kernel::tape::Reel;
use basrelief_kernel::{Machine, Piece, RunReport, Shape, make_steps, time_steps};
use basrelief_threads as threads;
use std::cell::Cell;
use std::sync::mpsc::sync_channel;

/// Steps that are handed to the other thread at a time: some 200 KB.
const PIECE_STEPS: usize = 4096;
/// How many pieces may wait between the two threads, so that what they hold does not grow with the run.
const PIECES: usize = 4;

/// Runs a machine to its end, without a limit of cycles, and gives the report that the timed engine gives. None where there is no other
/// thread, or the wiring is wrong: then nothing is done. `keep`: who is given the tape.
pub fn run_apart<M: Machine>(
    machine: &mut M,
    progress: &mut dyn FnMut(&mut M) -> bool,
    keep: Option<&(dyn Fn(Reel) + Sync)>,
) -> Option<RunReport> {
    let shape = Shape::of(machine).ok()?;
    let (send, pieces) = sync_channel::<Piece>(PIECES);
    let time = move || {
        let mut keep = keep.map(|keep| move |reel| keep(reel));
        let keep = keep.as_mut().map(|keep| (REEL_BYTES, keep as &mut dyn FnMut(Reel)));
        time_steps(shape, &mut || pieces.recv().ok(), keep)
    };
    let work = || {
        // Once this is dropped there are no more pieces.
        let send = send;
        // Nobody takes them where a step turned out to be a fault.
        let is_over = Cell::new(false);
        let mut progress = |machine: &mut M| !is_over.get() && progress(machine);
        make_steps(machine, &mut progress, (PIECE_STEPS, &mut |piece| is_over.set(send.send(piece).is_err())))
    };
    let (report, worked) = threads::apart(time, work)?;
    worked.ok().map(|()| report)
}
