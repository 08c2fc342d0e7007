//! Execution and timing on two threads: this thread executes the steps, and another thread computes their timing.

use crate::options::RunOptions;
use crate::recording::CHUNK_BYTES;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{Engine, RunReport, StepBatch, time_steps};
use basrelief_machines::MachineEngines;
use basrelief_threads as threads;
use std::cell::Cell;
use std::sync::mpsc::sync_channel;

/// Steps in a batch for the other thread: about 200 KB.
const BATCH_STEPS: usize = 4096;
/// Maximum number of batches between the threads, so that memory does not grow with the run.
const MAX_BATCHES: usize = 4;

/// True if a run without a probe may use two threads. A record of memory requests needs execution and timing on one thread. With a
/// cycle limit, execution would run beyond the limit. The reference image may keep a core busy, but as a rule it is finished first. Two
/// threads then shorten whole commands on two cores by 3 %, for 1 % more processor time.
pub(crate) fn may_run_concurrently(settings: &RunOptions) -> bool {
    let &RunOptions { engine, max_cycles, requests, .. } = settings;
    let needs_one_thread = requests || max_cycles < u64::MAX;
    engine == Some(Engine::Timed) && !needs_one_thread && threads::workers() > 1
}

/// Runs a machine to its end, without a cycle limit, and returns the report of the timed engine. Returns `None` and does nothing if no
/// thread is available or the wiring is invalid. `keep` receives the recorded steps.
pub(crate) fn run_concurrent<M: MachineEngines>(
    machine: &mut M,
    progress: &mut dyn FnMut(&mut M) -> bool,
    keep: Option<&(dyn Fn(RecordingChunk) + Sync)>,
) -> Option<RunReport> {
    let netlist = machine.netlist().ok()?;
    let (send, batches) = sync_channel::<StepBatch>(MAX_BATCHES);
    let time = move || {
        let mut keep = keep.map(|keep| move |chunk| keep(chunk));
        let keep = keep.as_mut().map(|keep| (CHUNK_BYTES, keep as &mut dyn FnMut(RecordingChunk)));
        time_steps(netlist, &mut || batches.recv().ok(), keep)
    };
    let work = || {
        // Dropping the sender ends the other thread.
        let send = send;
        // The receiver is gone if a step was a fault.
        let is_over = Cell::new(false);
        let mut progress = |machine: &mut M| !is_over.get() && progress(machine);
        machine.make_steps(&mut progress, BATCH_STEPS, &mut |batch| is_over.set(send.send(batch).is_err()))
    };
    let (report, worked) = threads::join_concurrent(time, work)?;
    worked.ok().map(|()| report)
}
