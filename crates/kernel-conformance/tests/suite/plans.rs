//! Tests that invalid plans are rejected by name.

use crate::common::{PlanBuilder, small_cache, small_memory};
use basrelief_kernel_conformance::plan::{Plan, PlanLookUp, PlanMachine, PlanPeriodic, PlanRequest, UnitKind};

fn good() -> Plan {
    let request = PlanRequest { port: "p".into(), write: false, bytes: 4, stride: 4, offset: 0, span: 64 };
    let lookups = vec![PlanLookUp { stride: 4, offset: 0, span: 64 }];
    let mut draw = PlanBuilder::default();
    draw.memory(small_memory(), &[("p", 2), ("q", 2)])
        .cache(small_cache("q"))
        .fifo("a", 1, 1)
        .fifo("b", 1, 1)
        .fifo("c", 1, 1)
        .unit("source", UnitKind::Source { tokens: 4 }, ["", "a"], &[1], &[0])
        .unit("access", UnitKind::Access { requests: vec![request] }, ["a", "b"], &[1], &[0])
        .unit("cached", UnitKind::Cached { cache: "cache".into(), lookups }, ["b", "c"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["c", ""], &[1], &[0]);
    draw.0
}

fn requests(plan: &mut Plan) -> &mut Vec<PlanRequest> {
    match &mut plan.units[1].kind {
        UnitKind::Access { requests } => requests,
        other => panic!("{other:?}"),
    }
}

#[test]
fn each_fault_is_named() {
    type Break = fn(&mut Plan);
    let cases: &[(Break, &str)] = &[
        (|p| p.fifos[1].name = "a".into(), "FIFO `a`: there are two of this name, expected one"),
        (|p| p.units[1].name = "sink".into(), "unit `sink`: there are two of this name, expected one"),
        (|p| p.memories[0].config.banks = 0, "memory `memory`: `banks` is 0, expected 1..=1024 banks"),
        (|p| p.memories[0].config.refi = 2, "memory `memory`: `refi` is 2, expected 0 or more than `rfc` and `rcd` together, 2"),
        (|p| p.memories[0].ports[0].outstanding = 0, "port `p`: `outstanding` is 0, expected 1..=1048576"),
        (|p| p.caches[0].ways = u32::MAX, "cache `cache`: `ways` is 4294967295, expected 1..=1048576"),
        (|p| p.units[0].occupancy = vec![1, 0], "unit `source`: `occupancy` is 0, expected 1..=1099511627776"),
        (|p| p.fifos[0].period = 0, "FIFO `a`: `period` is 0, expected 1..=1099511627776"),
        (
            |p| p.memories[0].periodic.push(PlanPeriodic { name: "v".into(), period: 0, bytes: 4, stride: 4, span: 4 }),
            "periodic client `v`: `period` is 0, expected 1..=1099511627776",
        ),
        (
            |p| p.memories[0].periodic.push(PlanPeriodic { name: "p".into(), period: 1, bytes: 4, stride: 4, span: 4 }),
            "port `p`: there are two of this name, expected one",
        ),
        (|p| p.units[0].latency.clear(), "unit `source`: `length of latency` is 0, expected 1..=1048576"),
        (|p| p.units[3].kind = UnitKind::Gather { size: 0 }, "unit `sink`: `length of out` is 0, expected 1..=1"),
        (|p| p.units[0].kind = UnitKind::Join, "unit `source`: `length of in` is 0, expected 1..=8"),
        (|p| p.units[1].outputs[0] = "x".into(), "unit `access`: there is no FIFO `x` in \"fifos\""),
        (|p| p.units[1].outputs.clear(), "FIFO `b`: is pushed to by [] and popped by [\"cached\"], expected one unit each"),
        (|p| requests(p)[0].port = "x".into(), "unit `access`: there is no port `x` in \"memories\""),
        (|p| requests(p)[0].span = 0, "unit `access`: `span` is 0, expected 1..=1099511627776"),
        (|p| requests(p)[0].port = "q".into(), "unit `cached`: uses port `q`, which belongs to `access`; give it one of its own"),
        (
            |p| {
                let three = vec![requests(p)[0].clone(); 3];
                *requests(p) = three;
            },
            "unit `access`: needs 3 credits of port `p`, whose `outstanding` is 2",
        ),
        (|p| p.caches[0].name = "other".into(), "unit `cached`: there is no cache `cache` in \"caches\""),
    ];
    assert!(PlanMachine::new(&good()).is_ok());
    for (breakage, expected) in cases {
        let mut plan = good();
        breakage(&mut plan);
        let error = PlanMachine::new(&plan).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(error.starts_with(expected), "got: {error}\nexpected: {expected}");
    }
}
