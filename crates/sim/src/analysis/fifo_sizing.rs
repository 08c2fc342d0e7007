//! FIFO sizing: finds the smallest FIFOs that keep the cycles, by repeated resimulation.
//!
//! Without a memory, cycles are monotone in a depth. By law 2 a step starts when its inputs are visible and its output slots are free,
//! so its start is a maximum of times, each later by a constant. More slots only remove terms of a maximum. A memory breaks this:
//! requests that arrive earlier may be served in another order, or find another row open, and some answers then come later.
//!
//! 1. The *least depth* of each FIFO alone is found by trying every depth from 1 upward, with all other FIFOs as recorded. No smaller
//!    depth keeps the cycles, whether cycles are monotone or not. Beyond [`TRIED`] slots the search bisects.
//! 2. If all least depths together keep the cycles, they are the result.
//! 3. Otherwise the search descends from the high-water marks, or from the recorded depths if these fail. It bisects one FIFO at a time
//!    between its least depth and its current depth, the FIFO with most area to save first, until no FIFO shrinks further.
//! 4. Last, each FIFO is tried with one slot less, so that every result is shown to have no spare slot.
//!
//! The cycles of each result are exact, because it is resimulated as a whole.

use crate::build::build_warning;
use crate::options::OverridesLoader;
use crate::recording::{LoadedRecording, RecordingError, config_error, netlist_of_same_work, of_build};
use basrelief_kernel::{HardwareKind, Netlist, Outcome, RunReport};
use basrelief_machines::{MachineConfig, MachineSpec, for_machine};
use basrelief_parameters::to_json;
use basrelief_report::model::Hardware;
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
    /// Recordings of other builds of the simulator, and FIFOs that keep their depths, one sentence each.
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
    /// Area of the FIFOs \[gate equivalents\].
    pub area_ge: u64,
    /// Depth of each FIFO with a parameter, by name.
    pub depths: Vec<(String, u32)>,
    /// Least depth of each FIFO alone, with all others as recorded. Empty for the recorded depths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub least_alone: Vec<(String, u32)>,
}

/// Largest depth up to which every depth is tried \[slots\].
const TRIED: u32 = 64;

/// A FIFO whose depth is a parameter.
struct SizedFifo {
    name: String,
    depth: u32,
    /// Largest occupancy in all recordings \[slots\].
    high_water: u32,
    /// Size of a slot \[bits\].
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
    let one_of = |number| move |error| RecordingError::OneOf { number, error: Box::new(error) };
    let read = |(number, recording): (usize, &mut dyn Read)| LoadedRecording::read(recording, budget).map_err(one_of(number));
    let loaded = recordings.into_iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = loaded.first() else { return Err(RecordingError::Format("there is no recording".into())) };
    let config = &first.config;
    for (number, other) in loaded.iter().enumerate() {
        if let Some(difference) = difference(config, &other.config) {
            return Err(RecordingError::Different { number, difference });
        }
    }
    let mut sizing = for_machine!(config, spec => SizingSearch::new(spec, &loaded)?.all_choices(within_percent))?;
    let mut builds: Vec<_> = loaded.iter().filter_map(|recording| build_warning(&recording.build)).collect();
    builds.dedup();
    sizing.warnings.splice(0..0, builds);
    Ok(sizing)
}

/// Describes the first difference of two machines; `None` if they are equal.
fn difference(first: &MachineConfig, other: &MachineConfig) -> Option<String> {
    let (name, other_name) = (first.machine().name, other.machine().name);
    if name != other_name {
        return Some(format!("the machine is `{other_name}`, expected `{name}` as in the first input"));
    }
    let (of_first, of_other) = (first.parameters(), other.parameters());
    let (here, there) = of_first.iter().zip(&of_other).find(|(here, there)| here.default != there.default)?;
    Some(format!("`{}` is {}, expected {} as in the first input", there.key, there.default, here.default))
}

struct SizingSearch<'a, S> {
    spec: &'a S,
    recordings: &'a [LoadedRecording],
    /// Loads the recorded parameters with more settings.
    loader: OverridesLoader<'a, S>,
    /// Netlist of each recorded run.
    netlists: Vec<Netlist>,
    fifos: Vec<SizedFifo>,
    /// FIFOs that keep their depths, because the work of a unit depends on them.
    kept: Vec<String>,
    recorded: Vec<RunReport>,
}

impl<'a, S: MachineSpec> SizingSearch<'a, S> {
    fn new(spec: &'a S, recordings: &'a [LoadedRecording]) -> Result<Self, RecordingError> {
        let loader = recordings[0].overrides.loader().map_err(config_error)?;
        let netlists =
            recordings.iter().map(|recording| netlist_of_same_work(spec, spec, recording.input)).collect::<Result<_, _>>()?;
        let mut sizing = Self { spec, recordings, loader, netlists, fifos: vec![], kept: vec![], recorded: vec![] };
        sizing.recorded = (0..recordings.len()).map(|number| sizing.resimulated(number, &[])).collect::<Result<_, _>>()?;
        if let Some(run) = sizing.recorded.iter().find(|run| run.outcome != Outcome::Complete) {
            return Err(RecordingError::Incomplete(format!("{:?}", run.outcome)));
        }
        let values = to_json(spec).unwrap_or_default();
        let of_report = sizing.recorded[0].fifos.iter();
        let own = of_report.filter(|fifo| values["fifo"].get(&fifo.name).is_some());
        let sized = own.map(|fifo| {
            let all = sizing.recorded.iter().flat_map(|run| &run.fifos).filter(|other| other.name == fifo.name);
            SizedFifo {
                name: fifo.name.clone(),
                depth: fifo.depth as u32,
                high_water: all.map(|fifo| fifo.high_water() as u32).max().unwrap_or(1).max(1),
                bits: u64::from(sizing.netlists[0].fifo_bits(&fifo.name)),
            }
        });
        for fifo in sized.collect::<Vec<_>>() {
            if sizing.changes_work(&fifo)? { sizing.kept.push(fifo.name) } else { sizing.fifos.push(fifo) }
        }
        Ok(sizing)
    }

    /// Returns true if the machine does other work with one slot more. A unit may derive a size from a depth.
    fn changes_work(&self, fifo: &SizedFifo) -> Result<bool, RecordingError> {
        let deeper = vec![(format!("fifo.{}.depth", fifo.name), (fifo.depth + 1).to_string())];
        let spec = self.loader.load(&deeper).map_err(config_error)?;
        match netlist_of_same_work(self.spec, &spec, self.recordings[0].input) {
            Ok(_) => Ok(false),
            Err(RecordingError::OtherWork(_)) => Ok(true),
            Err(error) => Err(error),
        }
    }

    fn warnings(&self) -> Vec<String> {
        let kept = |name: &String| format!("`fifo.{name}.depth` stays as recorded, because the work of a unit depends on it");
        self.kept.iter().map(kept).collect()
    }

    fn all_choices(&self, within_percent: &[f64]) -> Result<FifoSizing, RecordingError> {
        let as_recorded: Vec<u32> = self.fifos.iter().map(|fifo| fifo.depth).collect();
        let mut choices = vec![self.choice(None, &as_recorded, &[])?];
        for &percent in within_percent {
            let least = self.least_alone(percent)?;
            let depths = self.smallest_together(&least, percent)?;
            choices.push(self.choice(Some(percent), &depths, &least)?);
        }
        Ok(FifoSizing { machine: S::NAME.into(), choices, warnings: self.warnings() })
    }

    fn choice(&self, within_percent: Option<f64>, depths: &[u32], least: &[u32]) -> Result<DepthChoice, RecordingError> {
        let cycles = (0..self.recordings.len()).map(|number| self.resimulated(number, depths).map(|run| run.marked_cycles()));
        let slots = depths.iter().map(|depth| u64::from(*depth)).sum();
        let bits = depths.iter().zip(&self.fifos).map(|(depth, fifo)| u64::from(*depth) * fifo.bits).sum();
        let area_ge = self.areas(depths)?.iter().sum();
        let named = |depths: &[u32]| self.fifos.iter().zip(depths).map(|(fifo, depth)| (fifo.name.clone(), *depth)).collect();
        let cycles = cycles.collect::<Result<_, _>>()?;
        Ok(DepthChoice { within_percent, cycles, slots, bits, area_ge, depths: named(depths), least_alone: named(least) })
    }

    /// Returns the area of each FIFO with these depths \[gate equivalents\], as a report states it.
    fn areas(&self, depths: &[u32]) -> Result<Vec<u64>, RecordingError> {
        let spec = self.loader.load(&self.settings(depths)).map_err(config_error)?;
        let (hardware, model) = (spec.hardware().map_err(config_error)?, spec.area_model());
        let area = |fifo: &SizedFifo| {
            let pieces = hardware.iter().filter(|piece| piece.kind == HardwareKind::Fifo && piece.place == fifo.name);
            pieces.map(|piece| Hardware::new(piece, &model).area.area_ge).sum()
        };
        Ok(self.fifos.iter().map(area).collect())
    }

    /// Returns the least depth of each FIFO that keeps the cycles if all others stay as recorded.
    fn least_alone(&self, percent: f64) -> Result<Vec<u32>, RecordingError> {
        let recorded: Vec<u32> = self.fifos.iter().map(|fifo| fifo.depth).collect();
        let least = threads::par_map((0..recorded.len()).collect(), |n| {
            for depth in 1..recorded[n].min(TRIED + 1) {
                if self.keeps_cycles(&with_depth(&recorded, n, depth), percent)? {
                    return Ok(depth);
                }
            }
            self.bisect(&recorded, n, TRIED.min(recorded[n] - 1), percent)
        });
        least.into_iter().collect()
    }

    /// Returns depths that keep the cycles together, with as little area as the descent finds.
    fn smallest_together(&self, least: &[u32], percent: f64) -> Result<Vec<u32>, RecordingError> {
        if self.keeps_cycles(least, percent)? {
            return self.without_spare_slots(least.to_vec(), percent);
        }
        let mut depths: Vec<u32> = self.fifos.iter().map(|fifo| fifo.high_water).collect();
        if !self.keeps_cycles(&depths, percent)? {
            depths = self.fifos.iter().map(|fifo| fifo.depth).collect();
        }
        let (now, then) = (self.areas(&depths)?, self.areas(least)?);
        let mut order: Vec<usize> = (0..self.fifos.len()).collect();
        // The sort is stable: ties keep the order of the block diagram.
        order.sort_by_key(|&n| std::cmp::Reverse(now[n].saturating_sub(then[n])));
        loop {
            let before = depths.clone();
            for &n in &order {
                depths[n] = self.bisect(&depths, n, least[n].min(depths[n]) - 1, percent)?;
            }
            if depths == before {
                return self.without_spare_slots(depths, percent);
            }
        }
    }

    /// Takes single slots away until one slot less in any FIFO exceeds the tolerance.
    fn without_spare_slots(&self, mut depths: Vec<u32>, percent: f64) -> Result<Vec<u32>, RecordingError> {
        loop {
            let smaller = (0..depths.len()).filter(|&n| depths[n] > 1).map(|n| with_depth(&depths, n, depths[n] - 1)).collect();
            let kept = threads::par_map(smaller, |depths: Vec<u32>| -> Result<_, RecordingError> {
                Ok(self.keeps_cycles(&depths, percent)?.then_some(depths))
            });
            match kept.into_iter().find_map(Result::transpose) {
                Some(fewer) => depths = fewer?,
                None => return Ok(depths),
            }
        }
    }

    /// Returns the smallest depth of FIFO `n` that keeps the cycles with the given other depths, by bisection above `too_small`.
    fn bisect(&self, depths: &[u32], n: usize, mut too_small: u32, percent: f64) -> Result<u32, RecordingError> {
        let mut enough = depths[n];
        while enough - too_small > 1 {
            let middle = too_small + (enough - too_small) / 2;
            if self.keeps_cycles(&with_depth(depths, n, middle), percent)? { enough = middle } else { too_small = middle }
        }
        Ok(enough)
    }

    /// True if all runs finish within the tolerance.
    fn keeps_cycles(&self, depths: &[u32], percent: f64) -> Result<bool, RecordingError> {
        let all: Vec<_> = self.recorded.iter().enumerate().collect();
        let kept = threads::par_map(all, |(number, recorded)| {
            let most = recorded.marked_cycles() as f64 * (1.0 + percent / 100.0);
            let cycles = self.cycles(number, depths);
            cycles.map(|cycles| cycles.is_some_and(|cycles| cycles as f64 <= most))
        });
        kept.into_iter().try_fold(true, |all, kept| Ok(all && kept?))
    }

    /// Resimulates recording `number` with these depths; with the recorded depths if the list is empty.
    fn resimulated(&self, number: usize, depths: &[u32]) -> Result<RunReport, RecordingError> {
        let LoadedRecording { recording, build, .. } = &self.recordings[number];
        recording.resimulate(self.netlist(number, depths)?).map_err(|error| of_build(build, error.into()))
    }

    /// Returns the render cycles with these depths; `None` if the run does not finish.
    fn cycles(&self, number: usize, depths: &[u32]) -> Result<Option<u64>, RecordingError> {
        Ok(self.recordings[number].recording.cycles(self.netlist(number, depths)?)?)
    }

    fn settings(&self, depths: &[u32]) -> Vec<(String, String)> {
        let set = |(fifo, depth): (&SizedFifo, &u32)| (format!("fifo.{}.depth", fifo.name), depth.to_string());
        self.fifos.iter().zip(depths).map(set).collect()
    }

    /// Returns the netlist of the machine of recording `number` with these depths.
    fn netlist(&self, number: usize, depths: &[u32]) -> Result<Netlist, RecordingError> {
        let spec = self.loader.load(&self.settings(depths)).map_err(config_error)?;
        let netlist = self.recordings[number].input.shape(&spec).map_err(config_error)?;
        self.netlists[number].same_work(&netlist).map_err(RecordingError::OtherWork)?;
        Ok(netlist)
    }
}

fn with_depth(depths: &[u32], n: usize, depth: u32) -> Vec<u32> {
    let mut changed = depths.to_vec();
    changed[n] = depth;
    changed
}
