//! FIFO sizing: finds the smallest FIFOs that keep the cycles, by repeated resimulation.
//!
//! The search starts at the highest occupancy of each FIFO, because that many slots change nothing. It then shrinks each FIFO by
//! bisection as far as the cycles allow, the FIFO with the most bits first. A second pass shrinks further what the first pass left.
//! If units share a memory, cycles are not monotonic in a depth. The result is therefore the best one found, without a proof that it is
//! the smallest. Its cycles are exact, because every result is resimulated as a whole.

use crate::build::build_warning;
use crate::recording::{LoadedRecording, RecordingError, config_error};
use basrelief_kernel::{Netlist, Outcome, RunReport};
use basrelief_machines::{MachineSpec, for_machine};
use basrelief_threads as threads;
use serde::Serialize;
use std::io::Read;

/// Results of FIFO sizing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FifoSizing {
    /// Name of the machine.
    pub machine: String,
    /// The recorded depths, then one choice for each tolerance.
    pub choices: Vec<DepthChoice>,
    /// Recordings of other builds of the simulator, one sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// Depths of all FIFOs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DepthChoice {
    /// Tolerance in render cycles \[percent\]; `None` for the recorded depths.
    pub within_percent: Option<f64>,
    /// Render cycles of each recording.
    pub cycles: Vec<u64>,
    /// Sum of the depths \[slots\].
    pub slots: u64,
    /// Size of all slots \[bits\].
    pub bits: u64,
    /// Depth of each FIFO with a parameter, by name.
    pub depths: Vec<(String, u32)>,
}

/// A FIFO whose depth is a parameter.
struct SizedFifo {
    name: String,
    depth: u32,
    bits: u64,
}

/// Finds the smallest depths that keep the cycles of all recordings, for each tolerance \[percent\].
///
/// # Errors
/// An invalid recording, recordings of different machines or parameters, or a recorded run that did not finish.
pub fn size_fifos(
    recordings: Vec<&mut dyn Read>,
    within_percent: &[f64],
    budget: &basrelief_input::MemoryPool,
) -> Result<FifoSizing, RecordingError> {
    let loaded =
        recordings.into_iter().map(|recording| LoadedRecording::read(recording, budget)).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = loaded.first() else { return Err(RecordingError::Format("there is no recording".into())) };
    let config = first.config(&[])?;
    for other in &loaded {
        if other.config(&[])? != config {
            return Err(RecordingError::Config("the recordings have different machines or different parameters".into()));
        }
    }
    let mut sizing = for_machine!(&config, spec => SizingSearch::new(spec, &loaded)?.all_choices(within_percent))?;
    sizing.warnings = loaded.iter().filter_map(|recording| build_warning(&recording.build)).collect();
    sizing.warnings.dedup();
    Ok(sizing)
}

struct SizingSearch<'a, S> {
    spec: &'a S,
    recordings: &'a [LoadedRecording],
    fifos: Vec<SizedFifo>,
    recorded: Vec<RunReport>,
}

impl<'a, S: MachineSpec> SizingSearch<'a, S> {
    fn new(spec: &'a S, recordings: &'a [LoadedRecording]) -> Result<Self, RecordingError> {
        let mut sizing = Self { spec, recordings, fifos: vec![], recorded: vec![] };
        sizing.recorded = recordings.iter().map(|recording| sizing.resimulated(recording, &[])).collect::<Result<_, _>>()?;
        if let Some(run) = sizing.recorded.iter().find(|run| run.outcome != Outcome::Complete) {
            return Err(RecordingError::Incomplete(format!("{:?}", run.outcome)));
        }
        let values = serde_json::to_value(spec).unwrap_or_default();
        let netlist = recordings[0].input.shape(spec).map_err(config_error)?;
        let of_report = sizing.recorded[0].fifos.iter();
        let own = of_report.filter(|fifo| values["fifo"].get(&fifo.name).is_some());
        sizing.fifos = own
            .map(|fifo| SizedFifo {
                name: fifo.name.clone(),
                depth: fifo.depth as u32,
                bits: u64::from(netlist.fifo_bits(&fifo.name)),
            })
            .collect();
        Ok(sizing)
    }

    fn all_choices(&self, within_percent: &[f64]) -> Result<FifoSizing, RecordingError> {
        let as_recorded: Vec<u32> = self.fifos.iter().map(|fifo| fifo.depth).collect();
        let mut choices = vec![self.choice(None, &as_recorded)?];
        for &percent in within_percent {
            let depths = self.smallest(percent)?;
            choices.push(self.choice(Some(percent), &depths)?);
        }
        Ok(FifoSizing { machine: S::NAME.into(), choices, warnings: vec![] })
    }

    fn choice(&self, within_percent: Option<f64>, depths: &[u32]) -> Result<DepthChoice, RecordingError> {
        let cycles = self.recordings.iter().map(|recording| self.resimulated(recording, depths).map(|run| run.marked_cycles()));
        let slots = depths.iter().map(|depth| u64::from(*depth)).sum();
        let bits = depths.iter().zip(&self.fifos).map(|(depth, fifo)| u64::from(*depth) * fifo.bits).sum();
        let depths = self.fifos.iter().zip(depths).map(|(fifo, depth)| (fifo.name.clone(), *depth)).collect();
        Ok(DepthChoice { within_percent, cycles: cycles.collect::<Result<_, _>>()?, slots, bits, depths })
    }

    /// Returns the smallest depths found.
    fn smallest(&self, percent: f64) -> Result<Vec<u32>, RecordingError> {
        let high_water = |n: usize| {
            let name = &self.fifos[n].name;
            let most = self.recorded.iter().flat_map(|run| &run.fifos).filter(|f| f.name == *name).map(|f| f.high_water());
            most.max().unwrap_or(1).max(1) as u32
        };
        let mut depths: Vec<u32> = (0..self.fifos.len()).map(high_water).collect();
        let mut order: Vec<usize> = (0..self.fifos.len()).collect();
        // The sort is stable: ties keep the order of the block diagram.
        order.sort_by_key(|&n| std::cmp::Reverse(u64::from(depths[n]) * self.fifos[n].bits));
        for _ in 0..2 {
            for &n in &order {
                depths[n] = self.bisect(&depths, n, percent)?;
            }
        }
        Ok(depths)
    }

    /// Returns the smallest depth of FIFO `n` that keeps the cycles with the given other depths, by bisection.
    fn bisect(&self, depths: &[u32], n: usize, percent: f64) -> Result<u32, RecordingError> {
        let (mut too_small, mut enough) = (0, depths[n]);
        while enough - too_small > 1 {
            let middle = too_small + (enough - too_small) / 2;
            let mut tried = depths.to_vec();
            tried[n] = middle;
            if self.keeps_cycles(&tried, percent)? { enough = middle } else { too_small = middle }
        }
        Ok(enough)
    }

    /// True if all runs finish within the tolerance.
    fn keeps_cycles(&self, depths: &[u32], percent: f64) -> Result<bool, RecordingError> {
        let both: Vec<_> = self.recordings.iter().zip(&self.recorded).collect();
        let kept = threads::par_map(both, |(recording, recorded)| {
            let most = recorded.marked_cycles() as f64 * (1.0 + percent / 100.0);
            let cycles = self.cycles(recording, depths);
            cycles.map(|cycles| cycles.is_some_and(|cycles| cycles as f64 <= most))
        });
        kept.into_iter().try_fold(true, |all, kept| Ok(all && kept?))
    }

    /// Resimulates a recording with these depths; with the recorded depths if the list is empty.
    fn resimulated(&self, recording: &LoadedRecording, depths: &[u32]) -> Result<RunReport, RecordingError> {
        Ok(recording.recording.resimulate(self.netlist(recording, depths)?)?)
    }

    /// Returns the render cycles with these depths; `None` if the run does not finish.
    fn cycles(&self, recording: &LoadedRecording, depths: &[u32]) -> Result<Option<u64>, RecordingError> {
        Ok(recording.recording.cycles(self.netlist(recording, depths)?)?)
    }

    /// Returns the netlist of a recording's machine with these depths.
    fn netlist(&self, recording: &LoadedRecording, depths: &[u32]) -> Result<Netlist, RecordingError> {
        let set = |(fifo, depth): (&SizedFifo, &u32)| (format!("fifo.{}.depth", fifo.name), depth.to_string());
        let set: Vec<(String, String)> = self.fifos.iter().zip(depths).map(set).collect();
        let spec: S = recording.overrides.load(&set).map_err(config_error)?;
        let netlist = recording.input.shape(&spec).map_err(config_error)?;
        let recorded = recording.input.shape(self.spec).map_err(config_error)?;
        recorded.same_work(&netlist).map_err(RecordingError::OtherWork)?;
        Ok(netlist)
    }
}
