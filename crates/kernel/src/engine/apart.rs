//! A run in two halves, which may be on two threads: one makes the steps, the other tells their times. What a step does depends on no
//! time (law 6), so the first waits for nothing that the second finds.

use super::Recording;
use super::ends::advance;
use super::functional::run_to;
use super::timed::RunAhead;
use super::work::Work;
use crate::check::WiringError;
use crate::report::RunReport;
use crate::shape::Shape;
use crate::tape::{Reel, Writer};
use crate::time::{Halt, Made, Rest, Takes, Time};
use crate::wiring::Machine;
use crate::{Demand, NoProbe, Request, Traffic};

/// A step as it was made, and how much it asked.
#[derive(Clone, Copy, Debug)]
struct Step {
    demand: Demand,
    made: Made,
    requests: u32,
    look_ups: u32,
}

/// Steps of one stage, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    steps: Vec<Step>,
    /// What they asked, one after the other: requests, then look-ups.
    asked: Vec<Request>,
    /// Why the last of them is a fault, if it is.
    fault: Option<String>,
}

impl Steps {
    /// Takes a step in, with what it asked; its fault goes with it.
    #[inline(always)]
    pub(super) fn push(&mut self, demand: Demand, made: Made, traffic: &mut Traffic) {
        let (requests, look_ups) = (traffic.requests(), traffic.look_ups());
        self.steps.push(Step { demand, made, requests: requests.len() as u32, look_ups: look_ups.len() as u32 });
        if !traffic.is_empty() {
            self.asked.extend_from_slice(requests);
            self.asked.extend_from_slice(look_ups);
            traffic.clear();
        }
        if traffic.fault.is_some() {
            self.fault = traffic.fault.take();
        }
    }

    /// What was taken in since the last call. Whether there was a fault stays known.
    pub(super) fn take(&mut self) -> Self {
        let room = (Vec::with_capacity(self.steps.len()), Vec::with_capacity(self.asked.len()));
        let steps = std::mem::replace(&mut self.steps, room.0);
        let asked = std::mem::replace(&mut self.asked, room.1);
        Self { steps, asked, fault: self.fault.clone() }
    }

    /// Whether its stage cannot go on.
    #[inline(always)]
    pub(super) fn is_fault(&self) -> bool {
        self.fault.is_some()
    }
}

/// Some steps of every stage, as they were [made](make_steps), in the order of the wiring; for who [tells](time_steps) their times.
#[derive(Clone, Debug)]
pub struct Piece {
    pub(super) stages: Vec<Steps>,
    /// What each stage's next step takes.
    pub(super) rests: Vec<Rest>,
    /// Whether there is more to be done, and nobody does it.
    pub(super) stopped: bool,
}

impl Piece {
    /// How many steps it holds, of all stages.
    pub fn steps(&self) -> usize {
        self.stages.iter().map(|stage| stage.steps.len()).sum()
    }
}

/// Makes all steps of a machine, and hands them on, some `steps` at a time. They run ahead of their times: so this is for runs without a
/// limit of cycles. `progress` as in [`Limits`](super::Limits).
///
/// # Errors
/// If the wiring is wrong.
pub fn make_steps<M: Machine>(
    machine: &mut M,
    progress: &mut dyn FnMut(&mut M) -> bool,
    (steps, hand_on): (usize, &mut dyn FnMut(Piece)),
) -> Result<(), WiringError> {
    let stages = Shape::of(machine)?.stages.len();
    run_to(machine, progress, (steps, vec![Steps::default(); stages], hand_on));
    Ok(())
}

/// Tells the times of the steps of a machine of this shape, as they come: the report that [`run_with`](super::run_with) gives with the
/// timed engine. `keep`: who is given its [tape](crate::tape), in reels of so many bytes and somewhat more.
pub fn time_steps(
    shape: Shape,
    pieces: &mut dyn FnMut() -> Option<Piece>,
    keep: Option<(usize, &mut dyn FnMut(Reel))>,
) -> RunReport {
    let mut time = Time::new(shape);
    let inputs = time.shape.stages.iter().map(|stage| stage.inputs.len());
    let mut queues: Vec<Queue> = inputs.map(Queue::new).collect();
    let mut recording = keep.map(|(bytes, keep)| (Writer::new(&time.shape, &time.memories, bytes), keep));
    let tape = recording.as_mut().map(|(writer, keep)| Recording { writer, keep: &mut **keep });
    let halt = tell(&mut time, &mut queues, pieces, tape);
    time.land_all();
    let rests = rests_of(&queues);
    if let (Some((mut writer, keep)), Halt::Quiet) = (recording, &halt) {
        keep(writer.reel(rests.clone(), true));
    }
    time.conclude(&rests, halt)
}

fn tell(time: &mut Time, queues: &mut [Queue], pieces: &mut dyn FnMut() -> Option<Piece>, tape: Option<Recording<'_>>) -> Halt {
    let mut stopped = feed(queues, pieces).unwrap_or(true);
    let (writer, mut keep) = tape.map(|Recording { writer, keep }| (writer, keep)).unzip();
    let mut probe = NoProbe;
    let mut walk = RunAhead::new(time, &mut probe, u64::MAX, writer);
    loop {
        walk.begin();
        for (number, queue) in queues.iter_mut().enumerate() {
            advance(&mut walk, number, queue);
        }
        if let Some(fault) = walk.fault.take() {
            return Halt::Fault(fault);
        }
        if let (Some(writer), Some(keep)) = (&mut walk.tape, &mut keep)
            && writer.is_full()
        {
            keep(writer.reel(rests_of(queues), false));
        }
        if walk.goes_on() {
            continue;
        }
        if !walk.hungry {
            return if stopped { Halt::Stopped } else { Halt::Quiet };
        }
        let Some(stops) = feed(queues, pieces) else { return Halt::Stopped };
        stopped = stops;
    }
}

/// Goes on with the next piece, if there is one; whether the work was stopped behind it.
fn feed(queues: &mut [Queue], pieces: &mut dyn FnMut() -> Option<Piece>) -> Option<bool> {
    let Piece { stages, rests, stopped } = pieces()?;
    for (queue, (steps, rest)) in queues.iter_mut().zip(stages.into_iter().zip(rests)) {
        queue.feed(steps, rest);
    }
    Some(stopped)
}

fn rests_of(queues: &[Queue]) -> Vec<Rest> {
    queues.iter().map(Queue::rest).collect()
}

/// Steps of a stage that wait for their times.
struct Queue {
    waiting: Steps,
    /// How many of them are made, and how much of what they asked is.
    next: usize,
    asked: usize,
    /// What the step behind them takes.
    rest: Rest,
    inputs: usize,
}

impl Queue {
    fn new(inputs: usize) -> Self {
        Self { waiting: Steps::default(), next: 0, asked: 0, rest: Rest { demand: Demand::Finished, empty: true }, inputs }
    }

    fn feed(&mut self, mut steps: Steps, rest: Rest) {
        let waiting = &mut self.waiting;
        if self.next < waiting.steps.len() {
            waiting.steps.drain(..self.next);
            waiting.asked.drain(..self.asked);
            waiting.steps.append(&mut steps.steps);
            waiting.asked.append(&mut steps.asked);
            waiting.fault = waiting.fault.take().or(steps.fault);
        } else {
            *waiting = steps;
        }
        (self.next, self.asked, self.rest) = (0, 0, rest);
    }

    #[inline(always)]
    fn demand(&self) -> Demand {
        self.waiting.steps.get(self.next).map_or(self.rest.demand, |step| step.demand)
    }

    fn rest(&self) -> Rest {
        Rest { demand: self.demand(), empty: self.rest.empty && !self.has_step() }
    }
}

impl Work for Queue {
    type Declared = Demand;

    #[inline(always)]
    fn next(&self) -> (Demand, Takes) {
        let demand = self.demand();
        (demand, Takes::of(demand, self.inputs))
    }

    #[inline(always)]
    fn has_step(&self) -> bool {
        self.next < self.waiting.steps.len()
    }

    #[inline(always)]
    fn step(&mut self, _: Demand, traffic: &mut Traffic) -> Made {
        let Steps { steps, asked, fault } = &mut self.waiting;
        let Step { made, requests, look_ups, .. } = steps[self.next];
        if requests + look_ups > 0 {
            let (requests, rest) = asked[self.asked..].split_at(requests as usize);
            traffic.ask(requests, &rest[..look_ups as usize]);
            self.asked += requests.len() + look_ups as usize;
        }
        self.next += 1;
        if self.next == steps.len()
            && let Some(fault) = fault.take()
        {
            traffic.fault(fault);
        }
        made
    }

    #[inline(always)]
    fn write(&self, tape: &mut Writer, number: usize, (demand, made): (Demand, &Made), traffic: &Traffic) {
        tape.step(number, demand, made, traffic);
    }
}
