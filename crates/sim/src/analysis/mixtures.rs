//! Mixtures of two runs: the cycles of run A with a subset of the causes as in run B.

use super::recorded_run::{Cause, ExplainOptions, RecordedRun};
use crate::observer::KeptRecording;
use crate::options::{AnalysisPolicy, Overrides, RunOptions};
use crate::recording::{LoadedRecording, resimulated_cycles};
use crate::run::run;
use basrelief_machines::MachineConfig;
use basrelief_report::number::round6;
use basrelief_threads as threads;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A measured mixture.
#[derive(Clone, Debug)]
pub(super) struct Mixture {
    pub(super) cycles: u64,
    /// True if the machine ran; false if a recording was resimulated.
    pub(super) needed_run: bool,
    /// Parameters that differ from run A and that no cause names.
    pub(super) derived: Vec<String>,
}

/// Measured mixtures by subset: bit n stands for cause n.
pub(super) struct Mixtures {
    measured: BTreeMap<u64, Mixture>,
    causes: usize,
}

/// Everything that a mixture depends on.
struct MixtureSource<'a> {
    a: &'a RecordedRun,
    b: &'a RecordedRun,
    causes: &'a [Cause],
    options: &'a ExplainOptions<'a>,
}

impl Mixtures {
    /// Measures these subsets. Those that cannot be measured are left out. Mixtures with the same work share one run.
    pub(super) fn measure(
        a: &RecordedRun,
        b: &RecordedRun,
        causes: &[Cause],
        wanted: &[u64],
        options: &ExplainOptions<'_>,
    ) -> Self {
        let source = MixtureSource { a, b, causes, options };
        let done = AtomicUsize::new(0);
        let work = causes.iter().enumerate().filter(|(_, cause)| cause.is_work).fold(0, |mask, (n, _)| mask | 1 << n);
        let mut by_work: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
        for &subset in wanted {
            by_work.entry(subset & work).or_default().push(subset);
        }
        let measured = Mutex::new(BTreeMap::new());
        threads::par_map(by_work.into_iter().collect(), |(part, subsets): (u64, Vec<u64>)| {
            let recording = source.recording(part, work);
            for subset in subsets {
                if let Some(mixture) = source.mixture(subset, recording.as_ref()) {
                    measured.lock().unwrap_or_else(std::sync::PoisonError::into_inner).insert(subset, mixture);
                }
                (options.progress)(done.fetch_add(1, Ordering::Relaxed) + 1, wanted.len());
            }
        });
        let measured = measured.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Self { measured, causes: causes.len() }
    }

    pub(super) fn get(&self, subset: u64) -> Option<&Mixture> {
        self.measured.get(&subset)
    }

    /// Returns the Shapley value of each cause; `None` if a subset was not measured. The value of cause n is the mean of its effect over
    /// all orders. A subset S of the other causes comes before n in |S|! (N - 1 - |S|)! of the N! orders.
    pub(super) fn shapley_values(&self) -> Option<Vec<f64>> {
        let all = 1_u64 << self.causes;
        let cycles = (0..all).map(|subset| self.get(subset).map(|of| of.cycles as f64)).collect::<Option<Vec<f64>>>()?;
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        let value = |n: usize| {
            let without = (0..all as usize).filter(|subset| subset & (1 << n) == 0);
            let weighed = without.map(|subset| {
                let before = subset.count_ones() as usize;
                let weight = factorial(before) * factorial(self.causes - 1 - before) / factorial(self.causes);
                weight * (cycles[subset | 1 << n] - cycles[subset])
            });
            round6(weighed.sum())
        };
        Some((0..self.causes).map(value).collect())
    }
}

/// A recording with the work of a mixture.
enum WorkRecording<'a> {
    Known(&'a LoadedRecording),
    Run(Box<LoadedRecording>),
}

impl<'a> MixtureSource<'a> {
    /// Returns run A with these causes as in B.
    fn mixed(&self, subset: u64) -> Overrides {
        let mut overrides = self.a.recording.overrides.clone();
        let chosen = self.causes.iter().enumerate().filter(|(n, _)| subset & (1 << n) != 0);
        overrides.settings.extend(chosen.flat_map(|(_, cause)| cause.set.clone()));
        overrides
    }

    fn config(&self, overrides: &Overrides) -> Option<MachineConfig> {
        overrides.config(self.a.config().machine(), &[]).ok()
    }

    /// Returns a recording with these work causes as in B: that of A or B, or that of a new run.
    fn recording(&self, part: u64, work: u64) -> Option<WorkRecording<'a>> {
        match part {
            0 => Some(WorkRecording::Known(&self.a.recording)),
            part if part == work => Some(WorkRecording::Known(&self.b.recording)),
            part => self.run(part).map(|recording| WorkRecording::Run(Box::new(recording))),
        }
    }

    fn run(&self, subset: u64) -> Option<LoadedRecording> {
        let (overrides, input) = (self.mixed(subset), (self.options.input?)()?);
        let options = RunOptions {
            config: self.config(&overrides)?,
            overrides,
            exact: false,
            recording: AnalysisPolicy::Always,
            budget: self.options.budget.clone(),
            ..RunOptions::default()
        };
        let mut kept = KeptRecording::new(self.options.budget);
        let ran = run(input, &options, &mut kept, None).ok()?;
        let is_same = ran.report.input.sha256 == self.a.recording.result.input.sha256;
        let recording = LoadedRecording::read(&mut Cursor::new(kept.bytes()), self.options.budget).ok()?;
        (is_same && ran.recording_is_complete).then_some(recording)
    }

    fn mixture(&self, subset: u64, recording: Option<&WorkRecording<'_>>) -> Option<Mixture> {
        let overrides = self.mixed(subset);
        let config = self.config(&overrides)?;
        let all = (1 << self.causes.len()) - 1;
        let known = [(0, self.a.cycles), (all, self.b.cycles)].into_iter().find(|(of, _)| *of == subset);
        let resimulated = match recording {
            _ if known.is_some() => known.map(|(_, cycles)| (cycles, false)),
            Some(WorkRecording::Known(recording)) => resimulated_cycles(recording, &config).map(|cycles| (cycles, false)),
            Some(WorkRecording::Run(recording)) => resimulated_cycles(recording, &config).map(|cycles| (cycles, true)),
            None => None,
        };
        // Some timing parameters change the work, for example credits for fewer requests than a step makes.
        let run = || Some((resimulated_cycles(&self.run(subset)?, &config)?, true));
        let (cycles, needed_run) = resimulated.or_else(run)?;
        Some(Mixture { cycles, needed_run, derived: self.derived(&config) })
    }

    fn derived(&self, config: &MachineConfig) -> Vec<String> {
        let named: BTreeSet<&String> = self.causes.iter().flat_map(|cause| &cause.set).map(|(key, _)| key).collect();
        let (of_a, mixed) = (self.a.config().parameters(), config.parameters());
        let differing = of_a.iter().zip(mixed).filter(|(a, mixed)| a.default != mixed.default);
        differing.map(|(_, mixed)| mixed.key).filter(|key| !named.contains(key)).collect()
    }
}
