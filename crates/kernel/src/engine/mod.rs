//! The engines: three ways to run the same unit code.

mod arity;
mod batch;
mod context;
mod functional;
mod overlapped;
mod resimulate;
mod step_source;
mod ticked;
mod timed;

use crate::check::check_wiring;
use crate::machine::Machine;
use crate::netlist::Netlist;
use crate::recording::{RecordingChunk, RecordingWriter};
use crate::report::RunReport;
use crate::time::{MachineTiming, StopReason};
use crate::{Cycle, Probe};
pub use batch::StepBatch;
pub use context::RunLimits;
use context::{ActiveRecording, unit_states};
pub use overlapped::{make_steps, time_steps};
pub use resimulate::{ChunkSource, PathMemory, Recording, ResimulateError, critical_path, resimulate};
use step_source::WireReport;

/// The engine of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Engine {
    /// Time-stamped dataflow: every token carries its time, and idle cycles are skipped.
    #[default]
    Timed,
    /// Visits every unit in every cycle: slow and obviously right. It is the reference.
    Ticked,
}

/// Runs `machine` to its end.
pub fn run<M: Machine>(machine: &mut M, engine: Engine) -> RunReport {
    run_with(machine, engine, &mut crate::NoProbe, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true })
}

/// Runs `machine` under a probe, within limits.
pub fn run_with<M: Machine, P: Probe>(machine: &mut M, engine: Engine, probe: &mut P, limits: RunLimits<'_, M>) -> RunReport {
    run_on(machine, probe, |machine, time, probe| run_engine(machine, engine, time, probe, limits, None))
}

/// As [`run_with`], and passes the run's [recording](crate::recording) to `keep` in chunks of about `chunk_bytes`. There is no
/// last chunk if the run is stopped or a unit cannot continue.
pub fn run_recorded<M: Machine, P: Probe>(
    machine: &mut M,
    engine: Engine,
    probe: &mut P,
    limits: RunLimits<'_, M>,
    chunk_bytes: usize,
    keep: &mut dyn FnMut(RecordingChunk),
) -> RunReport {
    run_on(machine, probe, |machine, time, probe| {
        let mut writer = RecordingWriter::new(&time.shape, &time.memories, chunk_bytes);
        let recording = Some(ActiveRecording { writer: &mut writer, keep: &mut *keep });
        let halt = run_engine(machine, engine, time, probe, limits, recording);
        if matches!(halt, StopReason::Quiet | StopReason::Limit(_)) {
            keep(writer.finish_chunk(unit_states(machine), true));
        }
        halt
    })
}

fn run_engine<'a, M: Machine, P: Probe>(
    machine: &mut M,
    engine: Engine,
    time: &'a mut MachineTiming,
    probe: &'a mut P,
    limits: RunLimits<'_, M>,
    recording: Option<ActiveRecording<'a>>,
) -> StopReason {
    match engine {
        Engine::Timed => timed::run(machine, time, probe, limits, recording),
        // A constant condition, so that the engine is not compiled into programs without the feature.
        Engine::Ticked if cfg!(feature = "ticked") => ticked::run(machine, time, probe, limits, recording),
        Engine::Ticked => StopReason::Fault("this build has no ticked engine (feature `ticked` of basrelief-kernel)".into()),
    }
}

fn run_on<M: Machine, P: Probe>(
    machine: &mut M,
    probe: &mut P,
    engine: impl FnOnce(&mut M, &mut MachineTiming, &mut P) -> StopReason,
) -> RunReport {
    let shape = match Netlist::of(machine) {
        Ok(shape) => shape,
        Err(error) => return RunReport::of_fault(error.to_string()),
    };
    let mut time = MachineTiming::new(shape);
    time.keep_fills(&*probe);
    let halt = engine(machine, &mut time, probe);
    let report = time.finalize(&unit_states(machine), halt);
    time.show_fills(probe, Some(Cycle(report.total)));
    if P::is_on() && probe.reads_wires() {
        machine.wire(&mut WireReport { probe, stage: 0 });
    }
    *machine.memories() = time.memories;
    report
}

/// Runs the functional model: the same steps without time, with memories that answer at once (law 6). Returns an error if a unit
/// raises a fault or the wiring is invalid.
pub fn run_functional<M: Machine>(machine: &mut M, progress: &mut dyn FnMut(&mut M) -> bool) -> Result<(), String> {
    check_wiring(machine).map_err(|error| error.to_string())?;
    functional::run(machine, progress)
}
