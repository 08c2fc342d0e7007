//! The eleven laws of time, tested with 584 vectors of an executable reading of the laws. It shares no code with the kernel.

use basrelief_kernel::{Engine, run};
use basrelief_kernel_conformance::plan::{Plan, PlanMachine, result};
use serde_json::Value;

/// Runs each vector with both engines. `at_once`: true if caches make all look-ups of a step at its start, which the second edition
/// of the laws does not state.
fn check(vectors: &str, count: usize, at_once: bool) {
    assert_eq!(vectors.lines().count(), count);
    for line in vectors.lines() {
        let vector: Value = serde_json::from_str(line).unwrap();
        let mut plan: Plan = serde_json::from_value(vector["plan"].clone()).unwrap();
        plan.caches.iter_mut().for_each(|cache| cache.at_once |= at_once);
        for engine in [Engine::Timed, Engine::Ticked] {
            let mut machine = PlanMachine::new(&plan).unwrap();
            assert_eq!(result(&run(&mut machine, engine)), vector["result"], "seed {}, {engine:?}", vector["seed"]);
        }
    }
}

// Claim: laws, all: Both engines agree with an independent implementation of the laws.
#[test]
fn both_engines_match_law_vectors() {
    check(include_str!("../vectors/laws.jsonl"), 320, true);
}

#[test]
fn both_engines_match_vectors_of_third_edition() {
    check(include_str!("../vectors/third_edition.jsonl"), 160, false);
}

#[test]
fn both_engines_match_vectors_of_command_buses() {
    check(include_str!("../vectors/command_bus.jsonl"), 40, false);
}

#[test]
fn both_engines_match_vectors_of_flips() {
    check(include_str!("../vectors/flips.jsonl"), 24, false);
}

/// Waits for the display, steps with and without requests, feedback, relaxed units and relaxed caches. Two of these plans fail if
/// a stage promises before it delivers.
#[test]
fn both_engines_match_vectors_of_machine_rules() {
    check(include_str!("../vectors/machine_rules.jsonl"), 40, false);
}
