//! Law 11: mark k is passed in the cycle in which the marked step delivers. marks[k] = end(k) - end(k-1). The rest is drain.

use basrelief_kernel::{Demand, Engine, MemoryPorts, RunReport, Step, Unit, run};
use basrelief_kernel_conformance::contract::{Bench, ClientKind, TestEnvironment};

/// Marks every third step. Each step looks up the same line.
#[derive(Clone)]
struct Marker {
    clients: bool,
    latency: u64,
    /// True if no step gives a token.
    swallows: bool,
}

const MARKER: Marker = Marker { clients: false, latency: 2, swallows: false };

impl Unit for Marker {
    type In = Option<u32>;
    type Out = Option<u32>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, input: Option<u32>, traffic: &mut MemoryPorts) -> Step<Option<u32>> {
        if self.clients {
            traffic.look_up(0, 0, 4);
        }
        let is_marked = input.is_some_and(|n| n % 3 == 2);
        let step = Step::after(self.latency, input.filter(|_| !self.swallows));
        if is_marked { step.marked() } else { step }
    }
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(self.clients && client == 0)
    }
}

fn both(clients: bool, gaps: &[u64]) -> RunReport {
    run_both(Marker { clients, ..MARKER }, 7, gaps)
}

fn run_both(unit: Marker, tokens: u32, gaps: &[u64]) -> RunReport {
    let setting = TestEnvironment { depth: 16, latency: 1, source_gaps: gaps.to_vec(), ..TestEnvironment::default() };
    let clients: &[ClientKind] = if unit.clients { &[ClientKind::Cache { line_bytes: 64 }] } else { &[] };
    let [timed, ticked] = [Engine::Timed, Engine::Ticked]
        .map(|engine| run(&mut Bench::new(unit.clone(), (0..tokens).collect(), None, clients, &setting), engine));
    assert_eq!(timed, ticked);
    timed
}

// Claim: laws, 11 Marks: A mark is passed at delivery, and a run lasts until its last mark. Caches stay warm between marks.
#[test]
fn mark_is_passed_at_delivery() {
    // Steps at 1 .. 7, each delivered 2 later. Marked tokens 2 and 5: at 3 and 6, delivered 5 and 8. Token 6: at 7,
    // delivered 9, visible and popped 10: 11 cycles, 3 of them drain.
    let report = both(false, &[]);
    assert_eq!((report.marks.as_slice(), report.total), ([5, 3].as_slice(), 11));
}

// Claim: as mark_is_passed_at_delivery.
#[test]
fn run_lasts_until_its_last_mark() {
    // Nothing follows the delivery of the last step: token 2, at 3, with a latency of 50.
    let report = run_both(Marker { latency: 50, swallows: true, ..MARKER }, 3, &[]);
    assert_eq!((report.marks.as_slice(), report.total), ([53].as_slice(), 53));
    let report = run_both(Marker { latency: 50, swallows: true, clients: true }, 3, &[]);
    let ends: u64 = report.marks.iter().sum();
    assert_eq!((report.marks.len(), ends), (1, report.total));
}

#[test]
fn memory_wait_comes_before_mark() {
    // The first look-up misses: step at 1, in view 2, closed 3, data from 5 + 3 to 12, hit latency 2: 14. The other look-ups are
    // merged and answered with it. The marked tokens leave at 14. Tokens become visible one after the other, the seventh at 21.
    let report = both(true, &[]);
    assert_eq!((report.marks.as_slice(), report.total), ([14, 0].as_slice(), 22));
    assert_eq!(report.caches[0].counts.merged, 6);
}

// Claim: as mark_is_passed_at_delivery.
#[test]
fn caches_stay_warm_between_marks() {
    // One token every 40 cycles. The line is present for all tokens but the first, also after the marks.
    let report = both(true, &[39]);
    assert_eq!((report.caches[0].counts.misses, report.caches[0].counts.hits), (1, 6));
    // Steps at 1 + 40 n, hits delivered 2 later: 83 and 203.
    assert_eq!(report.marks, [83, 120]);
}
