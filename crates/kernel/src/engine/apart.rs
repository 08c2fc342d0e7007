//! A run in two halves, which may be on two threads: one makes the steps, the other tells their times. What a step does depends on no
//! time (law 6), so the first waits for nothing that the second finds.

use super::batch::{Piece, Step, Steps};
use super::context::Recording;
use super::ends::advance;
use super::functional::run_to;
use super::timed::RunAhead;
use super::work::Work;
use crate::check::WiringError;
use crate::machine::Machine;
use crate::report::RunReport;
use crate::shape::Shape;
use crate::tape::{Reel, Writer};
use crate::time::{Halt, Made, Rest, Takes, Time};
use crate::{Demand, NoProbe, Traffic};

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
