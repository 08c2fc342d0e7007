//! Complete machines computed by hand: every cycle of every unit, and every slot of every FIFO.

use crate::common::{PlanBuilder, account, histogram, report, small_cache, small_memory, starts};
use basrelief_kernel::{CacheCounts, Latencies, PortCounts, RowCounts, RunReport};
use basrelief_kernel_conformance::plan::{PlanLookUp, PlanRequest, UnitKind};

/// Compares the cycle breakdown of some units and the histograms of some FIFOs.
fn check(report: &RunReport, total: u64, accounts: &[(&str, &str)], histograms: &[(&str, &[u64])]) {
    assert_eq!(report.total, total);
    for (unit, expected) in accounts {
        assert_eq!(account(report, unit), *expected, "{unit}");
    }
    for (fifo, expected) in histograms {
        assert_eq!(histogram(report, fifo), *expected, "{fifo}");
    }
}

/// Cycle    0 1 2 3 4 5 6 7 8 9 10 11 12 13
/// source   0 a 1 a a 2 a a 3 -  -  -  -  -     a: blocked by a; - done
/// work     . 0 0 0 1 1 1 2 2 2  3  3  3  -     . starved
/// sink     . . . . 0 . . 1 . .  2  .  .  3     latency 2, f = 1: start + 3
/// a holds  1 1 1 1 1 1 1 1 1 1  1  0  0  0     a slot freed by a pop at s is reserved at s + 1
/// b holds  0 1 1 1 2 1 1 2 1 1  2  1  1  1     reserved at work's start, popped 3 later
#[test]
fn chain() {
    let draw = PlanBuilder::chain();
    assert_eq!(starts(&draw.0, "source"), [0, 2, 5, 8]);
    assert_eq!(starts(&draw.0, "work"), [1, 4, 7, 10]);
    check(
        &report(&draw.0),
        14,
        &[("source", "busy 4, done 5, blocked a 5"), ("work", "busy 12, done 1, starved a 1"), ("sink", "busy 4, starved b 10")],
        &[("a", &[3, 11]), ("b", &[1, 10, 3])],
    );
}

/// The right branch takes 2 cycles and delivers 3 later. All FIFOs after the fork have one slot.
///
/// Cycle    0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17
/// source   0 1 2 -
/// fork     . 0 l 1 l l l l 2 -                            l: blocked by l
/// left     . . 0 . b b b 1 . b  b  b  2  -                b: blocked by l2, full until the join pops it
/// right    . . 0 0 b b b 1 1 b  b  b  2  2  -             b: blocked by r2
/// join     l l l r r r 0 l r r  r  1  l  r  r  r  2  -    l, r: starved, l2 first
/// sink     . . . . . . . 0 . .  .  .  1  .  .  .  .  2
#[test]
fn fork_and_join() {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 2, 1);
    for fifo in ["l", "r", "l2", "r2", "out"] {
        draw.fifo(fifo, 1, 1);
    }
    draw.unit("source", UnitKind::Source { tokens: 3 }, ["", "in"], &[1], &[0])
        .unit("fork", UnitKind::Fork, ["in", "l r"], &[1], &[0])
        .unit("left", UnitKind::Work, ["l", "l2"], &[1], &[0])
        .unit("right", UnitKind::Work, ["r", "r2"], &[2], &[3])
        .unit("join", UnitKind::Join, ["l2 r2", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    assert_eq!(starts(&draw.0, "join"), [6, 11, 16]);
    check(
        &report(&draw.0),
        18,
        &[
            ("source", "busy 3, done 15"),
            ("fork", "busy 3, done 9, starved in 1, blocked l 5"),
            ("left", "busy 3, done 5, starved l 4, blocked l2 6"),
            ("right", "busy 6, done 4, starved r 2, blocked r2 6"),
            ("join", "busy 3, done 1, starved l2 5, starved r2 9"),
            ("sink", "busy 3, starved out 15"),
        ],
        // in: token 0 in 0..=1, 1 in 1..=3, 2 in 2..=8. l2: 2..=6, 7..=11, 12..=16.
        &[("in", &[9, 6, 3]), ("l2", &[3, 15])],
    );
}

/// A reader with one credit and a writer with two share one bank. Hit 3, closed 5, conflict 9; then 2 on the bus.
///
/// | arrival | request | column command | data | ends |
/// |---|---|---|---|---|
/// | 1 | read 0, row 0 (port 0 first) | closed: 4 | 7 | 9 |
/// | 1 | write 0, row 1 | conflict, precharged at 4: 10 | 13 | 15 |
/// | 2 | write 1, row 1 | hit: 12 | 15 | 17 |
/// | 9, credit back | read 1, row 0 | conflict, precharged at 17: 23 | 26 | 28 |
///
/// Reads are visible, and popped, at 10 and 29.
#[test]
fn two_clients_of_one_memory() {
    let request = |port: &str, write, offset| PlanRequest { port: port.into(), write, bytes: 32, stride: 0, offset, span: 128 };
    let reads = UnitKind::Access { requests: vec![request("r", false, 0)] };
    let writes = UnitKind::Access { requests: vec![request("w", true, 64)] };
    let mut draw = PlanBuilder::default();
    draw.memory(small_memory(), &[("r", 1), ("w", 2)])
        .fifo("a", 2, 1)
        .fifo("b", 2, 1)
        .fifo("out", 2, 1)
        .unit("source_a", UnitKind::Source { tokens: 2 }, ["", "a"], &[1], &[0])
        .unit("source_b", UnitKind::Source { tokens: 2 }, ["", "b"], &[1], &[0])
        .unit("reader", reads, ["a", "out"], &[1], &[0])
        .unit("writer", writes, ["b", ""], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    assert_eq!(starts(&draw.0, "reader"), [1, 9]);
    assert_eq!(starts(&draw.0, "writer"), [1, 2]);
    let report = report(&draw.0);
    check(
        &report,
        30,
        &[
            ("reader", "busy 2, done 20, starved a 1, memory r 7"),
            ("writer", "busy 2, done 27, starved b 1"),
            ("sink", "busy 2, starved out 28"),
        ],
        // a: 0..=1 and 1..=9. out: 1..=10 and 9..=29.
        &[("a", &[20, 9, 1]), ("out", &[1, 27, 2])],
    );
    // Waiting beyond arrival + 1: 4 - 2 and 23 - 10; 10 - 2 and 12 - 3. Answered after 8 and 19, and after 14 and 15 cycles.
    let rows = RowCounts { closed: 1, conflicts: 1, hits: 0 };
    let latencies = latencies(&[8, 19]);
    let read = PortCounts { reads: 2, read_bytes: 64, rows, queue_wait: 15, latencies, ..PortCounts::default() };
    let rows = RowCounts { closed: 0, conflicts: 1, hits: 1 };
    let latencies = self::latencies(&[14, 15]);
    let written = PortCounts { writes: 2, write_bytes: 64, rows, queue_wait: 17, latencies, ..PortCounts::default() };
    assert_eq!(report.memories[0].ports.iter().map(|p| p.counts).collect::<Vec<_>>(), [read, written]);
}

/// Lines 0, 1, 0, 1 in steps 1, 2, 3, 4, hit latency 2.
///
/// | step | line | look-up | memory | answer | visible |
/// |---|---|---|---|---|---|
/// | 1 | 0 | miss | closed, column 4: 7 .. 9 | 11 | 12 |
/// | 2 | 1 | miss under miss | hit, column 6: 9 .. 11 | 13 | 14 |
/// | 3 | 0 | merged with the first | | 11, in order: 13 | 15 |
/// | 4 | 1 | merged with the second | | 13 | 16 |
#[test]
fn cache_miss_under_miss() {
    let lookups = vec![PlanLookUp { stride: 32, offset: 0, span: 64 }];
    let mut draw = PlanBuilder::default();
    draw.memory(small_memory(), &[("p", 8)])
        .cache(small_cache("p"))
        .fifo("in", 4, 1)
        .fifo("out", 4, 1)
        .unit("source", UnitKind::Source { tokens: 4 }, ["", "in"], &[1], &[0])
        .unit("cached", UnitKind::Cached { cache: "cache".into(), lookups }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    assert_eq!(starts(&draw.0, "cached"), [1, 2, 3, 4]);
    assert_eq!(starts(&draw.0, "sink"), [12, 14, 15, 16]);
    let report = report(&draw.0);
    check(
        &report,
        17,
        &[("cached", "busy 4, done 12, starved in 1"), ("sink", "busy 4, starved out 13")],
        // out: reserved at 1, 2, 3, 4, popped at 12, 14, 15, 16.
        &[("out", &[1, 2, 2, 3, 9])],
    );
    assert_eq!(report.caches[0].counts, CacheCounts { hits: 0, misses: 2, merged: 2 });
    let (rows, latencies) = (RowCounts { hits: 1, closed: 1, conflicts: 0 }, latencies(&[8, 9]));
    let counts = PortCounts { reads: 2, read_bytes: 64, rows, queue_wait: 5, latencies, ..PortCounts::default() };
    assert_eq!(report.memories[0].ports[0].counts, counts);
}

/// Returns the histogram of these latencies from arrival to answer.
fn latencies(cycles: &[u64]) -> Latencies {
    let mut latencies = Latencies::default();
    cycles.iter().for_each(|n| latencies.at_least[n.ilog2() as usize] += 1);
    latencies.total = cycles.iter().sum();
    latencies
}
