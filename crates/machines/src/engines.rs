//! The engines of the kernel, compiled for each machine.

use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Engine, Machine, Netlist, Probe, RunLimits, RunReport, StepBatch, WiringError};

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
    /// See [`basrelief_kernel::run_with`].
    fn run_with(&mut self, engine: Engine, probe: Option<&mut dyn Probe>, limits: RunLimits<'_, Self>) -> RunReport;
    /// See [`basrelief_kernel::run`].
    fn run(&mut self, engine: Engine) -> RunReport {
        self.run_with(engine, None, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true })
    }
    /// See [`basrelief_kernel::run_recorded`].
    fn run_recorded(
        &mut self,
        engine: Engine,
        probe: Option<&mut dyn Probe>,
        limits: RunLimits<'_, Self>,
        chunk_bytes: usize,
        keep: &mut dyn FnMut(RecordingChunk),
    ) -> RunReport;
    /// See [`basrelief_kernel::run_functional`].
    ///
    /// # Errors
    /// A unit raises a fault, or the wiring is invalid.
    fn run_functional(&mut self, progress: &mut dyn FnMut(&mut Self) -> bool) -> Result<(), String>;
    /// See [`basrelief_kernel::make_steps`].
    ///
    /// # Errors
    /// The wiring is invalid.
    fn make_steps(
        &mut self,
        progress: &mut dyn FnMut(&mut Self) -> bool,
        steps: usize,
        hand_on: &mut dyn FnMut(StepBatch),
    ) -> Result<(), WiringError>;
    /// See [`basrelief_kernel::stats::unit_stats`].
    fn unit_stats(&mut self) -> UnitStats;
}

/// Implements [`MachineEngines`] for a machine.
macro_rules! compile_engines {
    ($machine:ty) => {
        impl $crate::MachineEngines for $machine {
            fn netlist(&mut self) -> Result<basrelief_kernel::Netlist, basrelief_kernel::WiringError> {
                basrelief_kernel::Netlist::of(self)
            }

            fn run_with(
                &mut self,
                engine: basrelief_kernel::Engine,
                probe: Option<&mut dyn basrelief_kernel::Probe>,
                limits: basrelief_kernel::RunLimits<'_, Self>,
            ) -> basrelief_kernel::RunReport {
                basrelief_kernel::run_with(self, engine, probe, limits)
            }

            fn run_recorded(
                &mut self,
                engine: basrelief_kernel::Engine,
                probe: Option<&mut dyn basrelief_kernel::Probe>,
                limits: basrelief_kernel::RunLimits<'_, Self>,
                chunk_bytes: usize,
                keep: &mut dyn FnMut(basrelief_kernel::recording::RecordingChunk),
            ) -> basrelief_kernel::RunReport {
                basrelief_kernel::run_recorded(self, engine, probe, limits, chunk_bytes, keep)
            }

            fn run_functional(&mut self, progress: &mut dyn FnMut(&mut Self) -> bool) -> Result<(), String> {
                basrelief_kernel::run_functional(self, progress)
            }

            fn make_steps(
                &mut self,
                progress: &mut dyn FnMut(&mut Self) -> bool,
                steps: usize,
                hand_on: &mut dyn FnMut(basrelief_kernel::StepBatch),
            ) -> Result<(), basrelief_kernel::WiringError> {
                basrelief_kernel::make_steps(self, progress, steps, hand_on)
            }

            fn unit_stats(&mut self) -> basrelief_kernel::stats::UnitStats {
                basrelief_kernel::stats::unit_stats(self)
            }
        }
    };
}
pub(crate) use compile_engines;
