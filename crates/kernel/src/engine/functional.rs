//! The functional model: the same steps, without time; memories answer at once (law 6). Where a tape is kept of it, somebody else
//! can tell the time meanwhile.

use super::rests;
use super::work::{Live, Work};
use crate::place::Place;
use crate::tape::{End, Reel, Writer};
use crate::time::{Made, Rest};
use crate::wiring::{Inputs, Machine, Outputs, Visitor};
use crate::{Connections, Demand, Traffic, Unit};

struct Walk<'a> {
    traffic: Traffic,
    stage: usize,
    stepped: bool,
    /// Stages that cannot go on, and how many of them stand in a reel.
    faults: Vec<Fault>,
    told: usize,
    tape: Option<&'a mut Writer>,
}

/// A stage that cannot go on.
struct Fault {
    stage: usize,
    name: String,
    text: String,
}

impl<'a> Walk<'a> {
    fn new(traffic: Traffic, tape: Option<&'a mut Writer>) -> Self {
        Self { traffic, stage: 0, stepped: false, faults: vec![], told: 0, tape }
    }

    /// Whether a stage is to go on. Who times a tape must come to the start of a step that is a fault: so all others go on
    /// meanwhile, as far as they can without it.
    fn goes_on(&self, stage: usize) -> bool {
        self.faults.is_empty() || (self.tape.is_some() && self.faults.iter().all(|fault| fault.stage != stage))
    }

    /// After a step of a stage.
    #[inline(always)]
    fn take(&mut self, (stage, name): (usize, &str), demand: Demand, made: Made) {
        self.stepped = true;
        if let Some(text) = self.traffic.fault.take() {
            self.faults.push(Fault { stage, name: name.into(), text });
        }
        if let Some(tape) = &mut self.tape {
            // It may be the step itself that is wrong.
            let made = Made { occupancy: made.occupancy.max(1), ..made };
            tape.work(stage, demand, &made, &self.traffic);
            self.traffic.clear();
        }
    }

    /// What is on the tape since the last reel.
    fn reel(&mut self, rests: Vec<Rest>, end: End) -> Option<Reel> {
        let mut reel = self.tape.as_mut()?.reel(rests, end);
        reel.faults = self.faults[self.told..].iter().map(|fault| (fault.stage, fault.text.clone())).collect();
        self.told = self.faults.len();
        Some(reel)
    }
}

/// What the next step of a stage takes, if it can be made now.
#[inline(always)]
fn next<U: Unit, I: Inputs, O: Outputs, C>(
    unit: &U,
    Connections { inputs, outputs, .. }: &Connections<I, O, C>,
) -> Option<Demand> {
    let demand = unit.demand();
    let ready = demand != Demand::Finished
        && (0..inputs.count()).all(|i| !demand.takes(i) || !inputs.link(i).is_empty())
        && (0..outputs.count()).all(|i| outputs.link(i).has_room());
    ready.then_some(demand)
}

impl Visitor for Walk<'_> {
    #[inline]
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let number = self.stage;
        self.stage += 1;
        while self.goes_on(number)
            && let Some(demand) = next(&stage.unit, connections)
        {
            let made = Live::new(&mut *stage, &mut *connections).step(demand, &mut self.traffic);
            self.take((number, stage.name()), demand, made);
        }
    }
}

pub(super) fn run<M: Machine>(machine: &mut M, progress: &mut dyn FnMut(&mut M) -> bool) -> Result<(), String> {
    let mut walk = Walk::new(Traffic::muted(), None);
    let end = walk_on(machine, &mut walk, progress, &mut |_| ());
    match (walk.faults.pop(), end) {
        (Some(Fault { name, text, .. }), _) => Err(format!("{name}: {text}")),
        (None, End::Stopped) => Err("stopped".into()),
        (None, _) => Ok(()),
    }
}

pub(super) fn run_to_tape<M: Machine>(
    machine: &mut M,
    writer: &mut Writer,
    progress: &mut dyn FnMut(&mut M) -> bool,
    keep: &mut dyn FnMut(Reel),
) {
    let mut walk = Walk::new(Traffic::default(), Some(writer));
    let end = walk_on(machine, &mut walk, progress, keep);
    walk.reel(rests(machine), end).into_iter().for_each(keep);
}

/// Makes all steps, and hands on the reels that are full meanwhile.
fn walk_on<M: Machine>(
    machine: &mut M,
    walk: &mut Walk<'_>,
    progress: &mut dyn FnMut(&mut M) -> bool,
    keep: &mut dyn FnMut(Reel),
) -> End {
    for round in 1_u64.. {
        (walk.stage, walk.stepped) = (0, false);
        machine.wire(walk);
        if !walk.stepped || (walk.tape.is_none() && !walk.faults.is_empty()) {
            break;
        }
        if walk.tape.as_ref().is_some_and(|tape| tape.is_full()) {
            walk.reel(rests(machine), End::Open).into_iter().for_each(&mut *keep);
        }
        if (round.is_multiple_of(16) || machine.has_news()) && !progress(machine) {
            return End::Stopped;
        }
    }
    End::Last
}
