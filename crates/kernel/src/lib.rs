//! Time, FIFOs, memories, engines and cycle accounting; knows no graphics.
//!
//! > A unit says what it does to a token and how long it is busy. The kernel says when. The machine's [`wire`] function
//! > is the block diagram.
//!
//! This page is the specification. It defines the words, then gives the laws of time, each with the place that enforces
//! it and the test that proves it, then what the laws leave open.
//!
//! # Words
//!
//! - **Cycle**: time is counted in [cycles](Cycle) from 0. An interval is half-open: from its first cycle to the one
//!   after its last.
//! - **Token**: what travels on a wire, a value of whatever type the machine chooses. Wider hardware is a wider token.
//! - **Unit**: a [block of hardware](Unit): state, and one `step`. In its place in a machine, with its times, it is a
//!   [`Stage`].
//! - **Step**: what a unit does at once: it pops tokens of some inputs and emits [0 or 1 token per output](Step). It
//!   *starts* in a cycle s, keeps the unit for its **occupancy** >= 1 (the next step may start at s + occupancy) and
//!   *delivers* at s + its **latency** >= 0, or with the last memory answer it waits for. A pipelined unit has occupancy
//!   1 and any latency.
//! - **FIFO**: a [bounded queue](Fifo) between two units, of *depth* slots. A token delivered at d is **visible** to the
//!   consumer f >= 1 cycles later, f being the FIFO's latency, and popped by the step that takes it.
//! - **Slot**: a place for a token, held from the start of the step that fills it (**reserved**) through the cycle of the
//!   pop. Its *oldest holder* is the token whose pop will free it.
//! - **Demand**: which inputs the next step takes, [declared](Unit::demand) by the unit from its own state alone.
//! - **Client**: a unit's access to memory: a **port** of a memory, with or without a cache in front of it. A unit numbers
//!   its clients from 0; [`MemorySystem`] numbers the ports of each memory in the order in which they are added.
//! - **Request**: a read or a posted write of some bytes; it *arrives* at the start of its step. A **look-up** asks a
//!   cache for a line. Both are made through [`MemoryPorts`].
//! - **Credit**: the right to one more request in flight on a port; there are `outstanding` of them, and each is back in
//!   the cycle of the answer.
//! - **Burst**: the unit of transfer, [`MemoryConfig::burst_bytes`] aligned bytes, served by one **column command** of its
//!   **channel**. It finds its bank's row open (*hit*), its bank closed, or another row open (*conflict*).
//! - **Starved, memory, blocked**: why a unit does not work: no token, no credit or answer, no slot. See [`Cause`].
//! - **Place**: a stage with the [FIFOs on its two sides and its clients](Stage::between), as a [visitor](Visitor) is shown it.
//! - **Mark**: a [marked step](Step::marked) ends a piece of work; cycles are counted from mark to mark.
//! - **Engine**: who makes the steps: [`Engine::Ticked`], [`Engine::Timed`] or the
//!   [functional model](run_functional).
//!
//! # A machine in thirty lines
//!
//! ```text
//!   source --numbers--> square --squares--> sink
//! ```
//!
//! ```
//! use basrelief_kernel::{Sink, Source};
//! use basrelief_kernel::{Demand, Engine, Fifo, Machine, MemorySystem, Outcome};
//! use basrelief_kernel::{Stage, Step, MemoryPorts, Unit, Visitor, run};
//!
//! /// Squares a number in 3 cycles, one number at a time.
//! struct Square;
//!
//! impl Unit for Square {
//!     type In = Option<u64>;
//!     type Out = Option<u64>;
//!     fn demand(&self) -> Demand {
//!         Demand::All
//!     }
//!     fn step(&mut self, number: Option<u64>, _: &mut MemoryPorts) -> Step<Option<u64>> {
//!         Step::after(2, number.map(|n| n * n)).busy(3)
//!     }
//! }
//!
//! struct Squares {
//!     source: Stage<Source<std::ops::Range<u64>>>,
//!     numbers: Fifo<u64>,
//!     square: Stage<Square>,
//!     squares: Fifo<u64>,
//!     sink: Stage<Sink<u64>>,
//!     memories: MemorySystem,
//! }
//!
//! impl Machine for Squares {
//!     fn wire<V: Visitor>(&mut self, v: &mut V) {
//!         v.stage(self.source.between((), &mut self.numbers));
//!         v.stage(self.square.between(&mut self.numbers, &mut self.squares));
//!         v.stage(self.sink.between(&mut self.squares, ()));
//!     }
//!     fn memories(&mut self) -> &mut MemorySystem {
//!         &mut self.memories
//!     }
//! }
//!
//! let mut machine = Squares {
//!     source: Stage::new("source", Source::new(0..4)),
//!     numbers: Fifo::new("numbers", 1, 1),
//!     square: Stage::new("square", Square),
//!     squares: Fifo::new("squares", 2, 1),
//!     sink: Stage::new("sink", Sink::new()),
//!     memories: MemorySystem::default(),
//! };
//! let report = run(&mut machine, Engine::Timed);
//! assert_eq!(report.outcome, Outcome::Complete);
//! assert_eq!(machine.sink.unit.tokens(), [0, 1, 4, 9]);
//! // Squares start at 1, 4, 7, 10; the last is visible, and popped, at 10 + 2 + 1: 14 cycles.
//! assert_eq!(report.total, 14);
//! let square = &report.units[1].account;
//! assert_eq!((square.busy, square.starved[0], square.done), (12, 1, 1));
//! ```
//!
//! To run more: `examples/pipeline.rs`, `examples/shared_memory.rs` and `examples/visitor.rs`, each under 80 lines.
//!
//! # The laws of time
//!
//! Units are joined by bounded FIFOs. Time is counted in cycles from 0. A *step* of a unit starts at cycle s, keeps the unit
//! for `occupancy` >= 1 cycles (s .. s+occupancy-1) and delivers at s + `latency` (>= 0); both may depend on the token. The
//! laws of time are stated once, enforced at construction, and proved by tests: two people who implement them apart must get
//! the same cycle counts.
//!
//! 1. **FIFO.** Its depth and its latency f are at least 1. A token delivered at d is visible from
//!    max(d + f, visible time of the token before it + 1). Tokens never overtake.
//!
//!    *Enforced by [`Fifo::new`] and `FifoTiming::deliver`; test `laws/law_1_fifo`.*
//! 2. **Slots.** A slot is *reserved at the start* of the step that fills it: what is in flight holds slots, as under credit
//!    flow control. It is free again the cycle after the pop. So full rate needs
//!    depth >= ceil((latency + f + 1) / occupancy), or the loaded memory latency. Defaults are computed so; a config below it
//!    is a warning that names the rate it allows.
//!
//!    *Enforced by `FifoTiming::room_at`; test `laws/law_2_slots`.*
//! 3. **Start.** A unit declares, from its own state alone, which inputs its next step takes: none, some, or all. The step
//!    starts at the first cycle at which the unit is free, every declared input has a visible token, *every* output has a slot
//!    (also when the step turns out to emit nothing there), and every memory port it uses has credits for its largest step.
//!    It pops exactly the declared inputs and emits 0 or 1 token per output; where it emits none it reserves no slot. Wider
//!    hardware is a wider token. No choice depends on which token came first; what must, such as an arbiter, is a memory or a
//!    kernel unit.
//!
//!    *Enforced by `MachineTiming::next_start`, from [`Unit::demand`] and [`Unit::largest_step`], whose word is held by [`check_wiring`] and in
//!    every step; tests `laws/law_3_start`, `wiring`.*
//! 4. **Memory.** All requests of a step arrive at its start, and are split into aligned bursts, ascending. A memory has
//!    `channels`, which share nothing: a burst at byte address a belongs to channel (a div `channel_bytes`) mod `channels`. In a
//!    channel, bursts stand in order of (arrival, port number, order of issue, address); port numbers belong to the memory's
//!    configuration, so the order of wires cannot matter. The first `window` of those not served are *in view*: a burst comes into
//!    view in the cycle after its arrival, and not before the cycle after the column command that made the room.
//!
//!    *First ready, first come*: of the bursts in view, the one whose column command can go first is served next, the oldest of
//!    equals. Once the oldest has been passed over `cap` times since it became the oldest, it is next. A `window` of 1 is order of
//!    arrival.
//!
//!    A column command goes when its burst is in view; `burst_cycles` after the channel's last one or, after a change of direction,
//!    `cwl` + `burst_cycles` + `wtr` (write to read) or max(`burst_cycles`, `cl` + `burst_cycles` + 1 - `cwl`) (read to write);
//!    and when its row has been open for `rcd`. Row commands go as early as the bank allows and the burst is in view, also while
//!    others move data: a closed bank is activated; a bank with another row is precharged - from `ras` after its activation,
//!    `rtp` after its last read command, `cwl` + `burst_cycles` + `wr` after its last write command - and activated `rp` later.
//!    Activations of a channel, in order of service, are `rrd` apart, and four of them take `faw`. Every `refi` cycles (0: never) all
//!    rows close, and no activation goes for `rfc`; an activation whose column command would reach the next refresh is made
//!    after it. Data move for `burst_cycles`, from `cl` (read) or `cwl` (write) after the column command: a bank is *not* busy until its
//!    data have moved, row hits follow each other at the rate of the bus, and `cl` is latency, which credits hide.
//!
//!    An answer is there when the last data of all its bursts have moved, not before the answer ahead of it on that port. Writes
//!    are posted. Reads and writes hold one of the port's `outstanding` credits, back in the cycle of the answer.
//!
//!    *Enforced by [`MemorySystem`]; test `laws/law_4_memory`, and against DRAMsim3's figures `dramsim3`.*
//! 5. **Cache.** A cache port makes one look-up per cycle. A step's look-ups are its n distinct lines in order of first mention,
//!    all made at its start, and its occupancy is >= ceil(n / ports). Tags change in order of look-up at the step's start;
//!    the least recently used goes first. They run ahead of the data (Igehy 1998), so a line in flight may be replaced, while
//!    fills and uses stay in order. A miss makes one line request that arrives at the memory in the same cycle; the look-up is
//!    answered at its answer + hit latency. A look-up of a line in flight is `merged`: it makes no request, and waits for that
//!    fill. Answers come in order: a hit behind a miss waits. hits + misses + merged = look-ups.
//!
//!    *Enforced by [`MemorySystem::add_cached_client`]'s caches; counted in [`CacheCounts`]; test `laws/law_5_cache`.*
//! 6. **Contents.** Memories give time, never data. Every bit of state belongs to exactly one unit; what another needs travels
//!    in tokens. Results may not depend on the cycle: `step` is not given one, only its port handle is. Hence the functional
//!    model is the same steps with a handle that answers at once, and running ahead is safe. What is tested and then updated
//!    is tested *and* updated by the unit that owns it, in order of its tokens.
//!
//!    *Enforced by the signature of [`Unit::step`] and by [`MemoryPorts`], which tells nothing; test `laws/law_6_contents`, and of every unit the [contract].*
//! 7. **Control in band.** Beginnings and ends of work, changes of tables, of parameters and of phase are tokens in the same
//!    FIFOs and take effect when popped. A unit that gathers (a table, a batch, a phase) flushes on the end token; what it
//!    holds is a memory of its own with a size, and exceeding it is an error at load, not a deadlock. Feedback is an ordinary
//!    FIFO that can hold all tokens of its loop.
//!
//!    *There is no other way in: [`Inputs`] are FIFOs. [`Unit::is_empty`] and [`MemoryPorts::fault`] are for those that gather; test `laws/law_7_control_in_band`.*
//! 8. **End.** The run ends when every unit's next start is unknown - never after N idle cycles (idle stretches can last millions). Complete: sources exhausted, FIFOs empty, no unit holds
//!    tokens; else deadlock: both engines, same text, exit 1. Total = 1 + the last cycle in which a unit was busy, a token became visible, or a memory moved data.
//!
//!    *Enforced by [`run`]; [`Outcome`] and [`RunReport::total`] say it; test `laws/law_8_end`.*
//! 9. **Accounting** of a unit over 0 .. total-1, cycle by cycle, the first that applies: *busy*; *done* (after the last step it makes in a complete run; in a deadlock units keep the cause that holds them); *starved{first declared input without a visible token}*; *memory{port}*
//!    (fewer credits than its largest step, or the oldest slot holder of the first full output is before its step's last answer - hits and hit latency count, posted writes never); *blocked{first output without a slot}*. They sum to total.
//!
//!    *Kept in [`Account`], by [`Cause`]; test `laws/law_9_accounting`.*
//! 10. **Occupancy** of a FIFO in a cycle = slots reserved or filled, reservation through pop. `histogram[k]`, k = 0..depth, sums to total. (In `timed`: pushes and pops of one FIFO are each monotone, so
//!     events up to min(last push, last pop) are settled: O(1) per event, exact.)
//!
//!     *Kept in [`FifoReport::histogram`]; test `laws/law_10_occupancy`.*
//! 11. **Marks.** A marked step ends a piece of work: mark k is passed at end(k), the cycle in which that step delivers.
//!     marks\[k\] = end(k) - end(k-1); the rest is `drain`; the sum is total. TagLookup, open rows and tables stay warm from mark
//!     to mark.
//!
//!     *Marked by [`Step::marked`], kept in [`RunReport::marks`]; test `laws/law_11_marks`.*
//!
//! Hence the order in which units are visited cannot change any result. Tests are under `tests/`; `hand` computes four
//! whole machines by hand, `vectors` holds both engines against 320 results of a reading of these laws that shares no code
//! with them, and `properties` tries them on random machines.
//!
//! # What the laws leave open
//!
//! - **Addresses.** The burst at byte address a has in its channel the address
//!   x = (a div (`channel_bytes` * `channels`)) * `channel_bytes` + a mod `channel_bytes`. Row number = x div `row_bytes`;
//!   bank = row number mod `banks`; row within the bank = row number div `banks`. At first all banks are closed, and no command has
//!   been given.
//! - **Refresh.** It waits for nothing, and leaves `rrd` and `faw` as they are. Law 4 needs `rfc` + `rcd` < `refi`.
//! - **Answers.** The end of a request's bursts, in the sense of law 4, is the cycle after the last data of any. A credit is
//!   back, and may be used, in the very cycle of the answer.
//! - **Delivery.** A step delivers at max(start + latency, its answers): those of its reads and of its look-ups. Writes are
//!   no answers. Steps of one unit deliver in order: law 1 never lets a token overtake.
//! - **Ports of one step.** A step's requests are issued in order; requests of different memories do not wait for each
//!   other. What a step needs of a port is counted in requests, of a cached port in distinct lines, hits included.
//! - **Look-ups.** At start s, of a line in the tags: *merged* if its memory answer is later than s, otherwise a *hit*. A
//!   line replaced before its fill is absent: a new miss. Hits, merged look-ups and misses all count as use. The occupancy
//!   of a step is max(its own, ceil(distinct lines / `lookups_per_cycle`)). Its last look-up's answer, hit latency
//!   included, is what law 9 has it wait for.
//! - **Order of causes.** Inputs in the order of the wiring, then clients, then outputs; where an output is full and its
//!   oldest holder awaits several clients, first those whose memory, then whose port number, comes first.
//! - **Done.** Counts from the end of a unit's last step in a complete run; a unit that never made a step keeps its cause,
//!   unless it has [finished](Demand::Finished). In a deadlock only those that have finished are done.
//! - **Complete.** No token in a FIFO, every unit [empty](Unit::is_empty), and none that would still make a step without
//!   input.
//! - **Limit.** With [`Limits::max_cycles`] no step starts in that cycle or later. If some step would have, the run ends
//!   there as [`Outcome::Limit`]; if none would, it ends as it would have anyway, a little later.
//! - **Fault.** A unit that cannot go on ends the run at once. The cycle named is that of its step; what else happened by
//!   then differs between engines, since `timed` runs ahead.
//!
//! [`wire`]: Machine::wire

mod account;
mod bound_stage;
mod cache;
mod cached;
mod capacity;
mod channel;
mod check;
mod client;
mod config;
mod connections;
mod counts;
mod critical_path;
mod cycle;
mod diagram;
mod divisor;
mod endpoints;
mod engine;
mod fifo;
mod fifo_info;
mod hardware;
mod label;
mod machine;
mod memory;
mod memory_events;
pub mod memory_ports;
mod memory_system;
mod netlist;
mod operators;
mod outcome;
pub mod parts;
#[cfg(not(feature = "config"))]
mod plain_parameters;
mod port;
mod probe;
pub mod recording;
mod report;
mod request;
mod stage;
pub mod stats;
mod step_requests;
mod time;
mod topology;
pub mod unit;
mod unit_info;
mod wires;

pub use account::{Account, Cause};
pub use bound_stage::{BoundStage, ConnectedStage, ConnectionsOf};
pub use cached::Cached;
pub use capacity::{MAX_CLIENTS, MAX_LINKS};
pub use check::{WiringError, check_wiring};
pub use config::{CacheConfig, FifoConfig, MemoryConfig};
pub use connections::{Clients, Connections, MemoryClients};
pub use counts::{BusActivity, CacheCounts, ChannelCounts, Latencies, PortCounts, RowCounts};
pub use critical_path::{CriticalPath, PathPart, PathSegment, RequestPhase, StageGroups};
pub use cycle::Cycle;
pub use diagram::{ClientTopology, Diagram, FifoTopology, MemoryTopology, StageTopology};
pub use endpoints::{Sink, Source};
pub use engine::{
    ChunkSource, Engine, Limits, Recording, ResimulateError, StepBatch, critical_path, make_steps, resimulate, run,
    run_functional, run_recorded, run_with, time_steps,
};
pub use fifo::Fifo;
pub use fifo_info::FifoInfo;
pub use hardware::{Hardware, HardwareKind};
pub use label::Label;
pub use machine::{Machine, Visitor};
pub use memory::MemoryRequest;
pub use memory_events::MemoryEvent;
pub use memory_ports::MemoryPorts;
pub use memory_system::MemorySystem;
pub use netlist::Netlist;
pub use operators::{OperatorConfig, OperatorCounts, Operators};
pub use outcome::{BlockedUnit, Deadlock, FifoLevel, Outcome, WaitsFor};
pub use parts::MemoryPart;
pub use probe::{Interval, NoProbe, Probe, Recorder};
pub use report::{CacheReport, FifoReport, MemoryReport, PortReport, RunReport, UnitReport};
pub use request::Request;
pub use stage::Stage;
pub use topology::topology;
pub use unit::{Demand, Step, Unit};
pub use unit_info::UnitInfo;
pub use wires::{Inputs, Outputs, Wires};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
