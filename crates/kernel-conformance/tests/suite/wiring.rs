//! Wrong wiring is an error before the first step. A step that breaks a declaration is a fault. Both engines report it by name.
//! Without these checks the timed engine's proof would not hold, and the next stage would issue requests that belong to no
//! client.

use basrelief_kernel::{
    CacheConfig, Demand, Engine, Fifo, Machine, MemoryConfig, MemoryPorts, MemorySystem, Outcome, Stage, Step, Unit, Visitor,
    WiringError, check_wiring, run, run_functional,
};
use basrelief_kernel::{Sink, Source};

/// Forwards numbers. Issues the configured requests, and declares the configured largest step.
#[derive(Clone, Copy, Default)]
struct Talker {
    /// Client and number of reads.
    reads: Option<(u32, u32)>,
    /// Client and number of lines looked up.
    lines: Option<(u32, u64)>,
    largest: [u32; 4],
}

impl Unit for Talker {
    type In = Option<u64>;
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, token: Option<u64>, traffic: &mut MemoryPorts) -> Step<Option<u64>> {
        if let Some((client, reads)) = self.reads {
            (0..reads).for_each(|n| traffic.read(client, 64 * u64::from(n), 8));
        }
        if let Some((client, lines)) = self.lines {
            (0..lines).for_each(|n| traffic.look_up(client, 64 * n, 8));
        }
        Step::after(1, token)
    }
    fn largest_step(&self, client: usize) -> u32 {
        self.largest.get(client).copied().unwrap_or(0)
    }
}

/// Variants of the wiring.
#[derive(Clone, Copy, PartialEq)]
enum Drawn {
    Right,
    /// A second source into `numbers`.
    Source,
    /// A second sink at `talked`.
    Sink,
    NoSource,
    NoSink,
}

/// ```text
///   source --numbers--> talker --talked--> sink
///                         |                   second: a source or sink too many
///                 port, cache | memory
/// ```
struct LineMachine {
    source: Stage<Source<std::ops::Range<u64>>>,
    second_source: Stage<Source<std::ops::Range<u64>>>,
    numbers: Fifo<u64>,
    talker: Stage<Talker>,
    talked: Fifo<u64>,
    sink: Stage<Sink<u64>>,
    second_sink: Stage<Sink<u64>>,
    memories: MemorySystem,
    clients: Option<Vec<usize>>,
    /// Clients of a second talker, between `talked` and the sink.
    others: Option<(Stage<Talker>, Fifo<u64>, Vec<usize>)>,
    drawn: Drawn,
}

impl Machine for LineMachine {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let m = &mut self.memories;
        if self.drawn != Drawn::NoSource {
            v.stage(self.source.between((), &mut self.numbers));
        }
        if self.drawn == Drawn::Source {
            v.stage(self.second_source.between((), &mut self.numbers));
        }
        let talker = self.talker.between(&mut self.numbers, &mut self.talked);
        match &self.clients {
            Some(ids) => v.stage(talker.using(m, ids)),
            None => v.stage(talker),
        }
        let mut last = &mut self.talked;
        if let Some((other, fifo, ids)) = &mut self.others {
            v.stage(other.between(last, &mut *fifo).using(m, ids));
            last = fifo;
        }
        if self.drawn != Drawn::NoSink {
            v.stage(self.sink.between(&mut *last, ()));
        }
        if self.drawn == Drawn::Sink {
            v.stage(self.second_sink.between(last, ()));
        }
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Makes a machine in which client 0 is a port and client 1 has a cache, with 4 credits each.
fn line(talker: Talker, clients: Option<&[usize]>) -> LineMachine {
    let mut memories = MemorySystem::default();
    let memory = memories.add_memory("store", &MemoryConfig::default());
    memories.add_client("port", memory, 4);
    memories.add_cached_client("lines", memory, 4, "cache", &CacheConfig::default());
    LineMachine {
        source: Stage::new("source", Source::new(0..3)),
        second_source: Stage::new("second source", Source::new(0..3)),
        numbers: Fifo::new("numbers", 2, 1),
        talker: Stage::new("talker", talker),
        talked: Fifo::new("talked", 2, 1),
        sink: Stage::new("sink", Sink::new()),
        second_sink: Stage::new("second sink", Sink::new()),
        memories,
        clients: clients.map(<[usize]>::to_vec),
        others: None,
        drawn: Drawn::Right,
    }
}

fn drawn(drawn: Drawn) -> LineMachine {
    LineMachine { drawn, ..line(Talker::default(), None) }
}

/// Returns the wiring error, which must be the same with both engines and in the functional model.
fn error(machine: impl Fn() -> LineMachine) -> WiringError {
    let error = check_wiring(&mut machine()).unwrap_err();
    for engine in [Engine::Timed, Engine::Ticked] {
        assert_eq!(run(&mut machine(), engine).outcome, Outcome::Fault(error.to_string()));
    }
    assert_eq!(run_functional(&mut machine(), &mut |_| true), Err(error.to_string()));
    error
}

#[test]
fn valid_wiring_runs() {
    let talker = Talker { reads: Some((0, 4)), lines: Some((1, 4)), largest: [4, 4, 0, 0] };
    for engine in [Engine::Timed, Engine::Ticked] {
        assert_eq!(run(&mut line(talker, Some(&[0, 1])), engine).outcome, Outcome::Complete);
        assert_eq!(run(&mut line(Talker::default(), None), engine).outcome, Outcome::Complete);
    }
}

#[test]
fn fifo_has_one_producer_and_one_consumer() {
    let two = error(|| drawn(Drawn::Source)).to_string();
    assert_eq!(two, "FIFO `numbers` is filled by `source` and by `second source`; give each a FIFO of its own");
    let two = error(|| drawn(Drawn::Sink)).to_string();
    assert_eq!(two, "FIFO `talked` is emptied by `sink` and by `second sink`; give each a FIFO of its own");
    let none = error(|| drawn(Drawn::NoSource)).to_string();
    assert_eq!(none, "no unit fills FIFO `numbers`, from which `talker` pops");
    let none = error(|| drawn(Drawn::NoSink)).to_string();
    assert_eq!(none, "no unit pops from FIFO `talked`, which `talker` fills");
}

#[test]
fn memory_client_exists_and_belongs_to_one_stage() {
    let reads = Talker { largest: [1, 0, 0, 0], ..Talker::default() };
    let shared = error(|| {
        let other = (Stage::new("other", reads), Fifo::new("out", 1, 1), vec![0]);
        LineMachine { others: Some(other), ..line(reads, Some(&[0])) }
    });
    assert_eq!(shared.to_string(), "memory port `port` is used by `talker` and by `other`; add a client for each");
    let twice = error(|| line(Talker::default(), Some(&[1, 1])));
    assert_eq!(twice.to_string(), "memory port `lines` is used by `talker` and by `talker`; add a client for each");
    let unknown = error(|| line(Talker::default(), Some(&[2])));
    assert_eq!(unknown, WiringError::NoSuchClient { unit: "talker".into(), client: 2, count: 2 });
    let many = error(|| line(Talker::default(), Some(&[0, 1, 0, 1, 0])));
    assert_eq!(many, WiringError::TooMany { unit: "talker".into(), what: "memory clients", count: 5, most: 4 });
}

#[test]
fn used_clients_are_wired() {
    let missing = |client, wired| WiringError::MissingClient { unit: "talker".into(), client, wired };
    let one = Talker { largest: [1, 0, 0, 0], ..Talker::default() };
    assert_eq!(error(|| line(one, None)), missing(0, 0));
    let two = Talker { largest: [1, 1, 0, 0], ..Talker::default() };
    assert_eq!(error(|| line(two, Some(&[0]))), missing(1, 1));
}

#[test]
fn largest_step_has_enough_credits() {
    let talker = Talker { largest: [4, 5, 0, 0], ..Talker::default() };
    let few = error(|| line(talker, Some(&[0, 1])));
    let (unit, memory, port) = ("talker".into(), "store".into(), "lines".into());
    assert_eq!(few, WiringError::TooFewCredits { unit, memory, port, needed: 5, outstanding: 4 });
}

/// Returns the fault of a step.
fn fault(talker: Talker, clients: Option<&[usize]>) -> String {
    crate::common::fault(|| line(talker, clients))
}

#[test]
fn request_to_missing_client_is_a_fault() {
    let reads = Talker { reads: Some((0, 1)), ..Talker::default() };
    assert_eq!(fault(reads, None), "talker, cycle 1: a step uses memory client 0, but the wiring gives it 0");
    let looks_up = Talker { lines: Some((0, 1)), ..Talker::default() };
    assert_eq!(fault(looks_up, None), "talker, cycle 1: a step uses memory client 0, but the wiring gives it 0");
    let reads = Talker { reads: Some((2, 1)), ..Talker::default() };
    assert_eq!(fault(reads, Some(&[0, 1])), "talker, cycle 1: a step uses memory client 2, but the wiring gives it 2");
    let looks_up = Talker { lines: Some((2, 1)), ..Talker::default() };
    assert_eq!(fault(looks_up, Some(&[0, 1])), "talker, cycle 1: a step uses memory client 2, but the wiring gives it 2");
}

#[test]
fn look_up_without_cache_is_a_fault() {
    let talker = Talker { lines: Some((0, 1)), largest: [1, 1, 0, 0], ..Talker::default() };
    assert_eq!(fault(talker, Some(&[0, 1])), "talker, cycle 1: a step looks up a line in memory client 0, which has no cache");
}

#[test]
fn step_beyond_largest_is_a_fault() {
    let beyond = |client| {
        format!("talker, cycle 1: a step needs 3 credits of memory client {client}, but largest_step({client}) declares 2")
    };
    let talker = Talker { largest: [2, 2, 0, 0], ..Talker::default() };
    assert_eq!(fault(Talker { reads: Some((0, 3)), ..talker }, Some(&[0, 1])), beyond(0));
    assert_eq!(fault(Talker { lines: Some((1, 3)), ..talker }, Some(&[0, 1])), beyond(1));
    // Lines and requests of one client share its credits.
    assert_eq!(fault(Talker { reads: Some((1, 1)), lines: Some((1, 2)), ..talker }, Some(&[0, 1])), beyond(1));
}
