//! A unit under watch: every step is held against what the unit declared before it.

use super::ClientKind;
use crate::traffic::Request;
use crate::{Demand, Step, Traffic, Unit};
use std::rc::Rc;

/// What is done to the unit after each step; an error is a fault.
pub(super) type AfterStep<U> = Rc<dyn Fn(&mut U) -> Result<(), String>>;

/// Passes everything on to the unit, and raises a fault where a step exceeds [`Unit::largest_step`].
#[derive(Clone)]
pub(super) struct Guard<U> {
    pub(super) unit: U,
    clients: Vec<ClientKind>,
    after_step: Option<AfterStep<U>>,
}

impl<U: Unit> Guard<U> {
    pub(super) fn new(unit: U, clients: &[ClientKind]) -> Self {
        Self { unit, clients: clients.to_vec(), after_step: None }
    }

    pub(super) fn after_step(mut self, hook: AfterStep<U>) -> Self {
        self.after_step = Some(hook);
        self
    }

    pub(super) fn clients(&self) -> &[ClientKind] {
        &self.clients
    }

    /// What the step's traffic has against it, if anything.
    fn objection(&self, largest: &[u32], traffic: &Traffic) -> Option<String> {
        let all = || traffic.requests.iter().chain(&traffic.look_ups);
        if let Some(r) = all().find(|r| r.client as usize >= self.clients.len()) {
            return Some(format!("a step uses client {}, but the contract gives it {}", r.client, self.clients.len()));
        }
        (0_u32..).zip(&self.clients).zip(largest).find_map(|((n, client), &largest)| {
            let mine = |r: &&Request| r.client == n;
            let mut needs = traffic.requests.iter().filter(mine).count();
            let look_ups: Vec<_> = traffic.look_ups.iter().filter(mine).collect();
            match client {
                ClientKind::Port if !look_ups.is_empty() => {
                    return Some(format!("a step looks up a line in client {n}, which has no cache"));
                }
                ClientKind::Port => {}
                ClientKind::Cache { line_bytes } => needs += distinct_lines(&look_ups, u64::from((*line_bytes).max(1))),
            }
            let exceeded = needs > largest as usize;
            exceeded.then(|| format!("a step needs {needs} credits of client {n}, largest_step({n}) declared {largest}"))
        })
    }
}

/// Lines that the look-ups touch, each counted once (law 5).
fn distinct_lines(look_ups: &[&Request], line_bytes: u64) -> usize {
    let lines_of = |r: &&Request| r.address / line_bytes..=(r.address + u64::from(r.bytes.max(1)) - 1) / line_bytes;
    let mut lines: Vec<u64> = look_ups.iter().flat_map(lines_of).collect();
    lines.sort_unstable();
    lines.dedup();
    lines.len()
}

impl<U: Unit> Unit for Guard<U> {
    type In = U::In;
    type Out = U::Out;

    fn demand(&self) -> Demand {
        self.unit.demand()
    }

    fn step(&mut self, input: U::In, traffic: &mut Traffic) -> Step<U::Out> {
        let largest: Vec<u32> = (0..self.clients.len()).map(|n| self.unit.largest_step(n)).collect();
        let step = self.unit.step(input, traffic);
        if let Some(text) = self.objection(&largest, traffic) {
            // What the wiring has no place for cannot be issued.
            traffic.clear();
            traffic.fault(text);
        }
        if let Some(Err(text)) = self.after_step.clone().map(|hook| hook(&mut self.unit)) {
            traffic.fault(text);
        }
        step
    }

    fn largest_step(&self, client: usize) -> u32 {
        if client < self.clients.len() { self.unit.largest_step(client) } else { 0 }
    }

    fn is_empty(&self) -> bool {
        self.unit.is_empty()
    }
}
