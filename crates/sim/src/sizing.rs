//! The smallest FIFOs that keep the cycles: by timing recorded work again, under one choice of depths after another.
//!
//! A FIFO never needs more slots than it ever held: with so many every push finds room when it did, and nothing changes. From there each
//! FIFO in turn, the one with the most bits first, is made as small as the cycles allow, by bisection; a second turn takes what the first
//! has left. Where units share a memory, cycles are not monotone in a depth, so the choice is the best that was found, and not proved to
//! be the smallest there is. Its cycles are exact: each choice is timed as a whole.

use crate::machines::{MachineSpec, for_machine};
use crate::tape::{Loaded, TapeFileError};
use basrelief_kernel::{Netlist, Outcome, RunReport};
use basrelief_threads as threads;
use serde::Serialize;
use std::io::Read;

/// FIFOs as they were, and smaller ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sizes {
    /// The machine.
    pub machine: String,
    /// As recorded, then one for each share of cycles that may be lost.
    pub choices: Vec<Choice>,
}

/// A choice of depths.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// Cycles of the frames that may be lost \[percent\]; none of the recorded one.
    pub within_percent: Option<f64>,
    /// Cycles of the frames, of each tape.
    pub cycles: Vec<u64>,
    /// Slots of all FIFOs.
    pub slots: u64,
    /// Bits of these slots.
    pub bits: u64,
    /// Depth of each FIFO that has a parameter, by its name.
    pub depths: Vec<(String, u32)>,
}

/// A FIFO that has a parameter of its own.
struct Sized {
    name: String,
    depth: u32,
    bits: u64,
}

/// The smallest depths that keep the cycles of all these tapes, for each of these shares of them that may be lost \[percent\].
///
/// # Errors
/// A tape that is none, or tapes of different machines or parameters; a run that does not come to its end as it was.
pub fn size_fifos(
    tapes: Vec<&mut dyn Read>,
    within_percent: &[f64],
    budget: &basrelief_input::Budget,
) -> Result<Sizes, TapeFileError> {
    let loaded = tapes.into_iter().map(|tape| Loaded::read(tape, budget)).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = loaded.first() else { return Err(TapeFileError::Format("there is none".into())) };
    let config = first.config()?;
    for other in &loaded {
        if other.config()? != config {
            return Err(TapeFileError::Config("the tapes are of different machines, or of different parameters".into()));
        }
    }
    for_machine!(&config, spec => Sizing::new(spec, &loaded)?.all(within_percent))
}

struct Sizing<'a, S> {
    spec: &'a S,
    tapes: &'a [Loaded],
    fifos: Vec<Sized>,
    recorded: Vec<RunReport>,
}

impl<'a, S: MachineSpec> Sizing<'a, S> {
    fn new(spec: &'a S, tapes: &'a [Loaded]) -> Result<Self, TapeFileError> {
        let mut sizing = Self { spec, tapes, fifos: vec![], recorded: vec![] };
        sizing.recorded = tapes.iter().map(|tape| sizing.timed(tape, &[])).collect::<Result<_, _>>()?;
        if let Some(run) = sizing.recorded.iter().find(|run| run.outcome != Outcome::Complete) {
            return Err(TapeFileError::Incomplete(format!("{:?}", run.outcome)));
        }
        let values = serde_json::to_value(spec).unwrap_or_default();
        let shape = tapes[0].way.shape(spec).map_err(crate::tape::config)?;
        let of_report = sizing.recorded[0].fifos.iter();
        let own = of_report.filter(|fifo| values["fifo"].get(&fifo.name).is_some());
        sizing.fifos = own
            .map(|fifo| Sized { name: fifo.name.clone(), depth: fifo.depth as u32, bits: u64::from(shape.fifo_bits(&fifo.name)) })
            .collect();
        Ok(sizing)
    }

    fn all(&self, within_percent: &[f64]) -> Result<Sizes, TapeFileError> {
        let as_recorded: Vec<u32> = self.fifos.iter().map(|fifo| fifo.depth).collect();
        let mut choices = vec![self.choice(None, &as_recorded)?];
        for &percent in within_percent {
            let depths = self.smallest(percent)?;
            choices.push(self.choice(Some(percent), &depths)?);
        }
        Ok(Sizes { machine: S::NAME.into(), choices })
    }

    fn choice(&self, within_percent: Option<f64>, depths: &[u32]) -> Result<Choice, TapeFileError> {
        let cycles = self.tapes.iter().map(|tape| self.timed(tape, depths).map(|run| run.marked_cycles()));
        let slots = depths.iter().map(|depth| u64::from(*depth)).sum();
        let bits = depths.iter().zip(&self.fifos).map(|(depth, fifo)| u64::from(*depth) * fifo.bits).sum();
        let depths = self.fifos.iter().zip(depths).map(|(fifo, depth)| (fifo.name.clone(), *depth)).collect();
        Ok(Choice { within_percent, cycles: cycles.collect::<Result<_, _>>()?, slots, bits, depths })
    }

    /// The smallest depths that are found.
    fn smallest(&self, percent: f64) -> Result<Vec<u32>, TapeFileError> {
        let held = |n: usize| {
            let name = &self.fifos[n].name;
            let most = self.recorded.iter().flat_map(|run| &run.fifos).filter(|f| f.name == *name).map(|f| f.high_water());
            most.max().unwrap_or(1).max(1) as u32
        };
        let mut depths: Vec<u32> = (0..self.fifos.len()).map(held).collect();
        let mut order: Vec<usize> = (0..self.fifos.len()).collect();
        // Stable: of equals the first in the block diagram is first.
        order.sort_by_key(|&n| std::cmp::Reverse(u64::from(depths[n]) * self.fifos[n].bits));
        for _ in 0..2 {
            for &n in &order {
                depths[n] = self.bisect(&depths, n, percent)?;
            }
        }
        Ok(depths)
    }

    /// The smallest depth of FIFO `n` beside the others that keeps the cycles, if they were monotone in it.
    fn bisect(&self, depths: &[u32], n: usize, percent: f64) -> Result<u32, TapeFileError> {
        let (mut too_small, mut enough) = (0, depths[n]);
        while enough - too_small > 1 {
            let middle = too_small + (enough - too_small) / 2;
            let mut tried = depths.to_vec();
            tried[n] = middle;
            if self.keeps(&tried, percent)? { enough = middle } else { too_small = middle }
        }
        Ok(enough)
    }

    /// Whether all runs come to their end in time.
    fn keeps(&self, depths: &[u32], percent: f64) -> Result<bool, TapeFileError> {
        let both: Vec<_> = self.tapes.iter().zip(&self.recorded).collect();
        let kept = threads::map(both, |(tape, recorded)| {
            let most = recorded.marked_cycles() as f64 * (1.0 + percent / 100.0);
            let cycles = self.cycles(tape, depths);
            cycles.map(|cycles| cycles.is_some_and(|cycles| cycles as f64 <= most))
        });
        kept.into_iter().try_fold(true, |all, kept| Ok(all && kept?))
    }

    /// A tape with these depths; with none, as it was.
    fn timed(&self, tape: &Loaded, depths: &[u32]) -> Result<RunReport, TapeFileError> {
        Ok(tape.tape.resimulate(self.shape(tape, depths)?)?)
    }

    /// Its cycles; none where it does not come to its end.
    fn cycles(&self, tape: &Loaded, depths: &[u32]) -> Result<Option<u64>, TapeFileError> {
        Ok(tape.tape.cycles(self.shape(tape, depths)?)?)
    }

    /// The machine of a tape with these depths.
    fn shape(&self, tape: &Loaded, depths: &[u32]) -> Result<Netlist, TapeFileError> {
        let set = |(fifo, depth): (&Sized, &u32)| (format!("fifo.{}.depth", fifo.name), depth.to_string());
        let set: Vec<(String, String)> = self.fifos.iter().zip(depths).map(set).collect();
        let spec: S = tape.given.load(&set).map_err(|error| TapeFileError::Config(error.to_string()))?;
        let shape = tape.way.shape(&spec).map_err(crate::tape::config)?;
        tape.way.shape(self.spec).map_err(crate::tape::config)?.same_work(&shape).map_err(TapeFileError::OtherWork)?;
        Ok(shape)
    }
}
