//! Law 9: every cycle of every unit is busy, done, or charged to the first cause that applies. The sum is the total.

use crate::common::{PlanBuilder, account, report, small_cache, small_memory};
use basrelief_kernel_conformance::plan::{Plan, PlanCache, PlanLookUp, PlanPort, PlanRequest, UnitKind};

/// A source, a unit of the given kind with a port and a cache available, and a sink.
fn around(kind: UnitKind, tokens: u64, outstanding: u32, depth: usize, sink: u64) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 8, 1)
        .fifo("out", depth, 1)
        .memory(small_memory(), &[("p", outstanding)])
        .unit("source", UnitKind::Source { tokens }, ["", "in"], &[1], &[0])
        .unit("unit", kind, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[sink], &[0]);
    draw.0
}

fn request(write: bool) -> UnitKind {
    let request = PlanRequest { port: "p".into(), write, bytes: 32, stride: 0, offset: 0, span: 64 };
    UnitKind::Access { requests: vec![request] }
}

// Claim: laws, 9 Accounting: Each cycle of a unit is busy, starved, blocked, memory wait or done, and causes add up to the total.
#[test]
fn busy_starved_blocked_done() {
    // Two tokens, one output slot, a sink occupied for 5 cycles. Step 0 at 1, visible and popped 2, slot free 3. Step 1 at 3,
    // visible 4, popped when the sink is free, at 7. The sink ends at 12.
    let report = report(&around(UnitKind::Work, 2, 1, 1, 5));
    assert_eq!(report.total, 12);
    // 0 starved, 1 busy, 2 blocked, 3 busy, 4 .. 11 done.
    assert_eq!(account(&report, "unit"), "busy 2, done 8, starved in 1, blocked out 1");
    assert_eq!(account(&report, "source"), "busy 2, done 10");
    assert_eq!(account(&report, "sink"), "busy 10, starved out 2");
}

#[test]
fn too_few_credits_count_as_memory() {
    // One credit. Step 0 at 1: closed, column 4, data 7 .. 9. The credit returns at 9: step 1. 2 .. 8 are memory.
    // Hit, column 10, data 13 .. 15, visible and popped 16: 17 cycles.
    let report = report(&around(request(false), 2, 1, 8, 1));
    assert_eq!(report.total, 17);
    assert_eq!(account(&report, "unit"), "busy 2, done 7, starved in 1, memory p 7");
}

#[test]
fn blocking_cycles_count_as_memory() {
    // Eight credits. Step 0 at 1, answer 9: 2 .. 8 are memory. Step 1 at 9, answer 15: 10 .. 14 are memory.
    let mut plan = around(request(false), 2, 8, 8, 1);
    plan.units[1].blocking = true;
    let report = report(&plan);
    assert_eq!(report.total, 17);
    assert_eq!(account(&report, "unit"), "busy 2, done 2, starved in 1, memory p 12");
}

#[test]
fn blocking_cycles_count_for_first_mentioned_port() {
    // Step at 1. Port p has the lower number: column 4, answer 9. Port q: hit, column 6, answer 11.
    let of = |port: &str| PlanRequest { port: port.into(), write: false, bytes: 32, stride: 0, offset: 0, span: 64 };
    let charged = |ports: [&str; 2]| {
        let mut plan = around(UnitKind::Access { requests: ports.map(of).to_vec() }, 1, 8, 8, 1);
        plan.memories[0].ports.push(PlanPort { name: "q".into(), outstanding: 1, flips: None });
        plan.units[1].blocking = true;
        account(&report(&plan), "unit")
    };
    assert_eq!(charged(["p", "q"]), "busy 1, done 2, starved in 1, memory p 7, memory q 2");
    assert_eq!(charged(["q", "p"]), "busy 1, done 2, starved in 1, memory q 9");
}

#[test]
fn full_output_awaiting_answer_counts_as_memory() {
    // Enough credits, one slot. Step 0 at 1, data 7 .. 9, visible and popped 10, slot free 11: step 1. Of 2 .. 10, the cycles
    // before the answer at 9 are charged to memory, and 9 and 10 to the FIFO. Hit, column 12, data 15 .. 17, popped 18.
    let report = report(&around(request(false), 2, 8, 1, 1));
    assert_eq!(report.total, 19);
    assert_eq!(account(&report, "unit"), "busy 2, done 7, starved in 1, memory p 7, blocked out 2");
}

#[test]
fn posted_write_delays_no_token() {
    // The same with a write: visible and popped 2, slot free 3, step 1 at 3. Cycle 2 is charged to the FIFO. Popped 4. The memory
    // moves data 7 .. 9 and, for a hit with its column command at 6, 9 .. 11.
    let report = report(&around(request(true), 2, 8, 1, 1));
    assert_eq!(report.total, 11);
    assert_eq!(account(&report, "unit"), "busy 2, done 7, starved in 1, blocked out 1");
}

#[test]
fn hit_latency_counts_as_memory() {
    // Line 0 twice, the second time long after the first. A third token follows directly, into one slot.
    let lookups = vec![PlanLookUp { stride: 0, offset: 0, span: 64 }];
    let mut plan = around(UnitKind::Cached { cache: "cache".into(), lookups }, 3, 8, 1, 1);
    plan.caches.push(PlanCache { sets: 1, hit_latency: 4, ..small_cache("p") });
    plan.units[0].occupancy = vec![20, 1, 1];
    // Step 0 at 1: answer 9 + 4 = 13, popped 14. Step 1 at 21: hit, answer 25, visible and popped 26, slot free 27: step 2. Of 22
    // .. 26: 22, 23, 24 are memory, 25 and 26 the FIFO. Answer 31, popped 32: 33 cycles.
    let report = report(&plan);
    assert_eq!(report.total, 33);
    // Starved 0 and 2 .. 20; done 28 .. 32.
    assert_eq!(account(&report, "unit"), "busy 3, done 5, starved in 20, memory p 3, blocked out 2");
}

#[test]
fn first_starved_input_counts() {
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 4, 1)
        .fifo("b", 4, 1)
        .fifo("out", 4, 1)
        .unit("slow", UnitKind::Source { tokens: 1 }, ["", "a"], &[1], &[3])
        .unit("slower", UnitKind::Source { tokens: 1 }, ["", "b"], &[1], &[7])
        .unit("join", UnitKind::Join, ["a b", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    // a is visible at 4, b at 8: 0 .. 3 for a, 4 .. 7 for b; popped 9: 10 cycles.
    assert_eq!(account(&report(&draw.0), "join"), "busy 1, done 1, starved a 4, starved b 4");
}

#[test]
fn deadlocked_units_keep_their_cause() {
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 2, 1)
        .fifo("b", 2, 1)
        .fifo("out", 4, 1)
        .unit("many", UnitKind::Source { tokens: 9 }, ["", "a"], &[1], &[0])
        .unit("one", UnitKind::Source { tokens: 1 }, ["", "b"], &[1], &[0])
        .unit("join", UnitKind::Join, ["a b", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    // `many` steps at 0 and 1. Token 0 is popped at 1, and its slot is free at 2: step at 2, visible 3, the last event: 4 cycles.
    // `many` waits in 3.
    let report = report(&draw.0);
    assert_eq!(report.total, 4);
    assert_eq!(account(&report, "many"), "busy 3, blocked a 1");
    assert_eq!(account(&report, "one"), "busy 1, done 3");
    // 0 starved for `a`; 1 busy. `a` is visible again at 2, `b` never: 2 and 3 are charged to `b`.
    assert_eq!(account(&report, "join"), "busy 1, starved a 1, starved b 2");
}
