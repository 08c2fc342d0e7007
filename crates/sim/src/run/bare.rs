//! A machine with its scene and nothing around it: no reference image, no outputs, no analysis. Benchmarks measure it, so that they
//! measure the engines as they are compiled into the programs.

use super::concurrent::run_concurrent;
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{Engine, Netlist, Probe, RunLimits, RunReport, WiringError};
use basrelief_machines::{ConfigProblem, FrontEnd, MachineConfig, MachineEngines, MachineSpec as _, PictureMachine, for_machine};
use basrelief_signals::Scene;
use std::sync::Arc;

/// A machine at power-on that is to draw a scene. It runs once.
pub trait BareMachine {
    /// Returns its netlist.
    ///
    /// # Errors
    /// The wiring is invalid.
    fn netlist(&mut self) -> Result<Netlist, WiringError>;
    /// Runs it on the timed engine.
    fn run(&mut self, probe: Option<&mut dyn Probe>) -> RunReport;
    /// Runs it on the timed engine, with execution on one thread and timing on another. Returns `None` if no thread is available.
    fn run_concurrent(&mut self) -> Option<RunReport>;
    /// Runs it on the timed engine. `keep` receives the recorded steps in chunks of about so many bytes.
    fn run_recorded(&mut self, chunk_bytes: usize, keep: &mut dyn FnMut(RecordingChunk)) -> RunReport;
    /// Runs it without time.
    ///
    /// # Errors
    /// A unit raises a fault.
    fn run_functional(&mut self) -> Result<(), String>;
    /// Returns the number of fragments drawn.
    fn fragments(&mut self) -> u64;
}

impl<M: PictureMachine> BareMachine for M {
    fn netlist(&mut self) -> Result<Netlist, WiringError> {
        MachineEngines::netlist(self)
    }

    fn run(&mut self, probe: Option<&mut dyn Probe>) -> RunReport {
        let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_| true };
        self.run_with(Engine::Timed, probe, limits)
    }

    fn run_concurrent(&mut self) -> Option<RunReport> {
        run_concurrent(self, &mut |_| true, None)
    }

    fn run_recorded(&mut self, chunk_bytes: usize, keep: &mut dyn FnMut(RecordingChunk)) -> RunReport {
        let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_: &mut M| true };
        MachineEngines::run_recorded(self, Engine::Timed, None, limits, chunk_bytes, keep)
    }

    fn run_functional(&mut self) -> Result<(), String> {
        MachineEngines::run_functional(self, &mut |_| true)
    }

    fn fragments(&mut self) -> u64 {
        self.facts().count("fragments")
    }
}

/// Builds the machine that draws a scene.
///
/// # Errors
/// Parameters that are in range but do not fit together.
pub fn bare_machine(config: &MachineConfig, scene: &Arc<Scene>) -> Result<Box<dyn BareMachine>, ConfigProblem> {
    let draws = SceneDraws::new(Arc::clone(scene));
    for_machine!(config, spec => Ok(Box::new(spec.build(FrontEnd::of_scene(draws, spec.front()))?)))
}
