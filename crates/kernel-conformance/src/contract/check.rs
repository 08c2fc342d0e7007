//! The unit contract.

use super::subject::AfterStep;
use super::{Bench, ClientKind, Emitted, Popped, TestEnvironment};
use basrelief_kernel::{Engine, Outcome, RunReport, Unit, run, run_functional};
use serde::{Serialize, de::DeserializeOwned};
use std::fmt::Display;
use std::rc::Rc;

/// Violation of a promise by a unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct ContractViolation {
    /// The run with the violation.
    pub place: String,
    /// The observation and the expectation.
    pub what: String,
}

type Write<U> = Rc<dyn Fn(&U) -> Result<String, String>>;
type Read<U> = Rc<dyn Fn(&mut U, &str) -> Result<(), String>>;

/// Accessors that copy a unit's state out and into another unit of the same configuration.
#[derive(Clone)]
struct StateOf<U> {
    write: Write<U>,
    read: Read<U>,
}

impl<U: 'static> StateOf<U> {
    fn new<S: Serialize + DeserializeOwned>(get: impl Fn(&U) -> S + 'static, set: impl Fn(&mut U, S) + 'static) -> Self {
        Self {
            write: Rc::new(move |unit| serde_json::to_string(&get(unit)).map_err(|e| format!("state to JSON: {e}"))),
            read: Rc::new(move |unit, json| {
                set(unit, serde_json::from_str(json).map_err(|e| format!("state from JSON: {e}"))?);
                Ok(())
            }),
        }
    }
}

/// The promises of every unit, for one configuration and one sequence of tokens. Each method checks one promise.
///
/// A unit is tested in twelve environments: FIFOs of 1, 2 and 16 slots, each at full rate, with slow sinks, with slow sources,
/// and with a slow memory behind the smallest caches and credits.
#[derive(Clone)]
pub struct Contract<U: Unit<In: Popped>> {
    fresh: U,
    tokens: <U::In as Popped>::Tokens,
    clients: Vec<ClientKind>,
    state: StateOf<U>,
}

/// Returns the twelve environments of the test.
fn environments() -> Vec<TestEnvironment> {
    let mut all = Vec::new();
    for depth in [1, 2, 16] {
        let plain = TestEnvironment { depth, latency: 1, ..TestEnvironment::default() };
        all.push(plain.clone());
        all.push(TestEnvironment { latency: 3, sink_occupancy: vec![1, 1, 23, 1, 4], ..plain.clone() });
        all.push(TestEnvironment { latency: 2, source_gaps: vec![0, 31, 0, 5], ..plain.clone() });
        all.push(TestEnvironment { slow_memory: true, ..plain });
    }
    all
}

/// Returns the cheapest environment, in which nothing but the unit limits the run.
fn default_environment() -> TestEnvironment {
    TestEnvironment { depth: 16, latency: 1, ..TestEnvironment::default() }
}

impl<U: Unit<In: Popped, Out: Emitted> + Clone + 'static> Contract<U> {
    /// Makes the contract of `unit`, fresh from its constructor and fed with `tokens`. The state is plain data. `get` copies it
    /// out, and `set` copies it into another unit of the same configuration.
    pub fn new<S: Serialize + DeserializeOwned>(
        unit: U,
        tokens: <U::In as Popped>::Tokens,
        get: impl Fn(&U) -> S + 'static,
        set: impl Fn(&mut U, S) + 'static,
    ) -> Self {
        Self { fresh: unit, tokens, clients: Vec::new(), state: StateOf::new(get, set) }
    }

    /// Makes the contract of a unit without state. No step may change such a unit.
    pub fn stateless(unit: U, tokens: <U::In as Popped>::Tokens) -> Self {
        Self::new(unit, tokens, |_| (), |_, ()| ())
    }

    /// Sets the memory or cache of each memory client, in the unit's numbering.
    #[must_use]
    pub fn clients(mut self, clients: &[ClientKind]) -> Self {
        self.clients = clients.to_vec();
        self
    }

    /// Checks every promise.
    ///
    /// # Errors
    /// Returns the first violation.
    pub fn check_all(&self) -> Result<(), ContractViolation> {
        self.reset_is_idempotent()?;
        self.runs_are_deterministic()?;
        self.no_token_is_lost_or_doubled()?;
        self.back_pressure_changes_no_token()?;
        self.steps_keep_within_largest_step()?;
        self.work_after_data_is_part_of_latency()?;
        self.state_round_trips()?;
        self.accounting_sums_to_the_total()?;
        self.engines_report_the_same()?;
        self.nothing_is_left_at_the_end()
    }

    /// Checks that a used unit, reset to the state of a fresh unit, repeats the run of the fresh unit. A stateless unit must repeat
    /// it without a reset.
    ///
    /// # Errors
    /// Names the first difference.
    pub fn reset_is_idempotent(&self) -> Result<(), ContractViolation> {
        let setting = default_environment();
        let (first, used) = self.run(self.fresh.clone(), Engine::Timed, &setting)?;
        let mut again = used.unit().clone();
        let fresh = at_place("fresh unit", (self.state.write)(&self.fresh))?;
        at_place("reset", (self.state.read)(&mut again, &fresh))?;
        let (second, _) = self.run(again, Engine::Timed, &setting)?;
        at_place("run after reset", same_reports(("before", &first), ("after", &second)))
    }

    /// Checks that two equal runs give equal results: no clock, no randomness, and no state shared between clones.
    ///
    /// # Errors
    /// Names the first difference.
    pub fn runs_are_deterministic(&self) -> Result<(), ContractViolation> {
        for setting in environments() {
            let (first, _) = self.run(self.fresh.clone(), Engine::Timed, &setting)?;
            let (second, _) = self.run(self.fresh.clone(), Engine::Timed, &setting)?;
            at_place(&setting, same_reports(("first run", &first), ("second run", &second)))?;
        }
        Ok(())
    }

    /// Checks that both engines and the functional model emit the same tokens in the same order.
    ///
    /// # Errors
    /// Names the first different token and its cycle.
    pub fn no_token_is_lost_or_doubled(&self) -> Result<(), ContractViolation> {
        for engine in [Engine::Timed, Engine::Ticked] {
            self.run(self.fresh.clone(), engine, &default_environment())?;
        }
        Ok(())
    }

    /// Checks that shallow FIFOs, slow neighbours and slow memories change neither a token nor the final state.
    ///
    /// # Errors
    /// Names the first different token and its cycle.
    pub fn back_pressure_changes_no_token(&self) -> Result<(), ContractViolation> {
        let expected = self.final_state(self.functional()?.unit())?;
        for setting in environments() {
            let (_, bench) = self.run(self.fresh.clone(), Engine::Timed, &setting)?;
            if self.final_state(bench.unit())? != expected {
                return at_place(&setting, Err("the unit ends in another state than in the functional model (law 6)".into()));
            }
        }
        Ok(())
    }

    /// Checks that no step needs more credits of a client than [`Unit::largest_step`] declares, or a client that the contract
    /// does not list. The kernel checks this in every run. Here, no other check can fail.
    ///
    /// # Errors
    /// Names the client, the need and the declaration.
    pub fn steps_keep_within_largest_step(&self) -> Result<(), ContractViolation> {
        environments().iter().try_for_each(|setting| self.run_without_fault(setting))
    }

    /// Checks that no step works longer after its data than its whole latency, which includes this work.
    ///
    /// # Errors
    /// Names both numbers of cycles.
    pub fn work_after_data_is_part_of_latency(&self) -> Result<(), ContractViolation> {
        self.run_without_fault(&default_environment())
    }

    /// Runs the fresh unit. A fault is an error.
    fn run_without_fault(&self, setting: &TestEnvironment) -> Result<(), ContractViolation> {
        let mut bench = Bench::new(self.fresh.clone(), self.tokens.clone(), None, &self.clients, setting);
        match run(&mut bench, Engine::Timed).outcome {
            Outcome::Fault(text) => at_place(setting, Err(text)),
            _ => Ok(()),
        }
    }

    /// Checks that the state survives a round trip through JSON, into a fresh unit, after every step. A checkpoint is therefore a
    /// serialization and needs no other data.
    ///
    /// # Errors
    /// Names the lost state or the first different token.
    pub fn state_round_trips(&self) -> Result<(), ContractViolation> {
        let StateOf { write, read } = self.state.clone();
        let fresh = self.fresh.clone();
        let trip: AfterStep<U> = Rc::new(move |unit: &mut U| {
            let before = write(unit)?;
            *unit = fresh.clone();
            read(unit, &before)?;
            let after = write(unit)?;
            if after == before { Ok(()) } else { Err(format!("the state was {before}, and is {after} after a round trip")) }
        });
        let setting = TestEnvironment { depth: 2, ..default_environment() };
        let expected = self.functional()?.tokens();
        let mut bench =
            Bench::with_hook(self.fresh.clone(), Some(trip), self.tokens.clone(), Some(expected), &self.clients, &setting);
        at_place("state through JSON after every step", completed(&run(&mut bench, Engine::Timed)))
    }

    /// Checks that the cycles of every unit (law 9) and of every FIFO's histogram (law 10) sum to the total.
    ///
    /// # Errors
    /// Names the unit or FIFO and both sums.
    pub fn accounting_sums_to_the_total(&self) -> Result<(), ContractViolation> {
        for setting in environments() {
            let (report, _) = self.run(self.fresh.clone(), Engine::Timed, &setting)?;
            let units = report.units.iter().map(|u| (&u.name, u.account.total()));
            let fifos = report.fifos.iter().map(|f| (&f.name, f.histogram.iter().sum()));
            if let Some((name, sum)) = units.chain(fifos).find(|&(_, sum)| sum != report.total) {
                return at_place(&setting, Err(format!("the cycles of {name} sum to {sum}, expected {}", report.total)));
            }
        }
        Ok(())
    }

    /// Checks that `timed` and `ticked` give equal reports.
    ///
    /// # Errors
    /// Names the first difference.
    pub fn engines_report_the_same(&self) -> Result<(), ContractViolation> {
        for setting in environments() {
            let (timed, _) = self.run(self.fresh.clone(), Engine::Timed, &setting)?;
            let (ticked, _) = self.run(self.fresh.clone(), Engine::Ticked, &setting)?;
            at_place(&setting, same_reports(("timed", &timed), ("ticked", &ticked)))?;
        }
        Ok(())
    }

    /// Checks that the unit works, pops every token, and holds none back at the end.
    ///
    /// # Errors
    /// Names the tokens that are left.
    pub fn nothing_is_left_at_the_end(&self) -> Result<(), ContractViolation> {
        for setting in environments() {
            let mut bench = Bench::new(self.fresh.clone(), self.tokens.clone(), None, &self.clients, &setting);
            let report = run(&mut bench, Engine::Timed);
            at_place(&setting, completed(&report))?;
            if !report.units.iter().any(|u| u.name == "unit" && u.steps > 0) {
                return at_place(&setting, Err("the unit made no step: the contract needs at least one token".into()));
            }
        }
        Ok(())
    }

    /// Runs the fresh unit in the functional model.
    fn functional(&self) -> Result<Bench<U>, ContractViolation> {
        let mut bench = Bench::new(self.fresh.clone(), self.tokens.clone(), None, &self.clients, &default_environment());
        at_place("functional model", run_functional(&mut bench, &mut |_| true))?;
        Ok(bench)
    }

    /// Runs the unit to completion, with sinks that expect the tokens of the functional model.
    fn run(&self, unit: U, engine: Engine, setting: &TestEnvironment) -> Result<(RunReport, Bench<U>), ContractViolation> {
        let expected = self.functional()?.tokens();
        let mut bench = Bench::new(unit, self.tokens.clone(), Some(expected), &self.clients, setting);
        let report = run(&mut bench, engine);
        at_place(format_args!("{engine:?}, {setting}"), completed(&report))?;
        Ok((report, bench))
    }

    /// Returns the unit's final state as JSON. The result is empty if the contract has no state.
    fn final_state(&self, unit: &U) -> Result<String, ContractViolation> {
        at_place("final state", (self.state.write)(unit))
    }
}

/// Adds the place to an error.
fn at_place<T>(place: impl Display, result: Result<T, String>) -> Result<T, ContractViolation> {
    result.map_err(|what| ContractViolation { place: place.to_string(), what })
}

fn completed(report: &RunReport) -> Result<(), String> {
    match &report.outcome {
        Outcome::Complete => Ok(()),
        Outcome::Deadlock(deadlock) => Err(deadlock.to_string()),
        Outcome::Fault(text) => Err(text.clone()),
        other @ (Outcome::Limit | Outcome::Stopped) => Err(format!("the run ended with {other:?}, expected Complete")),
    }
}

/// Returns the first difference of two reports as an error.
fn same_reports((a_name, a): (&str, &RunReport), (b_name, b): (&str, &RunReport)) -> Result<(), String> {
    fn first<T: PartialEq + std::fmt::Debug>(a: &[T], b: &[T]) -> Option<(String, String)> {
        a.iter().zip(b).find(|(a, b)| a != b).map(|(a, b)| (format!("{a:?}"), format!("{b:?}")))
    }
    if a == b {
        return Ok(());
    }
    let (of_a, of_b) = first(&a.units, &b.units)
        .or_else(|| first(&a.fifos, &b.fifos))
        .or_else(|| first(&a.memories, &b.memories))
        .or_else(|| first(&a.caches, &b.caches))
        .unwrap_or_else(|| (format!("{:?}", (a.total, &a.marks)), format!("{:?}", (b.total, &b.marks))));
    Err(format!("{a_name}: {of_a}; {b_name}: {of_b}"))
}
