//! Cycle-level simulation kernel: time, FIFOs, memories, engines and cycle accounting. It knows no graphics.
//!
//! > A unit states its effect on a token and how long it is busy. The kernel computes when. The machine's [`wire`] function
//! > is the block diagram.
//!
//! This page is the specification. It defines the terms, then states the laws of time, each with the code that enforces it and
//! the test that proves it. The last section settles the details that the laws leave open.
//!
//! # Terms
//!
//! - **Cycle**: the unit of time, counted from 0 ([`Cycle`]). An interval is half-open: from its first cycle to the cycle after
//!   its last.
//! - **Token**: one entry of a FIFO, a value of any type. Wider hardware has wider tokens.
//! - **Unit**: a [block of hardware](Unit): state, and one function `step`. A unit in its place in a machine, with its name, is a
//!   [`Stage`].
//! - **Step**: the smallest piece of work of a unit. A step pops tokens from some inputs and emits [0 or 1 token per
//!   output](Step). It *starts* in a cycle s and occupies the unit for its **occupancy** >= 1, so the next step may start at
//!   s + occupancy. It *delivers* at s + its **latency** >= 0, or later if it waits for memory answers. A fully pipelined
//!   unit has occupancy 1 (initiation interval 1) and any latency.
//! - **Work after data**: the [part of the latency](Step::after_data) that needs a memory answer, for example the filter behind a data
//!   fetch. A **blocking** step [keeps its unit](Step::blocking) until its last answer, for example the load of a table.
//! - **FIFO**: a [bounded queue](Fifo) between two units, with a *depth* in slots. A token delivered at d is **visible** to the
//!   consumer at d + f, where f >= 1 is the FIFO's latency. The step that takes the token pops it. Tokens of a [periodic
//!   FIFO](Fifo::with_period) become visible only in multiples of its **period**.
//! - **Slot**: room for one token in a FIFO. The step that fills a slot **reserves** it at its start. The slot stays in use through
//!   the cycle of the pop. The *oldest holder* of a full FIFO is the token whose pop will free the next slot.
//! - **Demand**: the inputs from which the next step takes tokens, [declared](Unit::demand) by the unit from its own state.
//! - **Client**: a unit's access path to a memory: a **port** of a memory, with or without a cache in front. A unit numbers its
//!   clients from 0. [`MemorySystem`] numbers the ports of each memory in the order of their addition.
//! - **Request**: a read or a posted write of some bytes. It *arrives* at the start of its step, or later under the **issue rate** of
//!   its port. A **look-up** requests a line from a cache. A step issues both through [`MemoryPorts`].
//! - **Periodic client**: a client that belongs to no unit and [reads at fixed times](PeriodicReads), for example the scan-out of a
//!   display.
//! - **Credit**: the right to one more request in flight on a port. A port has `outstanding` credits. A credit returns in the cycle of
//!   the answer.
//! - **Burst**: the unit of transfer, [`MemoryConfig::burst_bytes`] aligned bytes, served by one **column command** of its
//!   **channel**. A burst finds its row open (*hit*), its bank closed, or another row open (*conflict*).
//! - **Starved, memory, blocked**: the causes of a stall: no token, no credit or answer, no slot. See [`StallCause`].
//! - **Bound stage**: a stage with its input FIFOs, output FIFOs and [memory clients](Stage::between). A [visitor](Visitor) sees
//!   stages in this form.
//! - **Mark**: a [marked step](Step::marked) ends a piece of work. Cycles are counted from mark to mark.
//! - **Engine**: the algorithm that executes the steps: [`Engine::Ticked`], [`Engine::Timed`] or the
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
//! More examples: `examples/pipeline.rs`, `examples/shared_memory.rs` and `examples/visitor.rs`, each under 80 lines.
//!
//! # The laws of time
//!
//! Bounded FIFOs connect the units. Time is counted in cycles from 0. A *step* of a unit starts at cycle s, occupies the unit for
//! `occupancy` >= 1 cycles (s .. s+occupancy-1) and delivers at s + `latency` (>= 0). Both numbers may depend on the token. The
//! laws of time are stated once, enforced at construction, and proved by tests. Two people who implement them independently must
//! get the same cycle counts.
//!
//! 1. **FIFO.** The depth and the latency f of a FIFO are at least 1. A token delivered at d is visible from
//!    max(d + f, visible time of the token before it + 1). In a FIFO with a period, it is visible from the smallest multiple of the
//!    period that is not before this cycle. A period changes time, never content. Tokens never overtake each other.
//!
//!    *Enforced by [`Fifo::new`] and `FifoTiming::deliver`; test `laws/law_1_fifo`.*
//! 2. **Slots.** A step reserves the slot that it fills *at its start*. Tokens in flight therefore hold slots, as under credit flow
//!    control. A slot is free again in the cycle after the pop. Full throughput therefore needs
//!    depth >= ceil((latency + f + 1) / occupancy), or enough slots for the loaded memory latency. Default depths follow this rule.
//!    A configuration with fewer slots gets a warning with the rate that it allows.
//!
//!    *Enforced by `FifoTiming::room_at`; test `laws/law_2_slots`.*
//! 3. **Start.** A unit declares, from its own state alone, the inputs of its next step: none, one, or all. The step starts at the
//!    first cycle in which all of these hold: the unit is free; every declared input has a visible token; *every* output has a free slot,
//!    even if the step then emits nothing there; and every memory port of the unit has credits for its largest step. The step pops
//!    exactly the declared inputs. It emits 0 or 1 token per output, and reserves no slot on an output without a token. Wider hardware
//!    has wider tokens. No choice depends on the arrival order of tokens of different FIFOs. A function that needs arrival order, such as
//!    an arbiter, is a memory or a kernel unit.
//!
//!    A step delivers at max(s + `latency`, a + `after_data`) for each memory answer a that it awaits. `after_data` >= 0 is the work that
//!    needs the data. A *blocking* step keeps its unit until the last of its answers. So the unit is free from
//!    max(s + `occupancy`, last answer) on.
//!
//!    *Enforced by `MachineTiming::next_start`, from [`Unit::demand`] and [`Unit::largest_step`]. [`check_wiring`] and every step check
//!    these declarations. Tests `laws/law_3_start`, `wiring`.*
//! 4. **Memory.** A port issues `issue` requests per cycle (0: all at once). Request n of a step on a port arrives in cycle
//!    s + n div `issue`, and the occupancy of the step is at least ceil(n / `issue`) for n requests. Credits for all of them are taken at the
//!    start. Requests are split into aligned bursts in ascending order. A memory has
//!    `channels` that share nothing: a burst at byte address a belongs to channel (a div `channel_bytes`) mod `channels`. The bursts of a
//!    channel form a queue in order of (arrival, port number, order of issue, address). Port numbers belong to the memory's
//!    configuration, so the order of the wiring cannot matter. The first `window` unserved bursts are *in view*. A burst comes into view in
//!    the cycle after its arrival, and not before the cycle after the column command that made room for it.
//!
//!    *First ready, first come*: the next burst is the one in view whose column command can be issued first; the oldest wins a tie. If the
//!    oldest burst has been passed over `cap` times since it became the oldest, it is next. With a `window` of 1 bursts are served in
//!    order of arrival.
//!
//!    A column command is issued when three conditions hold. Its burst is in view. Its row has been open for `rcd`. The bus allows it:
//!    `burst_cycles` after the channel's last column command in the same direction, `cwl` + `burst_cycles` + `wtr` after a write if it
//!    reads, and max(`burst_cycles`, `cl` + `burst_cycles` + 1 - `cwl`) after a read if it writes. Row commands are issued as early as the
//!    bank allows and the burst is in view, even while the bus moves data of others. A closed bank is activated. A bank with another open
//!    row is precharged, and activated `rp` later. A precharge is issued no earlier than `ras` after the activation, `rtp` after the last
//!    read command, and `cwl` + `burst_cycles` + `wr` after the last write command. Activations of a channel, in order of service, are
//!    `rrd` apart, and any four take `faw`. Every `refi` cycles (0: never) all rows close, and no activation is issued for `rfc`. An
//!    activation whose column command would reach the next refresh is issued after that refresh. Data move for `burst_cycles`, from `cl`
//!    (read) or `cwl` (write) after the column command. A bank does *not* stay busy until its data have moved: row hits follow each other at the
//!    rate of the bus, and `cl` is latency, which credits hide.
//!
//!    A *command bus* carries at most `commands_per_cycle` precharges, activations and column commands of a channel per cycle (0: any
//!    number). With a limit, `rcd` and `rp` count as at least 1. A row command takes the first cycle in which the bursts served before
//!    left room, and a precharge precedes its activation by exactly `rp`. No row command is issued in or before the cycle of the column
//!    command that was `window` bursts ago.
//!
//!    An answer arrives when the last data of all its bursts have moved, and not before the previous answer on that port. Writes are
//!    posted. Reads and writes each hold one of the port's `outstanding` credits, which returns in the cycle of the answer.
//!
//!    A memory may have *periodic clients*, which belong to no unit. Request k of such a client is a read that arrives in cycle
//!    k * `period`, at its base + (k * `stride`) mod `span`. It holds no credit. Periodic clients have the last port numbers of their
//!    memory. A unit changes the base by a *flip*, a request without data on a port of the same memory. A flip to address A that arrives
//!    in cycle c takes effect in cycle e, the smallest multiple of its `period` that is not before max(c, effect of the flip before +
//!    max(`hold`, 1)). Requests of the periodic client that arrive at e or later have base A. With a `hold` > 0 they stop at e + `hold`,
//!    and there are none before the first flip. The answer of the flip comes at max(e + `hold`, c + 1 + min(`cl`, `cwl`) +
//!    `burst_cycles`), and not before the answer ahead of it. So a unit waits for a shown buffer as it waits for any credit. Another unit may
//!    *wait* on a port of its own: such a request moves no data, changes nothing, and is answered as a flip of its cycle would be, with the
//!    e and the `hold` of the last flip before it.
//!
//!    *Enforced by [`MemorySystem`]; test `laws/law_4_memory`, and `dramsim3` against DRAMsim3's figures.*
//! 5. **Cache.** The look-ups of a step are its n distinct lines in order of first mention. Its occupancy is at
//!    least ceil(n / `lookups_per_cycle`). Look-up n is made in cycle s + n div `lookups_per_cycle` if the cache
//!    [spreads look-ups](MemorySystem::spread_look_ups), and at the start s otherwise. Tags change in order of look-up; the least
//!    recently used line is replaced. Tags run ahead of the data (Igehy 1998), so a line in flight may be replaced, while fills and uses
//!    stay in order. A miss makes one line request, which arrives at the memory in the cycle of the look-up. The look-up is answered at the
//!    request's answer + hit latency. A look-up of a line in flight is `merged`: it makes no request and waits for that fill. Answers
//!    come in order: a hit behind a miss waits. hits + misses + merged = look-ups.
//!
//!    *Enforced by the caches of [`MemorySystem::add_cached_client`], counted in [`CacheCounts`]; test `laws/law_5_cache`.*
//! 6. **Contents.** Memories give time, never data. Every bit of state belongs to exactly one unit. Data for another unit travel in
//!    tokens. Results may not depend on the cycle: `step` receives no cycle, only its port handle does. Therefore the functional model
//!    executes the same steps with a handle that answers at once, and lookahead is safe. State that is tested and then updated is
//!    tested *and* updated by the unit that owns it, in order of its tokens.
//!
//!    *Enforced by the signature of [`Unit::step`] and by [`MemoryPorts`], which returns nothing; test `laws/law_6_contents`, and for
//!    every unit the unit contract of `basrelief-kernel-conformance`.*
//! 7. **Control in band.** The beginning and end of work and changes of tables, parameters and phases are tokens in the same
//!    FIFOs. They take effect when popped. A unit that gathers tokens (a table, a batch, a phase) flushes on the end token. Its storage is a
//!    memory of its own with a size, and exceeding the size is an error at load, not a deadlock. Feedback is an ordinary
//!    FIFO that can hold all tokens of its loop.
//!
//!    *Enforced by [`Inputs`], the only way into a unit, which are FIFOs. Units that gather use [`Unit::is_empty`] and
//!    [`MemoryPorts::fault`]; test `laws/law_7_control_in_band`.*
//! 8. **End.** The run ends when the next start of every unit is unknown, and never after N idle cycles, because an idle stretch can last
//!    millions. The run is complete if sources are exhausted, FIFOs are empty and no unit holds tokens. Otherwise it is a deadlock, for which
//!    both engines print the same text and the exit code is 1. Total = 1 + the last cycle in which a unit was busy, a token became
//!    visible, or a memory moved data for a unit; at least the end of the last mark (law 11). A periodic client keeps no run alive. Its
//!    requests count if they arrive before the total, and its bursts count if their column command is before the total.
//!
//!    *Enforced by [`run`], returned as [`Outcome`] and [`RunReport::total`]; test `laws/law_8_end`.*
//! 9. **Accounting.** Each cycle of a unit in 0 .. total-1 has the first cause of this list that applies. *busy*. *memory{port}* for the
//!    cycles between the occupancy of a blocking step and its last answer: the first port, in order of first mention, whose answers have not
//!    all arrived. *done*: after the last
//!    step of the unit in a complete run (in a deadlock, units keep the cause that blocks them). *starved{first declared input without a
//!    visible token}*. *memory{port}*: fewer credits than the largest step needs, or the oldest slot holder of the first full output is
//!    before its step's last answer (hits and hit latency count, posted writes never). *blocked{first output without a slot}*. The
//!    causes sum to the total.
//!
//!    *Kept in [`CycleAccount`], by [`StallCause`]; test `laws/law_9_accounting`.*
//! 10. **Occupancy** of a FIFO in a cycle = slots reserved or filled, from reservation through pop. `histogram[k]`, k = 0..depth, sums to
//!     the total. (In `timed`, pushes and pops of one FIFO are each monotone, so events up to min(last push, last pop) are settled: O(1) per
//!     event, exact.)
//!
//!     *Kept in [`FifoReport::histogram`]; test `laws/law_10_occupancy`.*
//! 11. **Marks.** A marked step ends a piece of work. Mark k is passed at end(k), the cycle in which that step delivers.
//!     marks\[k\] = end(k) - end(k-1). The run lasts until its last mark. The rest of the run is its tail, and all parts sum to the
//!     total. Caches, open rows and tables stay warm from mark to mark.
//!
//!     *Set by [`Step::marked`], kept in [`RunReport::marks`]; test `laws/law_11_marks`.*
//!
//! Consequently the order in which units are visited cannot change any result. The tests of the laws stand in
//! `basrelief-kernel-conformance`: `hand` computes four whole machines by hand, `vectors` compares both engines with 584 results of an
//! independent implementation of these laws, and `properties` runs random machines.
//!
//! # Details that the laws leave open
//!
//! - **Addresses.** The burst at byte address a has in its channel the address
//!   x = (a div (`channel_bytes` * `channels`)) * `channel_bytes` + a mod `channel_bytes`. Row number = x div `row_bytes`;
//!   bank = row number mod `banks`; row within the bank = row number div `banks`. At power-on all banks are closed and no command has
//!   been issued.
//! - **Refresh.** A refresh waits for nothing and does not change `rrd` and `faw`. Law 4 needs `rfc` + `rcd` < `refi`.
//! - **Answers.** In law 4, the bursts of a request end in the cycle after the last data of any burst. A credit returns, and may be
//!   used, in the very cycle of the answer.
//! - **Delivery.** The answers of a step are those of its reads and look-ups, hit latency included. Writes have no answers. A blocking step
//!   without answers does not block. Steps of one unit deliver in order, because law 1 never lets a token overtake.
//! - **Ports of one step.** The requests of a step are issued in order. Requests to different memories do not wait for each
//!   other. Needs of a step are counted in requests for a port, and in distinct lines for a cached port, hits included. The direct
//!   requests of a step on a cached port come after its look-ups: none arrives before the last miss. For the order of first mention in
//!   law 9, look-ups come before requests, by client.
//! - **Look-ups.** A look-up in cycle s of a line in the tags is *merged* if the line's memory answer is later than s, otherwise a
//!   *hit*. A line replaced before its fill is absent, so its look-up is a new miss. Hits, merged look-ups and misses all count as use. The
//!   occupancy of a step is max(its own, ceil(distinct lines / `lookups_per_cycle`)). For law 9 the step waits for the answer of its last
//!   look-up, hit latency included.
//! - **Order of causes.** Inputs come in the order of the wiring, then clients, then outputs. If an output is full and its
//!   oldest holder awaits several clients, the client with the lowest memory number and then the lowest port number counts first.
//! - **Done.** Counts from the end of a unit's last step in a complete run. A unit that never made a step keeps its cause,
//!   unless it has [finished](Demand::Finished). In a deadlock only finished units are done.
//! - **Complete.** No FIFO holds a token, every unit is [empty](Unit::is_empty), and no unit would still make a step without
//!   input.
//! - **Limit.** With [`RunLimits::max_cycles`] no step starts in that cycle or later. If some step would start then, the run ends
//!   there as [`Outcome::Limit`]. Otherwise it ends as it would have ended without the limit, possibly a little later. Requests of
//!   units that have arrived by then run out and count. The periodic clients of a memory go on meanwhile: they count up to its last data for
//!   a unit, or its last flip, if that is later than the end.
//! - **Fault.** A unit that cannot continue ends the run at once. The message names the cycle of its step. The other events up to
//!   then differ between engines, because `timed` runs ahead.
//!
//! [`wire`]: Machine::wire

mod account;
mod area;
mod bound_stage;
mod burst;
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
mod periodic;
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

pub use account::{CycleAccount, StallCause};
pub use area::{Area, AreaConfig, AreaModel};
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
    ChunkSource, Engine, Recording, ResimulateError, ResimulationMemory, RunLimits, StageRecording, StepBatch, critical_path,
    make_steps, resimulate, resimulate_with, run, run_functional, run_recorded, run_with, time_steps,
};
pub use fifo::Fifo;
pub use fifo_info::FifoInfo;
pub use hardware::{Hardware, HardwareKind, OperandFormat, OperandWidth};
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
pub use periodic::{FlipCounts, FlipTiming, PeriodicReads};
pub use probe::{Interval, OutputWires, Probe, Recorder, StepWires, TokenBits, TokenField, UnitTable, UnitWires};
pub use report::{CacheReport, FifoReport, MemoryReport, PeriodicCounts, PortReport, RunReport, UnitReport};
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
