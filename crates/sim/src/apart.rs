//! Work on this thread and time on another: the machine draws as fast as it can, and who tells the times of its steps comes behind.

use crate::settings::RunOptions;
use crate::tape::REEL_BYTES;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{Engine, Machine, Netlist, Probe, RunReport, StepBatch, make_steps, time_steps};
use basrelief_threads as threads;
use std::cell::Cell;
use std::sync::mpsc::sync_channel;

/// Steps that are handed to the other thread at a time: some 200 KB.
const PIECE_STEPS: usize = 4096;
/// How many pieces may wait between the two threads, so that what they hold does not grow with the run.
const PIECES: usize = 4;

/// Whether a run may be on two threads. Who looks at times and at work side by side needs both on one, and with a limit of cycles the work
/// would run beyond it. And there must be a core for it: the exact picture has one.
pub(crate) fn may_be_apart<P: Probe>(settings: &RunOptions) -> bool {
    let &RunOptions { engine, max_cycles, requests, exact, .. } = settings;
    let looks_at_both = P::is_on() || requests || max_cycles < u64::MAX;
    engine == Some(Engine::Timed) && !looks_at_both && threads::workers() > 1 + usize::from(exact)
}

/// Runs a machine to its end, without a limit of cycles, and gives the report that the timed engine gives. None where there is no other
/// thread, or the wiring is wrong: then nothing is done. `keep`: who is given the tape.
pub fn run_apart<M: Machine>(
    machine: &mut M,
    progress: &mut dyn FnMut(&mut M) -> bool,
    keep: Option<&(dyn Fn(RecordingChunk) + Sync)>,
) -> Option<RunReport> {
    let shape = Netlist::of(machine).ok()?;
    let (send, pieces) = sync_channel::<StepBatch>(PIECES);
    let time = move || {
        let mut keep = keep.map(|keep| move |reel| keep(reel));
        let keep = keep.as_mut().map(|keep| (REEL_BYTES, keep as &mut dyn FnMut(RecordingChunk)));
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
