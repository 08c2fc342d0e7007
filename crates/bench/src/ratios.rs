//! Ratios of two runs that alternate in one process, so that the host's other load cancels.

use crate::machines::{self, MachineScene, SettingList};
use crate::traces;
use crate::workload::{PreparedRun, RunSample, Workload, WorkloadSize};
use basrelief_threads as threads;
use basrelief_timeline::{PerfettoTrace, TimelineProbe};
use serde::Serialize;
use std::io::sink;

/// Ratio of two runs.
#[derive(Clone, Debug, Serialize)]
pub struct TimeRatio {
    /// Compared runs.
    pub name: String,
    /// Number of pairs of runs.
    pub rounds: usize,
    /// Median of the ratios of the pairs.
    pub median: f64,
    /// Lower quartile.
    pub low: f64,
    /// Upper quartile.
    pub high: f64,
    /// Medians of the two times per fragment, token or byte \[ns\].
    pub ns: [f64; 2],
}

/// A search of 1 cycle and one of 256, otherwise the same: a new one starts every cycle.
const SEARCH_1: SettingList = &[("replacement.lanes", "256"), ("fifo.indexes.depth", "512")];
const SEARCH_256: SettingList = &[("replacement.lanes", "1"), ("fifo.indexes.depth", "512")];

/// Returns the value at this share of the sorted values.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Returns the median of values.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    quantile(&sorted(values), 0.5)
}

/// Runs both alternately, once before counting.
fn ratio(name: &str, rounds: usize, mut above: PreparedRun, mut below: PreparedRun) -> TimeRatio {
    let mut pair = || [above().nanoseconds(), below().nanoseconds()];
    pair();
    let pairs: Vec<[f64; 2]> = (0..rounds).map(|_| pair()).collect();
    let ratios = sorted(pairs.iter().map(|[a, b]| a / b));
    let ns = [0, 1].map(|i| median(pairs.iter().map(|pair| pair[i])));
    let [low, median, high] = [0.25, 0.5, 0.75].map(|share| quantile(&ratios, share));
    TimeRatio { name: name.into(), rounds, median, low, high, ns }
}

/// Prepares a way to simulate a drawing.
fn way(drawing: &MachineScene, run: impl Fn(&MachineScene) -> RunSample + 'static) -> PreparedRun {
    let drawing = drawing.clone();
    Box::new(move || run(&drawing))
}

fn timed(drawing: &MachineScene) -> PreparedRun {
    way(drawing, |drawing| drawing.simulate(None))
}

/// Prepares a run with the timeline of every unit, written to a sink.
fn probed(drawing: &MachineScene) -> PreparedRun {
    let board = drawing.board();
    way(drawing, move |drawing| {
        let chart = Box::new(PerfettoTrace::new(sink(), &board));
        drawing.simulate(Some(&mut TimelineProbe::new(board.clone(), vec![chart])))
    })
}

/// Prepares the workload of this name.
///
/// # Panics
/// Panics if there is none.
pub fn prepared(workloads: &[Workload], name: &str) -> PreparedRun {
    workloads.iter().find(|w| w.name == name).expect("a workload of this name").prepare()
}

/// Measures all ratios, each over this many pairs of runs. Calls `each` after every one.
pub fn ratios(size: WorkloadSize, rounds: usize, mut each: impl FnMut(&TimeRatio)) -> Vec<TimeRatio> {
    let makes = [MachineScene::w1, MachineScene::w2, MachineScene::w3, MachineScene::w4, MachineScene::w5, MachineScene::w6];
    let drawings = makes.map(|make| make(size, &[]));
    let [w1, _, _, w4, ..] = &drawings;
    let search = [SEARCH_256, SEARCH_1].map(|set| MachineScene::w1(size, set));
    let traces = traces::workloads(size);
    let mut all = Vec::new();
    let mut compare = |name: &str, above: PreparedRun, below: PreparedRun| {
        let ratio = ratio(name, rounds, above, below);
        each(&ratio);
        all.push(ratio);
    };
    for (number, drawing) in (1..).zip(&drawings) {
        compare(&format!("W{number}: timed / functional"), timed(drawing), way(drawing, MachineScene::simulate_functional));
    }
    if threads::workers() > 1 {
        for (number, drawing) in (1..).zip(&drawings) {
            compare(
                &format!("W{number}: timed on two threads / on one"),
                way(drawing, MachineScene::simulate_concurrent),
                timed(drawing),
            );
        }
    }
    let machines = machines::workloads(size);
    compare("W1: timed again from its recording / timed", prepared(&machines, "machine/w1/retimed-again"), timed(w1));
    compare("W1: search of 256 cycles / of 1", timed(&search[0]), timed(&search[1]));
    for (name, drawing) in [("W1", w1), ("W4", w4)] {
        compare(&format!("{name}: timeline of every unit / none"), probed(drawing), timed(drawing));
    }
    let read = |form: &str| prepared(&traces, &format!("trace/read/{form}"));
    compare("trace: reading JSON Lines / binary", read("json-lines"), read("binary"));
    compare("trace: reading JSON Lines / binary, both in zstd", read("json-lines-zstd"), read("binary-zstd"));
    all
}
