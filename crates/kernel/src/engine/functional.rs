//! The functional model: the same steps, without time; memories answer at once (law 6).

use super::fault_of;
use crate::place::Place;
use crate::wiring::{Inputs, Machine, Outputs, Visitor, Wires};
use crate::{Connections, Demand, Traffic, Unit};

struct Walk {
    traffic: Traffic,
    stepped: bool,
    fault: Option<String>,
}

impl Visitor for Walk {
    #[inline]
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, Connections { inputs, outputs, .. }) = place.open();
        while self.fault.is_none() {
            let demand = stage.unit.demand();
            let ready = demand != Demand::Finished
                && (0..inputs.count()).all(|i| !demand.takes(i) || !inputs.link(i).is_empty())
                && (0..outputs.count()).all(|i| outputs.link(i).has_room());
            if !ready {
                return;
            }
            let step = stage.unit.step(inputs.pop(demand), &mut self.traffic);
            outputs.push(step.out);
            self.stepped = true;
            if self.traffic.fault.is_some() {
                self.fault = fault_of(&mut self.traffic, stage.name(), None);
            }
        }
    }
}

pub(super) fn run<M: Machine>(machine: &mut M, progress: &mut dyn FnMut(&mut M) -> bool) -> Result<(), String> {
    let mut walk = Walk { traffic: Traffic::muted(), stepped: true, fault: None };
    for round in 1_u64.. {
        walk.stepped = false;
        machine.wire(&mut walk);
        if let Some(fault) = walk.fault {
            return Err(fault);
        }
        if !walk.stepped {
            break;
        }
        if (round.is_multiple_of(16) || machine.has_news()) && !progress(machine) {
            return Err("stopped".into());
        }
    }
    Ok(())
}
