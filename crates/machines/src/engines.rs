//! The engines of the kernel, compiled for each machine.

use crate::bump::BumpProcessor;
use crate::defer::DeferredRenderer;
use crate::shade::FigureShadingDevice;
use crate::texel::TextureMappingSystem;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{self as kernel, Engine, Machine, Netlist, Probe, RunLimits, RunReport, StepBatch, WiringError};

/// A machine with the engines that run it.
///
/// Each method is the kernel's function of the same name. Those functions are generic, so every crate that calls one compiles all units
/// of all machines into it once more. These methods are compiled here, once.
pub trait MachineEngines: Machine + Sized {
    /// See [`Netlist::of`].
    ///
    /// # Errors
    /// The wiring is invalid.
    fn netlist(&mut self) -> Result<Netlist, WiringError>;
    /// See [`kernel::run_with`].
    fn run_with(&mut self, engine: Engine, probe: Option<&mut dyn Probe>, limits: RunLimits<'_, Self>) -> RunReport;
    /// See [`kernel::run`].
    fn run(&mut self, engine: Engine) -> RunReport {
        self.run_with(engine, None, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true })
    }
    /// See [`kernel::run_recorded`].
    fn run_recorded(
        &mut self,
        engine: Engine,
        probe: Option<&mut dyn Probe>,
        limits: RunLimits<'_, Self>,
        chunk_bytes: usize,
        keep: &mut dyn FnMut(RecordingChunk),
    ) -> RunReport;
    /// See [`kernel::run_functional`].
    ///
    /// # Errors
    /// A unit raises a fault, or the wiring is invalid.
    fn run_functional(&mut self, progress: &mut dyn FnMut(&mut Self) -> bool) -> Result<(), String>;
    /// See [`kernel::make_steps`].
    ///
    /// # Errors
    /// The wiring is invalid.
    fn make_steps(
        &mut self,
        progress: &mut dyn FnMut(&mut Self) -> bool,
        steps: usize,
        hand_on: &mut dyn FnMut(StepBatch),
    ) -> Result<(), WiringError>;
    /// See [`kernel::stats::unit_stats`].
    fn unit_stats(&mut self) -> UnitStats;
}

macro_rules! compile_engines {
    ($($machine:ty),+) => { $(
        impl MachineEngines for $machine {
            fn netlist(&mut self) -> Result<Netlist, WiringError> {
                Netlist::of(self)
            }

            fn run_with(&mut self, engine: Engine, probe: Option<&mut dyn Probe>, limits: RunLimits<'_, Self>) -> RunReport {
                kernel::run_with(self, engine, probe, limits)
            }

            fn run_recorded(
                &mut self,
                engine: Engine,
                probe: Option<&mut dyn Probe>,
                limits: RunLimits<'_, Self>,
                chunk_bytes: usize,
                keep: &mut dyn FnMut(RecordingChunk),
            ) -> RunReport {
                kernel::run_recorded(self, engine, probe, limits, chunk_bytes, keep)
            }

            fn run_functional(&mut self, progress: &mut dyn FnMut(&mut Self) -> bool) -> Result<(), String> {
                kernel::run_functional(self, progress)
            }

            fn make_steps(
                &mut self,
                progress: &mut dyn FnMut(&mut Self) -> bool,
                steps: usize,
                hand_on: &mut dyn FnMut(StepBatch),
            ) -> Result<(), WiringError> {
                kernel::make_steps(self, progress, steps, hand_on)
            }

            fn unit_stats(&mut self) -> UnitStats {
                kernel::stats::unit_stats(self)
            }
        }
    )+ };
}

compile_engines!(BumpProcessor, FigureShadingDevice, TextureMappingSystem, DeferredRenderer);
