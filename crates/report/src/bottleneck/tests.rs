use super::*;
use crate::samples::{self, with_units};

fn check(report: &Report, limit: Limit, sentence: &str) {
    let blame = blame(report);
    assert_eq!(blame.sentence, sentence);
    assert_eq!(blame.limit, limit);
}

#[test]
fn a_saturated_unit_is_the_bottleneck() {
    check(
        &samples::balanced(),
        Limit::Unit("replacement".into()),
        "replacement (110) limits this run: busy 98 % of the cycles; normal-mapping is blocked by it 61 % of the time.",
    );
}

#[test]
fn a_source_that_gives_too_little_is_the_bottleneck() {
    check(
        &samples::source_bound(),
        Limit::Unit("host".into()),
        "host limits this run: busy 100 % of the cycles; rasterizer is starved by it 73 % of the time.",
    );
}

#[test]
fn waits_lead_to_the_memory_that_causes_them() {
    let mut report = samples::memory_bound();
    let latency = "memory graphics limits this run: depth-test waits for its port z 54 % of the cycles; its data bus is \
                   busy only 24 %: latency, not bandwidth.";
    check(&report, Limit::Memory("z".into()), latency);
    report.derived["graphics.bus_utilisation"].value = 0.92;
    let bandwidth = "memory graphics limits this run: depth-test waits for its port z 54 % of the cycles; its data bus is \
                     busy 92 %: bandwidth.";
    check(&report, Limit::Memory("z".into()), bandwidth);
}

#[test]
fn a_deadlock_is_told_as_the_kernel_tells_it() {
    check(
        &samples::deadlocked(),
        Limit::Ended,
        "Deadlock after 1000000 cycles: `fork` waits for a slot in `left` (4 of 4 slots); `join` waits for a token from \
         `right` (0 of 4 slots)",
    );
}

#[test]
fn units_that_wait_for_each_other_point_at_the_fifo_between_them() {
    check(
        &with_units(&[
            ("a", &[("busy", 400_000), (">f", 600_000)]),
            ("b", &[("busy", 300_000), ("<f", 650_000), ("done", 50_000)]),
        ]),
        Limit::Circle(vec!["f".into()]),
        "a circle of waits limits this run: a for a slot in f 60 %, b for a token from f 65 % of the cycles; no unit is \
         slow by itself, more slots may help (fifo.f.depth = 4).",
    );
}

#[test]
fn no_parameter_is_named_that_the_machine_does_not_have() {
    let mut report = with_units(&[
        ("a", &[("busy", 400_000), (">f", 600_000)]),
        ("b", &[("busy", 300_000), ("<f", 650_000), ("done", 50_000)]),
    ]);
    report.config = serde_json::json!({ "fifo": { "g": { "depth": 4 } } });
    assert!(blame(&report).sentence.ends_with("more slots may help (f has 4)."));
}

#[test]
fn a_unit_that_is_busy_most_but_not_always_is_not_alone() {
    check(
        &with_units(&[
            ("a", &[("busy", 300_000), (">f", 700_000)]),
            ("b", &[("busy", 600_000), ("<f", 100_000), ("@z", 300_000)]),
        ]),
        Limit::Unit("b".into()),
        "b limits this run most, though not alone: busy 60 % of the cycles; a is blocked by it 70 % of the time; it \
         waits for port z 30 % of the time.",
    );
}

#[test]
fn a_long_drain_does_not_hide_the_bottleneck() {
    check(
        &with_units(&[
            ("a", &[("busy", 700_000), ("<in", 20_000), (">f", 0), ("done", 280_000)]),
            ("b", &[("busy", 300_000), ("<f", 700_000)]),
        ]),
        Limit::Unit("a".into()),
        "a limits this run: busy 97 % of the cycles up to its last step; b is starved by it 70 % of the time; the last \
         28 % of the run drain what is behind it.",
    );
}

#[test]
fn a_run_cut_short_is_blamed_for_what_it_did() {
    let mut report = samples::balanced();
    report.outcome.kind = OutcomeKind::Limit;
    let sentence = blame(&report).sentence;
    assert!(sentence.starts_with("The limit of cycles was reached; until then replacement (110) limits"), "{sentence}");
    assert_eq!(blame(&samples::functional()).limit, Limit::NoTime);
    assert_eq!(blame(&with_units(&[])).limit, Limit::Ended);
}

#[test]
fn the_kernels_own_report_is_blamed_on_a_part_of_it() {
    let report = samples::simulated();
    match blame(&report).limit {
        Limit::Unit(name) => assert!(report.units.unwrap().contains_key(&name)),
        Limit::Memory(client) => assert_eq!(client, "p"),
        other => panic!("{other:?}"),
    }
}
