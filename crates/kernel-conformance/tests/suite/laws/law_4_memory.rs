//! Law 4: requests arrive at the start of their step or at the issue rate of their port, are split into bursts, and are answered in order on each port.
//! (`src/channel/tests.rs` of the kernel tests how a channel serves bursts.)
//!
//! The memory has one bank, rows of 64 bytes, and bursts of 32 bytes and 2 cycles. From view to column: hit 0, closed 2, conflict
//! 4 + 2. From column to data: 3.

use crate::common::{PlanBuilder, account, machine, report, run_both, small_memory, starts, unit};
use basrelief_kernel::{
    Cycle, Engine, FlipCounts, Machine, MemoryConfig, MemoryRequest, Outcome, PeriodicCounts, PortCounts, RunReport, run,
};
use basrelief_kernel_conformance::plan::{Plan, PlanFlips, PlanMemory, PlanPeriodic, PlanPort, PlanRequest, UnitKind};

fn request(port: &str, write: bool, bytes: u32, offset: u64) -> PlanRequest {
    PlanRequest { port: port.into(), write, bytes, stride: 0, offset, span: 1 << 20 }
}

/// A unit with these requests on port p per step. The times of its sink show the answers.
fn client(tokens: u64, outstanding: u32, requests: Vec<PlanRequest>) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .memory(small_memory(), &[("p", outstanding)])
        .unit("source", UnitKind::Source { tokens }, ["", "in"], &[1], &[0])
        .unit("client", UnitKind::Access { requests }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    draw.0
}

/// The same unit with another memory.
fn with(mut plan: Plan, change: impl FnOnce(&mut MemoryConfig)) -> Plan {
    change(&mut plan.memories[0].config);
    plan
}

fn counts(report: &RunReport, port: &str) -> PortCounts {
    report.memories[0].ports.iter().find(|p| p.client == port).unwrap().counts
}

// Claim: laws, 4 Memory: Row hits, closed rows and conflicts have their latencies. The lower port wins in the same cycle.
#[test]
fn hit_closed_and_conflict_have_their_latencies() {
    // Step at 1, three reads, rows 0, 0, 1, in view at 2. Activated 2, column 4, data 7 .. 9. Hit: column 6, data 9 .. 11.
    // Conflict: precharged at 6, activated 10, column 12, data 15 .. 17. Delivered 17, visible 18.
    let plan = client(1, 8, vec![request("p", false, 4, 0), request("p", false, 4, 32), request("p", false, 4, 64)]);
    assert_eq!(starts(&plan, "sink"), [18]);
    let report = report(&plan);
    let counts = counts(&report, "p");
    assert_eq!((counts.rows.closed, counts.rows.hits, counts.rows.conflicts), (1, 1, 1));
    assert_eq!((counts.reads, counts.read_bytes, counts.rows.bursts()), (3, 12, 3));
    // Waiting beyond the one cycle of each request: 4 - 2, 6 - 2, 12 - 2.
    assert_eq!(counts.queue_wait, 16);
    // Answers arrive 9 - 1, 11 - 1 and 17 - 1 cycles after the requests: two below 16.
    assert_eq!(counts.latencies.used_classes(), [0, 0, 0, 2, 1]);
    let channel = report.memories[0].channels[0];
    assert_eq!((channel.rows, channel.bus_busy, channel.queued), (counts.rows, 6, 16 + 3));
}

/// Returns the arrivals of all requests, which must be the same with both engines.
fn arrivals(plan: &Plan) -> Vec<u64> {
    let [timed, ticked] = [Engine::Timed, Engine::Ticked].map(|engine| {
        let mut machine = machine(plan);
        machine.memories().keep_requests();
        run(&mut machine, engine);
        let requests: Vec<_> = machine.memories().take_requests().flat_map(|(_, all)| all).collect();
        requests.iter().map(|request| request.arrival.0).collect::<Vec<_>>()
    });
    assert_eq!(timed, ticked);
    timed
}

#[test]
fn requests_arrive_at_issue_rate() {
    let requests = |issue| {
        let mut plan = client(2, 10, vec![request("p", false, 4, 0); 5]);
        plan.units[1].issue = issue;
        plan
    };
    assert_eq!(arrivals(&requests(0)), [1, 1, 1, 1, 1, 2, 2, 2, 2, 2]);
    // The occupancy is at least ceil(5 / 1) and ceil(5 / 2).
    assert_eq!(arrivals(&requests(1)), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    assert_eq!(arrivals(&requests(2)), [1, 1, 2, 2, 3, 4, 4, 5, 5, 6]);
    assert_eq!(unit(&report(&requests(2)), "client").account.busy, 6);
}

#[test]
fn each_port_issues_at_its_own_rate() {
    let mut plan = client(1, 3, vec![request("p", false, 4, 0), request("q", true, 4, 0), request("p", false, 4, 0)]);
    plan.memories[0].ports.push(PlanPort { name: "q".into(), outstanding: 1, flips: None });
    plan.units[1].issue = 1;
    // Requests 0 and 1 of port p, and request 0 of port q.
    assert_eq!(arrivals(&plan), [1, 1, 2]);
}

/// A client of one read at cycle 1, with a periodic client that reads row 1.
fn beside_periodic(period: u64) -> Plan {
    let mut plan = client(1, 1, vec![request("p", false, 32, 0)]);
    plan.memories[0].periodic = vec![PlanPeriodic { name: "v".into(), period, bytes: 32, stride: 0, span: 32 }];
    plan
}

#[test]
fn periodic_client_comes_after_other_ports() {
    // Both arrive at 1. The periodic client also arrives at 0: activated 1, column 3, data 6 .. 8. The read of the unit goes first
    // among those of cycle 1: hit, column 5, data 8 .. 10, visible 11.
    let plan = beside_periodic(1);
    assert_eq!(starts(&plan, "sink"), [11]);
    // Alone it is closed: column 4, data 7 .. 9, visible 10.
    assert_eq!(starts(&client(1, 1, vec![request("p", false, 32, 0)]), "sink"), [10]);
}

#[test]
fn periodic_requests_count_up_to_the_end() {
    // The run ends at 12. Requests arrive in 0 .. 11. Columns 3, 7, 9, 11: the periodic client has all but the one at 5.
    let report = report(&beside_periodic(1));
    assert_eq!(report.total, 12);
    let counts = counts(&report, "v");
    assert_eq!((counts.reads, counts.rows.bursts()), (12, 4));
    // Data move in 6 .. 11; those of the columns 9 and 11 would move in 12 .. 15.
    assert_eq!(report.memories[0].channels[0].bus_busy, 6);
}

#[test]
fn limit_counts_periodic_reads_up_to_the_last_data() {
    // The read of the unit arrives at 1 and moves its data up to 47. The limit is at 5; a further read would start at 47.
    let mut plan = with(client(3, 1, vec![request("p", false, 32, 0)]), |m| m.cl = 40);
    plan.memories[0].periodic = vec![PlanPeriodic { name: "v".into(), period: 10, bytes: 4, stride: 0, span: 32 }];
    let (report, _) = run_both(&plan, 5);
    assert_eq!((&report.outcome, report.total), (&Outcome::Limit, 5));
    // Requests arrive at 0, 10, 20, 30 and 40.
    assert_eq!(counts(&report, "v").reads, 5);
}

/// A client of three flips, with one credit, of a periodic client that reads in every tenth cycle.
fn flips(period: u64, hold: u64) -> Plan {
    let mut plan = client(3, 1, vec![request("p", true, 4, 256)]);
    plan.memories[0].periodic = vec![PlanPeriodic { name: "v".into(), period: 10, bytes: 32, stride: 32, span: 64 }];
    plan.memories[0].ports[0].flips = Some(PlanFlips { of: "v".into(), period, hold, wait: false });
    plan
}

/// Returns arrival and address of the reads of the periodic client.
fn periodic_reads(plan: &Plan) -> Vec<(u64, u64)> {
    let mut machine = machine(plan);
    machine.memories().keep_requests();
    run(&mut machine, Engine::Timed);
    let requests: Vec<_> = machine.memories().take_requests().flat_map(|(_, all)| all).collect();
    requests.iter().map(|request| (request.arrival.0, request.address)).collect()
}

// Claim: as hit_closed_and_conflict_have_their_latencies.
#[test]
fn flip_takes_effect_at_multiple_of_its_period() {
    let plan = flips(50, 0);
    // The flips take effect at 50, 100 and 150, and return the only credit.
    assert_eq!(starts(&plan, "client"), [1, 50, 100]);
    let report = report(&plan);
    assert_eq!(report.total, 102, "no flip counts for the end");
    let [port, periodic] = ["p", "v"].map(|name| report.memories[0].ports.iter().find(|p| p.client == name).unwrap());
    assert_eq!(port.counts.without_data, 3);
    let data = [port.counts.reads, port.counts.writes, port.counts.write_bytes, port.counts.rows.bursts()];
    assert_eq!(data, [0; 4], "a flip moves no data");
    let flips = FlipCounts { shown: 2, wait: 49 + 50 + 50, longest_wait: 50 };
    // The first read at another base meets an open row and takes 12 cycles, more than the period.
    assert_eq!(periodic.periodic, Some(PeriodicCounts { late: 1, flips }));
    let reads = periodic_reads(&plan);
    assert_eq!(reads[3..7], [(30, 32), (40, 0), (50, 256 + 32), (60, 256)], "the buffer changes, the place in it does not");
}

#[test]
fn held_flip_is_read_for_its_time_only() {
    let plan = flips(50, 20);
    assert_eq!(starts(&plan, "client"), [1, 70, 120]);
    assert_eq!(periodic_reads(&plan), [(50, 256 + 32), (60, 256), (100, 256), (110, 256 + 32)]);
}

#[test]
fn wait_is_answered_when_the_hold_is_over() {
    let mut plan = client(3, 1, vec![request("p", true, 4, 256), request("w", false, 4, 0)]);
    plan.memories[0].ports = flips(50, 20).memories[0].ports.clone();
    plan.memories[0].periodic = flips(50, 20).memories[0].periodic.clone();
    let wait = PlanFlips { of: "v".into(), period: 1, hold: 0, wait: true };
    plan.memories[0].ports.push(PlanPort { name: "w".into(), outstanding: 1, flips: Some(wait) });
    // The flips return their credit at 70, 120 and 170, and the read of each step is answered then.
    assert_eq!(starts(&plan, "sink"), [71, 121, 171]);
    assert_eq!(counts(&report(&plan), "w").without_data, 3);
    // A wait in front of the flip of its cycle belongs to the flip before. The first has none.
    plan.memories[0].ports.rotate_left(1);
    assert_eq!(starts(&plan, "sink"), [8, 77, 127]);
}

#[test]
fn late_answers_of_periodic_client_are_counted() {
    // A row conflict in every read takes longer than the period.
    let mut plan = beside_periodic(5);
    plan.memories[0].periodic[0].stride = 64;
    plan.memories[0].periodic[0].span = 128;
    let late = |plan: &Plan| report(plan).memories[0].ports[0].periodic.unwrap().late;
    assert_eq!([late(&plan), late(&beside_periodic(50))], [1, 0]);
}

#[test]
fn request_is_split_into_aligned_bursts() {
    // 60 bytes from 20 touch the bursts at 0, 32 and 64, as the three requests above do.
    let plan = client(1, 1, vec![request("p", false, 60, 20)]);
    assert_eq!(starts(&plan, "sink"), [18]);
    let counts = counts(&report(&plan), "p");
    assert_eq!((counts.reads, counts.rows.bursts(), counts.read_bytes), (1, 3, 60));
}

#[test]
fn channels_share_nothing_and_interleave_by_bytes() {
    // 0 and 32 are in channel 0. 64 is in channel 1, where row 0 is closed too. Data 7 .. 9 on both. The second burst of channel
    // 0 is a hit at 6: 9 .. 11, visible 12.
    let requests = [0, 32, 64].map(|offset| request("p", false, 32, offset));
    let plan = with(client(1, 8, requests.into()), |m| (m.channels, m.channel_bytes) = (2, 64));
    assert_eq!(starts(&plan, "sink"), [12]);
    let report = report(&plan);
    let [first, second] = [0, 1].map(|channel| report.memories[0].channels[channel].rows);
    assert_eq!((first.closed, first.hits, second.closed, second.bursts()), (1, 1, 1, 1));
    // 128 is in channel 0 again, directly after 32. With rows of 128 bytes both are in the same row.
    let requests = [32, 128].map(|offset| request("p", false, 32, offset));
    let plan = with(client(1, 8, requests.into()), |m| (m.channels, m.channel_bytes, m.row_bytes) = (2, 64, 128));
    assert_eq!(counts(&self::report(&plan), "p").rows.hits, 1);
}

#[test]
fn writes_are_posted_but_hold_a_credit() {
    // Steps at 1 and, with one credit, at the end of the first write: column 4, data 7 .. 9.
    let plan = client(2, 1, vec![request("p", true, 32, 0)]);
    assert_eq!(starts(&plan, "client"), [1, 9]);
    // No token waits for a write: delivered at the start, visible one cycle later.
    assert_eq!(starts(&plan, "sink"), [2, 10]);
    // The second write: column 10, hit, data 13 .. 15. The run ends when the memory has finished.
    assert_eq!(report(&plan).total, 15);
}

#[test]
fn answers_of_a_port_come_in_order() {
    // Row 0, row 1, row 0: the third burst is served before the second, at 6, but answered with it.
    let requests = [0, 64, 32].map(|offset| request("p", false, 32, offset));
    let report = report(&client(1, 8, requests.into()));
    assert_eq!(counts(&report, "p").rows.hits, 1);
    // Latencies of 8, then 16 and 16 cycles.
    assert_eq!(counts(&report, "p").latencies.used_classes(), [0, 0, 0, 1, 2]);
}

/// Two sources, each with its own client of one memory. `order` defines the order of wiring.
fn two_clients(order: [usize; 2]) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.memory(small_memory(), &[("p0", 8), ("p1", 8)]);
    for n in order {
        let [input, output] = [format!("in{n}"), format!("out{n}")];
        let read = UnitKind::Access { requests: vec![request(&format!("p{n}"), false, 32, 64 * n as u64)] };
        draw.fifo(&input, 8, 1)
            .fifo(&output, 8, 1)
            .unit(&format!("source{n}"), UnitKind::Source { tokens: 1 }, ["", &input], &[1], &[0])
            .unit(&format!("client{n}"), read, [&input, &output], &[1], &[0])
            .unit(&format!("sink{n}"), UnitKind::Sink, [&output, ""], &[1], &[0]);
    }
    draw.0
}

// Claim: as hit_closed_and_conflict_have_their_latencies.
#[test]
fn lower_port_wins_same_cycle_in_any_wiring() {
    for order in [[0, 1], [1, 0]] {
        let plan = two_clients(order);
        // Both requests arrive at 1. Port 0: column 4, data 7 .. 9, visible 10. Port 1: precharged at 4, column 10, data 13 ..
        // 15, visible 16.
        assert_eq!(starts(&plan, "sink0"), [10]);
        assert_eq!(starts(&plan, "sink1"), [16]);
    }
}

#[test]
fn earlier_request_is_served_first() {
    let mut plan = two_clients([0, 1]);
    plan.units[0].latency = vec![1];
    // Client 0 starts one cycle later. Port 1: data 7 .. 9, visible 10. Port 0 now has the times that port 1 had above.
    assert_eq!(starts(&plan, "client0"), [2]);
    assert_eq!(starts(&plan, "sink1"), [10]);
    assert_eq!(starts(&plan, "sink0"), [16]);
}

#[test]
fn step_waits_for_its_last_answer() {
    // Every step reads a slow memory with one credit, and a quick memory that another unit shares. The slow answers are known
    // long before the quick answers are final, and must not be forgotten until then.
    let slow = MemoryConfig { cl: 90, ..small_memory().config };
    let requests = vec![request("s", false, 4, 0), request("q", false, 4, 0)];
    let mut draw = PlanBuilder::default();
    draw.memory(PlanMemory { name: "slow".into(), config: slow, ..small_memory() }, &[("s", 1)])
        .memory(PlanMemory { name: "quick".into(), ..small_memory() }, &[("q", 8), ("other", 1)])
        .fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .fifo("in2", 8, 1)
        .unit("source", UnitKind::Source { tokens: 4 }, ["", "in"], &[1], &[0])
        .unit("client", UnitKind::Access { requests }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0])
        .unit("source2", UnitKind::Source { tokens: 1 }, ["", "in2"], &[1], &[0])
        .unit("client2", UnitKind::Access { requests: vec![request("other", false, 4, 0)] }, ["in2", ""], &[1], &[0]);
    // Slow memory: step 0 at 1, closed, column 4, data 94 .. 96. Then a hit 1 + 90 + 2 after each step.
    assert_eq!(starts(&draw.0, "client"), [1, 96, 189, 282]);
    assert_eq!(starts(&draw.0, "sink"), [97, 190, 283, 376]);
}

#[test]
fn memory_wait_is_charged_to_port() {
    let report = report(&client(2, 1, vec![request("p", false, 32, 0)]));
    // Steps at 1 and 9. The second answer is a hit: 9 + 1 + 3 + 2 = 15, visible 16. 17 cycles.
    assert_eq!(unit(&report, "client").steps, 2);
    assert_eq!(account(&report, "client"), "busy 2, done 7, starved in 1, memory p 7");
}

#[test]
fn request_log_keeps_arrival_order() {
    for engine in [Engine::Timed, Engine::Ticked] {
        let mut machine = machine(&two_clients([1, 0]));
        machine.memories().keep_requests();
        run(&mut machine, engine);
        let kept: Vec<_> = machine.memories().take_requests().map(|(name, all)| (name.to_owned(), all)).collect();
        let request = |client| MemoryRequest { arrival: Cycle(1), client, write: false, address: 64 * client as u64, bytes: 32 };
        assert_eq!(kept, [("memory".to_owned(), vec![request(0), request(1)])]);
        assert!(machine.memories().take_requests().all(|(_, all)| all.is_empty()));
    }
}

#[test]
fn row_command_waits_for_room_on_command_bus() {
    // Three banks: activations in cycle 2, column commands in 4, 5 and 6. With one command per cycle, the second activation is in 3.
    // The third finds no room before 6, so its column command is in 8. With two per cycle, the third activation is in 3.
    let visible = |commands_per_cycle| {
        let plan = client(1, 3, [0, 64, 128].map(|offset| request("p", false, 32, offset)).to_vec());
        let limit = |config: &mut MemoryConfig| {
            (config.banks, config.burst_cycles, config.commands_per_cycle) = (4, 1, commands_per_cycle);
        };
        starts(&with(plan, limit), "sink")[0]
    };
    assert_eq!([0, 1, 2].map(visible), [11, 13, 11]);
}
