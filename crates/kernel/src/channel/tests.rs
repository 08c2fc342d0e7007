//! Each rule of law 4 for a channel, tested by itself with cycles of column commands computed by hand.

use super::*;

/// A memory in which nothing takes longer than a burst of 2 cycles, except for the times set by a test.
fn quick() -> MemoryConfig {
    MemoryConfig {
        window: 4,
        cap: 4,
        cl: 3,
        cwl: 3,
        rcd: 0,
        rp: 0,
        ras: 0,
        rtp: 0,
        wr: 0,
        wtr: 0,
        rrd: 0,
        faw: 0,
        refi: 0,
        rfc: 0,
        burst_cycles: 2,
        banks: 4,
        ..MemoryConfig::default()
    }
}

/// A burst: bank, row, direction and arrival.
type Sent = (u32, u64, bool, u64);
const READ: bool = false;
const WRITE: bool = true;

/// Returns number, column command and end of each burst, in order of service.
fn served(config: &MemoryConfig, sent: &[Sent]) -> Vec<(u64, u64, u64)> {
    let mut channel = Channel::new(config);
    for (request, &(bank, row, write, arrival)) in (0..).zip(sent) {
        channel.push(Burst { bank, row, write, arrival: Cycle(arrival), client: 0, request });
    }
    let all = std::iter::from_fn(|| channel.serve(Cycle::UNKNOWN));
    all.map(|served| (served.burst.request, served.column.0, served.end.0)).collect()
}

/// Returns the column commands in order of service.
fn columns(config: &MemoryConfig, sent: &[Sent]) -> Vec<(u64, u64)> {
    served(config, sent).into_iter().map(|(number, column, _)| (number, column)).collect()
}

#[test]
fn row_hits_run_at_bus_rate_and_cl_is_latency() {
    let slow = MemoryConfig { cl: 40, ..quick() };
    assert_eq!(served(&slow, &[(0, 0, READ, 7); 3]), [(0, 8, 50), (1, 10, 52), (2, 12, 54)]);
}

#[test]
fn closed_bank_is_activated_and_other_row_precharged() {
    let config = MemoryConfig { rcd: 5, rp: 11, ..quick() };
    // In view and activated at 1: column at 6. The bank is precharged at the same time, because no other time is set: 6 + 11 + 5.
    assert_eq!(columns(&config, &[(0, 0, READ, 0), (0, 1, READ, 0)]), [(0, 6), (1, 22)]);
    let rows = |sent: &[Sent]| {
        let mut channel = Channel::new(&config);
        sent.iter().for_each(|&(bank, row, write, at)| {
            channel.push(Burst { bank, row, write, arrival: Cycle(at), client: 0, request: 0 });
        });
        while channel.serve(Cycle::UNKNOWN).is_some() {}
        channel.counts(0).rows
    };
    let counts = rows(&[(0, 0, READ, 0), (0, 0, READ, 0), (0, 1, READ, 0), (1, 0, READ, 0)]);
    assert_eq!((counts.closed, counts.hits, counts.conflicts), (2, 1, 1));
}

#[test]
fn row_commands_overlap_data() {
    let config = MemoryConfig { rcd: 3, burst_cycles: 4, ..quick() };
    // Bank 1 is activated at 1, like bank 0. Its column waits only for the bus.
    assert_eq!(columns(&config, &[(0, 0, READ, 0), (1, 0, READ, 0)]), [(0, 4), (1, 8)]);
}

#[test]
fn precharge_waits_for_ras_rtp_and_wr() {
    let next = |config: MemoryConfig, first: bool| columns(&config, &[(0, 0, first, 0), (0, 1, READ, 0)])[1].1;
    // Activated and read at 1.
    assert_eq!(next(MemoryConfig { ras: 20, ..quick() }, READ), 1 + 20);
    assert_eq!(next(MemoryConfig { rtp: 9, ..quick() }, READ), 1 + 9);
    assert_eq!(next(MemoryConfig { wr: 9, ..quick() }, READ), 1 + 2);
    // Written at 1: data from 4, for two cycles.
    assert_eq!(next(MemoryConfig { wr: 9, ..quick() }, WRITE), 1 + 3 + 2 + 9);
}

#[test]
fn bus_turnaround_takes_its_time() {
    let config = MemoryConfig { cl: 6, cwl: 2, wtr: 7, burst_cycles: 3, ..quick() };
    // Write to read: 2 + 3 + 7. Read to write: 6 + 3 + 1 - 2.
    assert_eq!(columns(&config, &[(0, 0, WRITE, 0), (0, 0, READ, 1), (0, 0, WRITE, 50)]), [(0, 1), (1, 13), (2, 51)]);
    assert_eq!(columns(&config, &[(0, 0, READ, 0), (0, 0, WRITE, 0)]), [(0, 1), (1, 9)]);
    // Not less than a burst, even if the data of a write come much later.
    let late = MemoryConfig { cl: 0, cwl: 9, burst_cycles: 3, ..quick() };
    assert_eq!(columns(&late, &[(0, 0, READ, 0), (0, 0, WRITE, 0)]), [(0, 1), (1, 4)]);
}

#[test]
fn activations_keep_rrd_and_faw() {
    let sent: Vec<Sent> = (0..6).map(|n| (n % 4, u64::from(n / 4), READ, 0)).collect();
    let config = MemoryConfig { rrd: 5, window: 1, ..quick() };
    // In view one after the other. Activated at 1, 6, 11 ...
    assert_eq!(columns(&config, &sent).iter().map(|c| c.1).collect::<Vec<_>>(), [1, 6, 11, 16, 21, 26]);
    let config = MemoryConfig { faw: 40, window: 1, ..quick() };
    assert_eq!(columns(&config, &sent).iter().map(|c| c.1).collect::<Vec<_>>(), [1, 3, 5, 7, 41, 43]);
}

#[test]
fn first_ready_wins_then_oldest() {
    let config = MemoryConfig { rcd: 4, rp: 4, ..quick() };
    // Row 0 is opened at 1. Burst 1 needs another row, and burst 2 the same row. Burst 2 goes first.
    assert_eq!(columns(&config, &[(0, 0, READ, 0), (0, 1, READ, 0), (0, 0, READ, 0)]), [(0, 5), (2, 7), (1, 15)]);
    // Otherwise in order of arrival, even if all bursts are ready.
    assert_eq!(columns(&quick(), &[(2, 0, READ, 0), (1, 0, READ, 0), (0, 0, READ, 0)]), [(0, 1), (1, 3), (2, 5)]);
}

#[test]
fn window_of_one_serves_in_arrival_order() {
    let config = MemoryConfig { rcd: 4, rp: 4, window: 1, ..quick() };
    // Burst 1 comes into view at 6, and its row is opened then.
    assert_eq!(columns(&config, &[(0, 0, READ, 0), (0, 1, READ, 0), (0, 0, READ, 0)]), [(0, 5), (1, 14), (2, 23)]);
}

#[test]
fn oldest_is_passed_over_at_most_cap_times() {
    let hits: Vec<Sent> = [(0, 0, READ, 0), (0, 1, READ, 0)].into_iter().chain([(0, 0, READ, 0); 5]).collect();
    let order = |cap: u32| -> Vec<u64> {
        let config = MemoryConfig { rp: 90, window: 16, cap, ..quick() };
        columns(&config, &hits).into_iter().map(|(number, _)| number).collect()
    };
    assert_eq!(order(0), [0, 1, 2, 3, 4, 5, 6]);
    assert_eq!(order(2), [0, 2, 3, 1, 4, 5, 6]);
    assert_eq!(order(9), [0, 2, 3, 4, 5, 6, 1]);
}

#[test]
fn refresh_closes_rows_and_delays_activations() {
    let config = MemoryConfig { rcd: 3, refi: 20, rfc: 8, ..quick() };
    // Closed at 0, open at 15. The refresh at 20 closes the row: activated at 28.
    assert_eq!(columns(&config, &[(0, 0, READ, 0), (0, 0, READ, 14), (0, 0, READ, 19)]), [(0, 4), (1, 15), (2, 31)]);
    // Activated at 17, the column would be at 20, after the refresh. Activated at 16, it is before the refresh.
    assert_eq!(columns(&config, &[(0, 0, READ, 16)]), [(0, 31)]);
    assert_eq!(columns(&config, &[(0, 0, READ, 15)]), [(0, 19)]);
    assert_eq!(Channel::new(&config).counts(20).refreshes, 0);
    assert_eq!(Channel::new(&config).counts(61).refreshes, 3);
    assert_eq!(Channel::new(&quick()).counts(u64::MAX).refreshes, 0);
}

#[test]
fn choice_waits_until_final() {
    let config = MemoryConfig { rcd: 9, window: 2, ..quick() };
    let burst = |row, arrival| Burst { bank: 0, row, write: READ, arrival: Cycle(arrival), client: 0, request: 0 };
    let mut channel = Channel::new(&config);
    channel.push(burst(0, 0));
    assert_eq!(channel.next_column(), Some(Cycle(10)));
    // A burst that arrives at 8 could go at 9. A burst that arrives at 9 is younger.
    assert!(channel.serve(Cycle(8)).is_none());
    assert!(channel.serve(Cycle(9)).is_some());
    // With a full window the choice is final at once.
    channel.push(burst(7, 10));
    assert!(channel.serve(Cycle(10)).is_none());
    channel.push(burst(8, 10));
    assert!(channel.serve(Cycle(10)).is_some());
}

#[test]
fn burst_enters_view_after_command_that_made_room() {
    let config = MemoryConfig { rcd: 9, window: 1, ..quick() };
    let mut channel = Channel::new(&config);
    channel.push(Burst { bank: 0, row: 0, write: READ, arrival: Cycle(0), client: 0, request: 0 });
    assert!(channel.serve(Cycle(1)).is_some(), "the window is full: served at 10");
    // The burst arrives at 3, when the first still waits. It comes into view at 11 and is activated then.
    channel.push(Burst { bank: 1, row: 0, write: READ, arrival: Cycle(3), client: 0, request: 1 });
    assert_eq!(channel.next_column(), Some(Cycle(20)));
}
