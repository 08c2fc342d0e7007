//! The engines: three ways to run the same unit code.

mod arity;
mod batch;
mod context;
mod functional;
mod overlapped;
mod probed;
mod resimulate;
mod step_source;
mod ticked;
mod timed;
mod whole_recording;

use crate::check::check_wiring;
use crate::machine::Machine;
use crate::netlist::Netlist;
use crate::probe::NoProbe;
use crate::recording::{RecordingChunk, RecordingWriter};
use crate::report::RunReport;
use crate::time::{MachineTiming, StopReason};
use crate::{Cycle, Probe};
pub use batch::StepBatch;
pub use context::RunLimits;
use context::{ActiveRecording, unit_states};
pub use overlapped::{make_steps, time_steps};
pub use resimulate::{ChunkSource, ResimulateError, ResimulationMemory, critical_path, resimulate, resimulate_with};
use step_source::WireReport;
pub use whole_recording::{Recording, StageRecording};

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
    run_with(machine, engine, None, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true })
}

/// Runs `machine` within limits, under a probe if there is one.
pub fn run_with<M: Machine>(
    machine: &mut M,
    engine: Engine,
    probe: Option<&mut dyn Probe>,
    limits: RunLimits<'_, M>,
) -> RunReport {
    run_on(machine, probe, |machine, time, probe| run_engine(machine, engine, time, probe, limits, None))
}

/// As [`run_with`], and passes the run's [recording](crate::recording) to `keep` in chunks of about `chunk_bytes`. There is no
/// last chunk if the run is stopped or a unit cannot continue.
pub fn run_recorded<M: Machine>(
    machine: &mut M,
    engine: Engine,
    probe: Option<&mut dyn Probe>,
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

fn run_engine<M: Machine>(
    machine: &mut M,
    engine: Engine,
    time: &mut MachineTiming,
    probe: Option<&mut dyn Probe>,
    limits: RunLimits<'_, M>,
    recording: Option<ActiveRecording<'_>>,
) -> StopReason {
    match (engine, probe) {
        // Constant conditions, so that no engine is compiled into programs without its feature.
        (Engine::Timed, None) if cfg!(feature = "unwatched") => timed::run(machine, time, limits, recording),
        (Engine::Timed, probe) => probed::run(machine, time, probe.unwrap_or(&mut NoProbe), limits, recording),
        (Engine::Ticked, probe) if cfg!(feature = "ticked") => {
            ticked::run(machine, time, probe.unwrap_or(&mut NoProbe), limits, recording)
        }
        (Engine::Ticked, _) => StopReason::Fault("this build has no ticked engine (feature `ticked` of basrelief-kernel)".into()),
    }
}

fn run_on<M: Machine>(
    machine: &mut M,
    mut probe: Option<&mut dyn Probe>,
    engine: impl FnOnce(&mut M, &mut MachineTiming, Option<&mut dyn Probe>) -> StopReason,
) -> RunReport {
    let shape = match Netlist::of(machine) {
        Ok(shape) => shape,
        Err(error) => return RunReport::of_fault(error.to_string()),
    };
    let mut time = MachineTiming::new(shape);
    if let Some(probe) = &probe {
        time.keep_fills(probe);
    }
    let halt = engine(machine, &mut time, probe.as_mut().map(|probe| &mut **probe as &mut dyn Probe));
    let mut observer: &mut dyn Probe = match &mut probe {
        Some(probe) => &mut **probe,
        None => &mut NoProbe,
    };
    let report = time.finalize(&unit_states(machine), halt, &mut observer);
    if let Some(mut probe) = probe {
        time.show_fills(&mut probe, Some(Cycle(report.total)));
        if probe.reads_wires() {
            machine.wire(&mut WireReport { probe, stage: 0 });
        }
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
