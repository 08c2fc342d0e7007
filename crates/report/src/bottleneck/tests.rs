use super::*;
use crate::model::Client;
use crate::samples::{self, with_units};

fn check(report: &Report, limit: BottleneckKind, sentence: &str) {
    let diagnosis = diagnose(report);
    assert_eq!(diagnosis.sentence, sentence);
    assert_eq!(diagnosis.limit, limit);
}

#[test]
fn saturated_unit_is_the_bottleneck() {
    check(
        &samples::balanced(),
        BottleneckKind::Unit("replacement".into()),
        "Bottleneck: `replacement` (110), busy 98 % of the cycles. `normal-mapping` is blocked by it 61 % of the time.",
    );
}

#[test]
fn slow_source_is_the_bottleneck() {
    check(
        &samples::source_bound(),
        BottleneckKind::Unit("host".into()),
        "Bottleneck: `host`, busy 100 % of the cycles. `rasterizer` is starved by it 73 % of the time.",
    );
}

#[test]
fn waits_lead_to_the_memory_that_causes_them() {
    let mut report = samples::memory_bound();
    let latency = "Bottleneck: memory `graphics`. `depth-test` waits for its port `z` 54 % of the cycles. Its data bus is \
                   busy only 24 %: latency is the limit, not bandwidth.";
    check(&report, BottleneckKind::Memory("z".into()), latency);
    report.derived["graphics.bus_utilization"].value = 0.92;
    let bandwidth = "Bottleneck: memory `graphics`. `depth-test` waits for its port `z` 54 % of the cycles. Its data bus is \
                     busy 92 %: bandwidth is the limit.";
    check(&report, BottleneckKind::Memory("z".into()), bandwidth);
    let client = &mut report.memories.as_mut().unwrap()["graphics"].clients["z"];
    *client = Client { latency_sum: 1_000, latency: vec![0, 2], ..Client::default() };
    let display = "Bottleneck: the display. `depth-test` waits for its refresh 54 % of the cycles.";
    check(&report, BottleneckKind::Display("z".into()), display);
}

#[test]
fn deadlock_message_equals_the_kernels() {
    check(
        &samples::deadlocked(),
        BottleneckKind::Ended,
        "Deadlock after 1000000 cycles: `fork` waits for a slot in `left` (4 of 4 slots); `join` waits for a token from \
         `right` (0 of 4 slots)",
    );
}

#[test]
fn mutual_waits_name_the_fifo_between() {
    check(
        &with_units(&[
            ("a", &[("busy", 400_000), (">f", 600_000)]),
            ("b", &[("busy", 300_000), ("<f", 650_000), ("done", 50_000)]),
        ]),
        BottleneckKind::Circle(vec!["f".into()]),
        "Bottleneck: units that wait for each other. Of the cycles, `a` waits 60 % for a slot in `f`, `b` waits 65 % for a token \
         from `f`. No unit is slow by itself; more FIFO slots may help (fifo.f.depth = 4).",
    );
}

#[test]
fn absent_depth_parameter_is_not_named() {
    let mut report = with_units(&[
        ("a", &[("busy", 400_000), (">f", 600_000)]),
        ("b", &[("busy", 300_000), ("<f", 650_000), ("done", 50_000)]),
    ]);
    report.config = serde_json::json!({ "fifo": { "g": { "depth": 4 } } });
    assert!(diagnose(&report).sentence.ends_with("more FIFO slots may help (f has 4)."));
}

#[test]
fn unsaturated_unit_is_the_main_bottleneck() {
    check(
        &with_units(&[
            ("a", &[("busy", 300_000), (">f", 700_000)]),
            ("b", &[("busy", 600_000), ("<f", 100_000), ("@z", 300_000)]),
        ]),
        BottleneckKind::Unit("b".into()),
        "Main bottleneck: `b`, busy 60 % of the cycles, so no unit is saturated. `a` is blocked by it 70 % of the time. It waits \
         for port `z` 30 % of the time.",
    );
}

#[test]
fn long_drain_does_not_hide_the_bottleneck() {
    check(
        &with_units(&[
            ("a", &[("busy", 700_000), ("<in", 20_000), (">f", 0), ("done", 280_000)]),
            ("b", &[("busy", 300_000), ("<f", 700_000)]),
        ]),
        BottleneckKind::Unit("a".into()),
        "Bottleneck: `a`, busy 97 % of the cycles up to its last step. `b` is starved by it 70 % of the time. The last 28 % of the \
         run drain the units behind it.",
    );
}

#[test]
fn incomplete_run_has_a_bottleneck() {
    let mut report = samples::balanced();
    report.outcome.kind = OutcomeKind::Limit;
    let sentence = diagnose(&report).sentence;
    assert!(sentence.starts_with("The run reached its cycle limit. Bottleneck: `replacement` (110)"), "{sentence}");
    assert_eq!(diagnose(&samples::functional()).limit, BottleneckKind::NoTime);
    assert_eq!(diagnose(&with_units(&[])).limit, BottleneckKind::Ended);
}

#[test]
fn kernel_report_has_a_bottleneck() {
    let report = samples::simulated();
    match diagnose(&report).limit {
        BottleneckKind::Unit(name) => assert!(report.units.unwrap().contains_key(&name)),
        BottleneckKind::Memory(client) => assert_eq!(client, "p"),
        other => panic!("{other:?}"),
    }
}
