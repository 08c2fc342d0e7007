//! The machine and the run that the tests of this crate draw.

use crate::TimelineLayout;
use basrelief_kernel::{Engine, Netlist, RunReport};
use basrelief_kernel_conformance::plan::{Plan, PlanMachine};

/// Source, unit with a memory client, sink.
pub fn plan() -> Plan {
    serde_json::from_str(include_str!("../tests/plan.json")).unwrap()
}

pub fn run() -> RunReport {
    basrelief_kernel::run(&mut PlanMachine::new(&plan()).unwrap(), Engine::Timed)
}

/// The machine of [`plan`], as a time line shows it.
pub fn board() -> TimelineLayout {
    TimelineLayout::new("plan", 0, Netlist::of(&mut PlanMachine::new(&plan()).unwrap()).unwrap().diagram())
}
