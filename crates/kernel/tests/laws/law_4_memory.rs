//! Requests arrive at the start of their step; first come, first served over (arrival, port number, order of issue).
//!
//! The memory: one bank, rows of 64 bytes, bursts of 32 bytes and 2 cycles; from command to data: hit 3, closed 2 + 3,
//! conflict 4 + 2 + 3.

use super::common::{Draw, account, report, small_memory, starts, unit};
use basrelief_kernel::plan::{Kind, Plan, PlanMemory, PlanRequest};
use basrelief_kernel::{PortCounts, RunReport};

fn request(port: &str, write: bool, bytes: u32, offset: u64) -> PlanRequest {
    PlanRequest { port: port.into(), write, bytes, stride: 0, offset, span: 1 << 20 }
}

/// One unit with these requests on port p per step; how long its sink waits shows the answers.
fn client(tokens: u64, outstanding: u32, requests: Vec<PlanRequest>) -> Plan {
    let mut draw = Draw::default();
    draw.fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .memory(small_memory(), &[("p", outstanding)])
        .unit("source", Kind::Source { tokens }, ["", "in"], &[1], &[0])
        .unit("client", Kind::Access { requests }, ["in", "out"], &[1], &[0])
        .unit("sink", Kind::Sink, ["out", ""], &[1], &[0]);
    draw.0
}

fn counts(report: &RunReport, port: &str) -> PortCounts {
    report.memories[0].ports.iter().find(|p| p.client == port).unwrap().counts
}

#[test]
fn hit_closed_and_conflict_take_their_times() {
    // Step at 1, three reads, rows 0, 0, 1. Command 2, closed: data 7 .. 9. Command 9 (bank free at 9), hit: data
    // 12 .. 14. Command 14, conflict: data 14 + 9 = 23 .. 25. Delivered 25, visible 26.
    let plan = client(1, 8, vec![request("p", false, 4, 0), request("p", false, 4, 32), request("p", false, 4, 64)]);
    assert_eq!(starts(&plan, "sink"), [26]);
    let counts = counts(&report(&plan), "p");
    assert_eq!((counts.row_closed, counts.row_hits, counts.row_conflicts), (1, 1, 1));
    assert_eq!((counts.reads, counts.read_bytes, counts.bursts), (3, 12, 3));
    // Beyond the one cycle that each needs: 0, then 9 - 2, then 14 - 2.
    assert_eq!(counts.wait_cycles, 19);
}

#[test]
fn a_request_is_split_into_aligned_bursts() {
    // 60 bytes from 20 touch the bursts at 0, 32 and 64: as the three requests before, in one.
    let plan = client(1, 1, vec![request("p", false, 60, 20)]);
    assert_eq!(starts(&plan, "sink"), [26]);
    let counts = counts(&report(&plan), "p");
    assert_eq!((counts.reads, counts.bursts, counts.read_bytes), (1, 3, 60));
}

#[test]
fn writes_are_posted_but_hold_a_credit() {
    // Steps at 1 and, with one credit, when the first write is done: command 2, closed, data 7 .. 9.
    let plan = client(2, 1, vec![request("p", true, 32, 0)]);
    assert_eq!(starts(&plan, "client"), [1, 9]);
    // Nothing waits for a write: delivered at the start, visible one cycle later.
    assert_eq!(starts(&plan, "sink"), [2, 10]);
    // The second: command 10, hit: data 13 .. 15. The run lasts until the memory is done.
    assert_eq!(report(&plan).total, 15);
}

#[test]
fn banks_overlap_and_the_bus_does_not() {
    let memory = PlanMemory { banks: 2, burst_cycles: 4, ..small_memory() };
    let mut plan = client(1, 8, vec![request("p", false, 4, 0), request("p", false, 4, 64)]);
    plan.memories[0] = PlanMemory { ports: plan.memories[0].ports.clone(), ..memory };
    // Row 0 is in bank 0, row 1 in bank 1. Commands at 2 and 3, data from 7 and 8: the bus is free at 11, so 11 .. 15.
    assert_eq!(starts(&plan, "sink"), [16]);
}

/// Two sources, each with a client of the one memory; `order` says which client is wired first.
fn two_clients(order: [usize; 2]) -> Plan {
    let mut draw = Draw::default();
    draw.memory(small_memory(), &[("p0", 8), ("p1", 8)]);
    for n in order {
        let [input, output] = [format!("in{n}"), format!("out{n}")];
        let read = Kind::Access { requests: vec![request(&format!("p{n}"), false, 32, 64 * n as u64)] };
        draw.fifo(&input, 8, 1)
            .fifo(&output, 8, 1)
            .unit(&format!("source{n}"), Kind::Source { tokens: 1 }, ["", &input], &[1], &[0])
            .unit(&format!("client{n}"), read, [&input, &output], &[1], &[0])
            .unit(&format!("sink{n}"), Kind::Sink, [&output, ""], &[1], &[0]);
    }
    draw.0
}

#[test]
fn of_requests_in_one_cycle_the_lower_port_goes_first_however_they_are_wired() {
    for order in [[0, 1], [1, 0]] {
        let plan = two_clients(order);
        // Both arrive at 1. Port 0: command 2, closed, data 7 .. 9, visible 10. Port 1: command 9, conflict, data
        // 18 .. 20, visible 21.
        assert_eq!(starts(&plan, "sink0"), [10]);
        assert_eq!(starts(&plan, "sink1"), [21]);
    }
}

#[test]
fn who_comes_first_is_served_first() {
    let mut plan = two_clients([0, 1]);
    plan.units[0].latency = vec![1];
    // Client 0 starts one cycle later. Port 1: command 2, data 7 .. 9, visible 10; port 0: 9, data 18 .. 20, visible 21.
    assert_eq!(starts(&plan, "client0"), [2]);
    assert_eq!(starts(&plan, "sink1"), [10]);
    assert_eq!(starts(&plan, "sink0"), [21]);
}

#[test]
fn a_step_waits_for_the_last_of_its_answers_whichever_is_known_first() {
    // Every step reads a slow memory of its own, with one credit, and a quick one that another unit shares: when the
    // quick answers are settled, the slow ones have long been known - once so long that they were forgotten.
    let slow = PlanMemory { name: "slow".into(), cas: 90, ..small_memory() };
    let requests = vec![request("s", false, 4, 0), request("q", false, 4, 0)];
    let mut draw = Draw::default();
    draw.memory(slow, &[("s", 1)])
        .memory(PlanMemory { name: "quick".into(), ..small_memory() }, &[("q", 8), ("other", 1)])
        .fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .fifo("in2", 8, 1)
        .unit("source", Kind::Source { tokens: 4 }, ["", "in"], &[1], &[0])
        .unit("client", Kind::Access { requests }, ["in", "out"], &[1], &[0])
        .unit("sink", Kind::Sink, ["out", ""], &[1], &[0])
        .unit("source2", Kind::Source { tokens: 1 }, ["", "in2"], &[1], &[0])
        .unit("client2", Kind::Access { requests: vec![request("other", false, 4, 0)] }, ["in2", ""], &[1], &[0]);
    // Slow: step 0 at 1, command 2, closed, data 2 + 92 = 94 .. 96; then a hit 1 + 90 + 2 after each step.
    assert_eq!(starts(&draw.0, "client"), [1, 96, 189, 282]);
    assert_eq!(starts(&draw.0, "sink"), [97, 190, 283, 376]);
}

#[test]
fn waiting_for_memory_is_charged_to_the_port() {
    let report = report(&client(2, 1, vec![request("p", false, 32, 0)]));
    // Steps at 1 and at 9; the second answer, a hit: 9 + 1 + 3 + 2 = 15, visible 16. 17 cycles.
    assert_eq!(unit(&report, "client").steps, 2);
    assert_eq!(account(&report, "client"), "busy 2, done 7, starved in 1, memory p 7");
}
