//! Compact construction of plans, and measurements of their runs.

pub mod random;

use basrelief_kernel::{
    Cycle, Engine, Machine, MemoryConfig, MemoryPart, Netlist, Outcome, Probe, Recorder, RunLimits, RunReport, StallCause,
    UnitReport, make_steps, recording::RecordingChunk, resimulate_with, run, run_functional, run_recorded, run_with, time_steps,
};
use basrelief_kernel_conformance::plan::{
    Plan, PlanCache, PlanFifo, PlanMachine, PlanMemory, PlanPort, PlannedUnit, Token, UnitKind,
};
use std::borrow::Cow;

/// Builder of a plan, with one line per unit or FIFO.
#[derive(Clone, Debug, Default)]
pub struct PlanBuilder(pub Plan);

impl PlanBuilder {
    /// Makes a chain of four tokens through a unit with three cycles per token. `hand::chain` has the cycles computed by hand.
    pub fn chain() -> Self {
        let mut draw = Self::default();
        draw.fifo("a", 1, 1)
            .fifo("b", 2, 1)
            .unit("source", UnitKind::Source { tokens: 4 }, ["", "a"], &[1], &[0])
            .unit("work", UnitKind::Work, ["a", "b"], &[3], &[2])
            .unit("sink", UnitKind::Sink, ["b", ""], &[1], &[0]);
        draw
    }

    pub fn fifo(&mut self, name: &str, depth: usize, latency: u64) -> &mut Self {
        self.0.fifos.push(PlanFifo { name: name.into(), depth, latency, period: 1 });
        self
    }

    /// Adds a unit. FIFO names are separated by spaces. Occupancy and latency are indexed by token.
    pub fn unit(&mut self, name: &str, kind: UnitKind, wires: [&str; 2], occupancy: &[u64], latency: &[u64]) -> &mut Self {
        let [inputs, outputs] = wires.map(|names| names.split_whitespace().map(str::to_owned).collect());
        let (occupancy, latency) = (occupancy.to_vec(), latency.to_vec());
        let (name, after, blocking, issue) = (name.into(), vec![], false, 0);
        self.0.units.push(PlannedUnit { name, kind, inputs, outputs, occupancy, latency, after, blocking, issue, ideal: false });
        self
    }

    pub fn memory(&mut self, memory: PlanMemory, ports: &[(&str, u32)]) -> &mut Self {
        let ports = ports.iter().map(|&(name, outstanding)| PlanPort { name: name.into(), outstanding, flips: None }).collect();
        self.0.memories.push(PlanMemory { ports, ..memory });
        self
    }

    pub fn cache(&mut self, cache: PlanCache) -> &mut Self {
        self.0.caches.push(cache);
        self
    }
}

/// Returns a memory of one bank with rows of 64 bytes and bursts of 32 bytes. A burst occupies the bus for 2 cycles, and the
/// window holds four bursts. From view to column: hit 0, closed 2, conflict 4 + 2 cycles. From column to data: 3 cycles. The
/// times differ, so that a mix-up is visible.
pub fn small_memory() -> PlanMemory {
    let config = MemoryConfig {
        part: MemoryPart::Custom,
        channels: 1,
        channel_bytes: 64,
        window: 4,
        cap: 4,
        cl: 3,
        cwl: 3,
        rcd: 2,
        rp: 4,
        ras: 0,
        rtp: 0,
        wr: 0,
        wtr: 0,
        rrd: 0,
        faw: 0,
        refi: 0,
        rfc: 0,
        burst_bytes: 32,
        burst_cycles: 2,
        banks: 1,
        row_bytes: 64,
        commands_per_cycle: 0,
        issue: 0,
        outstanding: 1,
    };
    PlanMemory { name: "memory".into(), config, ports: vec![], periodic: vec![] }
}

/// Returns the cache `cache` of a port: four sets of one line of 32 bytes, hits after 2 cycles, one look-up per cycle. All look-ups of a
/// step are made at its start.
pub fn small_cache(port: &str) -> PlanCache {
    let (name, port) = ("cache".into(), port.into());
    let (line_bytes, sets, ways, hit_latency, lookups_per_cycle) = (32, 4, 1, 2, 1);
    PlanCache { name, port, line_bytes, sets, ways, hit_latency, lookups_per_cycle, at_once: true, always_hits: false }
}

pub fn machine(plan: &Plan) -> PlanMachine {
    PlanMachine::new(plan).unwrap()
}

/// Runs a plan in all five ways, which must agree: both engines, the timed engine without a probe, resimulation, and execution
/// separate from timing. Returns the report and the activity of every unit.
pub fn run_both(plan: &Plan, max_cycles: u64) -> (RunReport, Recorder) {
    let [timed, ticked] = [Engine::Timed, Engine::Ticked].map(|engine| {
        let mut intervals = Recorder::default();
        let limits = RunLimits { max_cycles, progress: &mut |_: &mut PlanMachine| true };
        (run_with(&mut machine(plan), engine, Some(&mut intervals), limits), intervals)
    });
    assert_eq!(timed, ticked, "timed, left, and ticked, right, of\n{}", serde_json::to_string(plan).unwrap());
    let limits = RunLimits { max_cycles, progress: &mut |_: &mut PlanMachine| true };
    let bare = run_with(&mut machine(plan), Engine::Timed, None, limits);
    assert_eq!(timed.0, bare, "with a probe, left, and without one, right, of\n{}", serde_json::to_string(plan).unwrap());
    let again = resimulate_plan(&record_plan(plan, max_cycles), plan, max_cycles);
    assert_eq!(timed, again, "timed, left, and from its recording, right, of\n{}", serde_json::to_string(plan).unwrap());
    if max_cycles == u64::MAX {
        let (separate, chunks) = run_and_record(|| machine(plan));
        assert_eq!(
            timed.0,
            separate,
            "timed, left, and work separate from time, right, of\n{}",
            serde_json::to_string(plan).unwrap()
        );
        assert_eq!(
            streams(&record_plan(plan, max_cycles)),
            streams(&chunks),
            "recordings of\n{}",
            serde_json::to_string(plan).unwrap()
        );
    }
    timed
}

/// Executes all steps first and computes the timing afterwards. Returns the report and the recording.
pub fn run_and_record<M: Machine>(mut machine: impl FnMut() -> M) -> (RunReport, Vec<RecordingChunk>) {
    let mut batches = Vec::new();
    make_steps(&mut machine(), &mut |_| true, 40, &mut |batch| batches.push(batch)).unwrap();
    let (mut batches, mut chunks) = (batches.into_iter(), Vec::new());
    let shape = Netlist::of(&mut machine()).unwrap();
    (time_steps(shape, &mut || batches.next(), Some((64, &mut |chunk| chunks.push(chunk)))), chunks)
}

/// Concatenates the chunks of each stage's stream.
pub fn streams(recording: &[RecordingChunk]) -> Vec<Vec<u8>> {
    let stages = recording[0].streams().count();
    let whole = |stage| recording.iter().flat_map(|chunk| chunk.streams().nth(stage).unwrap().iter().copied()).collect();
    (0..stages).map(whole).collect()
}

/// Returns the fault of a run. It must be the same with both engines and with execution separate from timing.
pub fn fault<M: Machine>(machine: impl Fn() -> M) -> String {
    let [timed, ticked] = [Engine::Timed, Engine::Ticked].map(|engine| run(&mut machine(), engine).outcome);
    assert_eq!(timed, ticked);
    let Outcome::Fault(text) = timed else { panic!("{timed:?}") };
    assert_eq!(run_and_record(machine).0.outcome, Outcome::Fault(text.clone()));
    text
}

/// Returns the recording of a run.
pub fn record_plan(plan: &Plan, max_cycles: u64) -> Vec<RecordingChunk> {
    let mut chunks = Vec::new();
    let limits = RunLimits { max_cycles, progress: &mut |_: &mut PlanMachine| true };
    run_recorded(&mut machine(plan), Engine::Timed, None, limits, 64, &mut |chunk| chunks.push(chunk));
    chunks
}

/// Resimulates a recording on a machine by `plan`. Returns the report and the activity of every unit.
pub fn resimulate_plan(recording: &[RecordingChunk], plan: &Plan, max_cycles: u64) -> (RunReport, Recorder) {
    let mut intervals = Recorder::default();
    let mut chunks = recording.iter().map(Cow::Borrowed);
    let shape = Netlist::of(&mut machine(plan)).unwrap();
    let report = resimulate_with(shape, &mut |_| Ok(chunks.next()), &mut intervals, max_cycles);
    (report.unwrap_or_else(|error| panic!("{error}: {}", serde_json::to_string(plan).unwrap())), intervals)
}

/// Returns the report, which must be the same with both engines.
pub fn report(plan: &Plan) -> RunReport {
    run_both(plan, u64::MAX).0
}

/// Returns the report of one unit.
pub fn unit<'r>(report: &'r RunReport, name: &str) -> &'r UnitReport {
    report.units.iter().find(|u| u.name == name).unwrap()
}

/// Returns a unit's cycle breakdown as text: `busy 3, done 1, starved a 2`.
pub fn account(report: &RunReport, name: &str) -> String {
    let u = unit(report, name);
    let mut parts = vec![format!("busy {}", u.account.busy), format!("done {}", u.account.done)];
    let mut list = |word: &str, names: &[String], cycles: &[u64]| {
        let charged = names.iter().zip(cycles).filter(|&(_, &n)| n > 0);
        parts.extend(charged.map(|(name, n)| format!("{word} {name} {n}")));
    };
    list("starved", &u.inputs, &u.account.starved);
    list("memory", &u.clients, &u.account.memory);
    list("blocked", &u.outputs, &u.account.blocked);
    parts.retain(|part| part != "done 0");
    parts.join(", ")
}

/// Returns the histogram of one FIFO.
pub fn histogram(report: &RunReport, name: &str) -> Vec<u64> {
    report.fifos.iter().find(|f| f.name == name).unwrap().histogram.clone()
}

/// Start of every step, by stage.
#[derive(Default)]
struct StepStarts(Vec<Vec<u64>>);

impl Probe for StepStarts {
    fn on_busy(&mut self, stage: usize, from: Cycle, _: Cycle) {
        self.0.resize(self.0.len().max(stage + 1), Vec::new());
        self.0[stage].push(from.0);
    }
    fn on_stall(&mut self, _: usize, _: StallCause, _: Cycle, _: Cycle) {}
}

/// Returns the start cycles of one unit's steps, which must be the same with both engines.
pub fn starts(plan: &Plan, name: &str) -> Vec<u64> {
    let stage = plan.units.iter().position(|u| u.name == name).unwrap();
    let [timed, ticked] = [Engine::Timed, Engine::Ticked].map(|engine| {
        let mut starts = StepStarts::default();
        let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_: &mut PlanMachine| true };
        run_with(&mut machine(plan), engine, Some(&mut starts), limits);
        starts.0.get(stage).cloned().unwrap_or_default()
    });
    assert_eq!(timed, ticked);
    timed
}

/// Returns the tokens consumed by each sink, in a timed run and in the functional model.
pub fn sink_tokens(plan: &Plan) -> [Vec<(String, Vec<Token>)>; 2] {
    let list = |m: &PlanMachine| m.sink_tokens().map(|(name, tokens)| (name.to_owned(), tokens.to_vec())).collect();
    let (mut timed, mut functional) = (machine(plan), machine(plan));
    run(&mut timed, Engine::Timed);
    run_functional(&mut functional, &mut |_| true).unwrap();
    [list(&timed), list(&functional)]
}
