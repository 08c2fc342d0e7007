//! The eleven laws of time, tested with 320 vectors of an executable reading of the laws. It shares no code with the kernel.

use basrelief_kernel::{Engine, run};
use basrelief_kernel_conformance::plan::{Plan, PlanMachine, result};
use serde_json::Value;

// Claim: laws, all: Both engines agree with an independent implementation of the laws.
#[test]
fn both_engines_match_law_vectors() {
    let vectors = include_str!("vectors/laws.jsonl");
    assert_eq!(vectors.lines().count(), 320);
    for line in vectors.lines() {
        let vector: Value = serde_json::from_str(line).unwrap();
        let plan: Plan = serde_json::from_value(vector["plan"].clone()).unwrap();
        for engine in [Engine::Timed, Engine::Ticked] {
            let mut machine = PlanMachine::new(&plan).unwrap();
            assert_eq!(result(&run(&mut machine, engine)), vector["result"], "seed {}, {engine:?}", vector["seed"]);
        }
    }
}
