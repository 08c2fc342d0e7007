//! Law 6: memories determine times, never data. Results do not depend on the cycle. The functional model runs the same steps with
//! a handle that answers at once.

use crate::common::{PlanBuilder, report, sink_tokens, small_cache, small_memory};
use basrelief_kernel::Request;
use basrelief_kernel::{MemoryConfig, MemoryPorts, Outcome};
use basrelief_kernel_conformance::plan::{Plan, PlanCache, PlanLookUp, PlanMemory, PlanRequest, UnitKind};

/// A reader and a cached client of one memory, before and after a router and a merge.
fn plan(memory: PlanMemory, outstanding: u32) -> Plan {
    let read = PlanRequest { port: "p".into(), write: false, bytes: 40, stride: 52, offset: 4, span: 512 };
    let look_up = PlanLookUp { stride: 12, offset: 0, span: 256 };
    let mut draw = PlanBuilder::default();
    for fifo in ["a", "b", "left", "right", "c", "d"] {
        draw.fifo(fifo, 2, 1);
    }
    draw.memory(memory, &[("p", outstanding), ("q", outstanding)])
        .cache(PlanCache { sets: 2, hit_latency: 1, ..small_cache("q") })
        .unit("source", UnitKind::Source { tokens: 40 }, ["", "a"], &[1], &[0])
        .unit("reader", UnitKind::Access { requests: vec![read] }, ["a", "b"], &[1, 3], &[0, 9])
        .unit("route", UnitKind::Route, ["b", "left right"], &[1], &[0])
        .unit("merge", UnitKind::Merge { tokens: 40 }, ["left right", "c"], &[1], &[0])
        .unit("cached", UnitKind::Cached { cache: "cache".into(), lookups: vec![look_up] }, ["c", "d"], &[1], &[2])
        .unit("sink", UnitKind::Sink, ["d", ""], &[1, 7], &[0]);
    draw.0
}

// Claim: laws, 6 Contents: Tokens and images do not depend on memory timing.
#[test]
fn tokens_do_not_depend_on_the_memory() {
    let small = small_memory().config;
    let quick = MemoryConfig { cl: 0, rcd: 0, rp: 0, burst_cycles: 1, banks: 4, channels: 2, ..small.clone() };
    let slow = MemoryConfig { cl: 50, rcd: 31, rp: 17, ..small };
    let [quick, slow] =
        [(quick, 8), (slow, 1)].map(|(config, outstanding)| plan(PlanMemory { config, ..small_memory() }, outstanding));
    assert_ne!(report(&quick).total, report(&slow).total);
    let [quick_tokens, functional] = sink_tokens(&quick);
    assert_eq!(quick_tokens[0].1.len(), 40);
    assert_eq!(quick_tokens, functional);
    assert_eq!(sink_tokens(&slow), [functional.clone(), functional]);
    assert_eq!(report(&slow).outcome, Outcome::Complete);
}

#[test]
fn memory_ports_return_nothing() {
    let mut timed = MemoryPorts::default();
    timed.read(0, 16, 4);
    timed.write(1, 32, 8);
    timed.look_up(2, 48, 2);
    assert_eq!(
        timed.requests(),
        [Request { client: 0, write: false, address: 16, bytes: 4 }, Request { client: 1, write: true, address: 32, bytes: 8 }]
    );
    assert_eq!(timed.look_ups(), [Request { client: 2, write: false, address: 48, bytes: 2 }]);
    // The handle of the functional model accepts the same calls, and counts nothing.
    let mut muted = MemoryPorts::discarding();
    muted.read(0, 16, 4);
    muted.write(1, 32, 8);
    muted.look_up(2, 48, 2);
    assert!(muted.is_empty());
}
