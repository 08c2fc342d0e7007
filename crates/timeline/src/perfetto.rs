//! Trace for ui.perfetto.dev.
//!
//! | track | content |
//! |---|---|
//! | frames | one slice per frame |
//! | a unit | slices `busy`, `starved: <fifo>`, `blocked: <fifo>`, `memory: <client>` and, after the last step, `done` |
//! | a FIFO | counter of occupied slots |
//! | a memory bus | slices `<client> read` and `<client> write`, and counters |
//! | a memory bank | slices `row <number>` |
//!
//! Arguments of a unit's slice are its attribution, if known: `frame` from 1, and `object`, `polygon` in its frame and MIP `level` from
//! 0. The argument `asks` lists the memory clients of the step.
//!
//! Slices of units have one colour per cause, because slices of one cause share a correlation number: busy, starved, blocked, memory and
//! done are 1 to 5. Flows lead along each token whose life is recorded, from one busy slice to the next.
//!
//! A trace counts in whole nanoseconds of the device, by `clock.hz`; the name of the machine's track states the scale.
//!
//! [`PerfettoTrace`] writes during the run, from a buffer of fixed size, so memory does not grow with the run. Packets are in the order of
//! simulation: ordered in time on each track, but one unit may be far ahead of another. Perfetto sorts a trace without flush events as a
//! whole, by time and then by place in the file, so the end of a slice stays ahead of the begin that follows in the same cycle. Sorting
//! in windows was rejected: a unit may run ahead by any number of cycles, so no window is long enough.

use crate::layout::{TimelineLayout, wait_name};
use crate::levels::{ChannelCounters, CounterInfo, CounterList, CounterValue};
use crate::probe::{BusTransfer, StepAttribution, TraceSink, UnitState};
use crate::proto::{
    self, CounterDescriptor, DebugAnnotation, InternedData, InternedName, TracePacket, TrackDescriptor, TrackEvent,
};
use crate::scale::TimeScale;
use basrelief_kernel::{StageTopology, StallCause};
use prost::Message;
use prost::encoding::{WireType, encode_key, encode_varint, encoded_len_varint, fixed64, key_len, message, uint64};
use std::io::{self, Write};

/// Bytes that are written at once.
pub(crate) const CHUNK: usize = 1 << 16;
/// Maximum number of bytes before an event in its packet: three keys, three numbers of at most ten bytes.
const HEAD: usize = 33;
/// All packets are of one sequence: one writer.
pub(crate) const SEQUENCE: u32 = 1;
/// Track of the machine; its children are the frames, then the units.
const MACHINE: u64 = 1;
const FRAMES: u64 = 2;
const FIRST_UNIT: u64 = 3;
/// Interned names of a unit at work, and after its last step; the first cause of the first stage follows.
const BUSY: u64 = 1;
const DONE: u64 = 2;

/// Correlation numbers of causes.
const BUSY_COLOR: u64 = 1;
const STARVED_COLOR: u64 = 2;
const BLOCKED_COLOR: u64 = 3;
const MEMORY_COLOR: u64 = 4;
const DONE_COLOR: u64 = 5;

/// Events of the slices of a stage without their attribution, encoded once.
#[derive(Clone, Debug)]
struct SliceTemplate {
    busy: Vec<u8>,
    starved: Vec<Vec<u8>>,
    blocked: Vec<Vec<u8>>,
    memory: Vec<Vec<u8>>,
    done: Vec<u8>,
    end: Vec<u8>,
    clients: Vec<String>,
}

impl SliceTemplate {
    /// The event that begins a slice of this state; `None` where the stage has no such FIFO or client.
    fn begin(&self, state: UnitState) -> Option<&Vec<u8>> {
        match state {
            UnitState::Busy => Some(&self.busy),
            UnitState::Waits(StallCause::Starved(i)) => self.starved.get(i),
            UnitState::Waits(StallCause::Blocked(i)) => self.blocked.get(i),
            UnitState::Waits(StallCause::Memory(i)) => self.memory.get(i),
            UnitState::Done => Some(&self.done),
        }
    }
}

/// Writes a Perfetto trace. A write error ends the writing, and [`TraceSink::finish`] returns it.
#[derive(Debug)]
pub struct PerfettoTrace<W> {
    out: W,
    /// Packets, encoded as they come: keeping them as such until they are written took longer than the encoding.
    pub(crate) buffer: Vec<u8>,
    scale: TimeScale,
    /// The common end of all packets of events.
    tail: Vec<u8>,
    /// Encoded arguments of an event.
    arguments: Vec<u8>,
    slices: Vec<SliceTemplate>,
    /// Numbers of the names of each client's reads and writes.
    transfers: Vec<[u64; 2]>,
    /// Tracks of the first level, bus and bank; the others of their kind follow.
    first_level: u64,
    first_bus: u64,
    first_bank: u64,
    /// Number of levels that have a track.
    levels: usize,
    /// Banks that may have a track: names, and whether they have.
    banks: Vec<(String, bool)>,
    error: Option<io::Error>,
}

impl<W: Write> PerfettoTrace<W> {
    /// Starts a trace of a machine.
    pub fn new(out: W, board: &TimelineLayout) -> Self {
        let stages = &board.diagram.stages;
        let (slices, mut names) = intern(stages);
        let transfers = intern_transfers(board, &mut names);
        let levels = CounterList::new(board);
        let first_level = FIRST_UNIT + stages.len() as u64;
        let first_bus = first_level + levels.all.len() as u64;
        let first_bank = first_bus + levels.channels.len() as u64;
        let banks_of = |channel: &ChannelCounters| {
            let name = channel.name.clone();
            (0..board.diagram.memories[channel.memory].banks).map(move |bank| (format!("{name}: bank {bank}"), false))
        };
        let banks = levels.channels.iter().flat_map(banks_of).collect();
        let (scale, buffer) = (TimeScale::nanoseconds(board.hz), Vec::with_capacity(2 * CHUNK));
        let mut timeline = Self {
            out,
            buffer,
            scale,
            tail: tail(),
            arguments: vec![],
            slices,
            transfers,
            first_level,
            first_bus,
            first_bank,
            levels: levels.valid(0),
            banks,
            error: None,
        };
        let arguments = StepAttribution::default().numbers().map(|(name, _)| name).into_iter().chain(["asks"]);
        let debug_annotation_names = (1..).zip(arguments).map(|(iid, name)| interned(iid, name.into())).collect();
        timeline.packet(TracePacket {
            interned_data: Some(InternedData { event_names: names, debug_annotation_names }),
            sequence_flags: Some(proto::INCREMENTAL_STATE_CLEARED),
            ..TracePacket::default()
        });
        timeline.tracks(board, &levels);
        timeline
    }

    /// Describes the visible tracks.
    fn tracks(&mut self, board: &TimelineLayout, levels: &CounterList) {
        let machine = format!("{}: {}", board.machine, self.scale.words(board.hz));
        self.track(TrackDescriptor { child_ordering: Some(proto::EXPLICIT_ORDER), ..track(MACHINE, &machine) });
        let units = (0..self.slices.len()).filter(|&s| board.shows(s)).map(|s| (FIRST_UNIT + s as u64, board.name(s)));
        let units = std::iter::once((FRAMES, "frames".to_owned())).chain(units).map(|(uuid, name)| (uuid, name, None));
        let counters = (self.first_level..).zip(&levels.all[..self.levels]).filter(|(_, level)| level.is_shown);
        let counters = counters.map(|(uuid, level)| (uuid, name_of(level), Some(level.unit)));
        let buses = (self.first_bus..).zip(&levels.channels).filter(|(_, channel)| channel.is_shown);
        let buses = buses.map(|(uuid, channel)| (uuid, format!("{}: bus", channel.name), None));
        let all: Vec<_> = units.chain(counters).chain(buses).collect();
        for (rank, (uuid, name, unit)) in (0..).zip(all) {
            self.child(rank, unit, track(uuid, &name));
        }
    }

    /// Describes a track of the machine; a counter, if it has a unit of measure.
    fn child(&mut self, rank: i32, unit: Option<&str>, descriptor: TrackDescriptor) {
        let (parent_uuid, sibling_order_rank) = (Some(MACHINE), Some(rank));
        let counter = unit.map(|unit| CounterDescriptor { unit_name: Some(unit.into()) });
        self.track(TrackDescriptor { parent_uuid, sibling_order_rank, counter, ..descriptor });
    }

    /// A slice that is named in its own packets.
    fn named(&mut self, track: u64, name: String, from: u64, to: u64) {
        self.event(from, TrackEvent { name: Some(name), ..event(proto::SLICE_BEGIN, track) });
        self.event(to, event(proto::SLICE_END, track));
    }

    fn event(&mut self, cycle: u64, event: TrackEvent) {
        at_time(&mut self.buffer, self.scale.at(cycle), [&event.encode_to_vec(), &[], &self.tail]);
        self.write_out_if_full();
    }

    fn track(&mut self, descriptor: TrackDescriptor) {
        self.packet(TracePacket { track_descriptor: Some(descriptor), ..TracePacket::default() });
    }

    fn packet(&mut self, packet: TracePacket) {
        let packet = TracePacket { trusted_packet_sequence_id: Some(SEQUENCE), ..packet };
        message::encode(proto::PACKET, &packet, &mut self.buffer);
        self.write_out_if_full();
    }

    fn write_out_if_full(&mut self) {
        if self.buffer.len() >= CHUNK {
            self.write_out();
        }
    }

    /// Traces joined end to end are a trace.
    fn write_out(&mut self) {
        if self.error.is_none() {
            self.error = self.out.write_all(&self.buffer).err();
        }
        self.buffer.clear();
    }
}

impl<W: Write> TraceSink for PerfettoTrace<W> {
    fn state(&mut self, stage: usize, state: UnitState, whose: &StepAttribution, from: u64, to: u64) {
        let Some(slices) = self.slices.get(stage) else { return };
        let Some(begin) = slices.begin(state) else { return };
        annotate(&mut self.arguments, whose, &slices.clients);
        if let (UnitState::Busy, Some(life)) = (state, whose.life) {
            // 0 is no flow.
            fixed64::encode(proto::FLOW_IDS, &(life.number + 1), &mut self.arguments);
        }
        at_time(&mut self.buffer, self.scale.at(from), [begin, &self.arguments, &self.tail]);
        at_time(&mut self.buffer, self.scale.at(to), [&slices.end, &[], &self.tail]);
        self.write_out_if_full();
    }

    fn level(&mut self, level: usize, at: u64, value: CounterValue) {
        if level >= self.levels {
            return;
        }
        let (counter_value, double_counter_value) = match value {
            CounterValue::Count(count) => (i64::try_from(count).ok(), None),
            CounterValue::Real(real) => (None, Some(real)),
        };
        let track = self.first_level + level as u64;
        self.event(at, TrackEvent { counter_value, double_counter_value, ..event(proto::COUNTER, track) });
    }

    fn moved(&mut self, channel: usize, BusTransfer { client, write }: BusTransfer, from: u64, to: u64) {
        let Some(names) = self.transfers.get(client) else { return };
        let (track, name_iid) = (self.first_bus + channel as u64, Some(names[usize::from(write)]));
        self.event(from, TrackEvent { name_iid, ..event(proto::SLICE_BEGIN, track) });
        self.event(to, event(proto::SLICE_END, track));
    }

    fn open(&mut self, bank: usize, row: u64, from: u64, to: u64) {
        let track_of = self.first_bank + bank as u64;
        let Some((name, is_described)) = self.banks.get_mut(bank) else { return };
        // A track is described at its first use, because a memory may have tens of thousands.
        if !std::mem::replace(is_described, true) {
            let descriptor = track(track_of, name);
            let rank = i32::try_from(track_of).unwrap_or(i32::MAX);
            self.child(rank, None, descriptor);
        }
        self.named(track_of, format!("row {row}"), from, to);
    }

    fn frame(&mut self, number: usize, from: u64, to: u64) {
        self.named(FRAMES, format!("frame {number}"), from, to);
    }

    fn finish(mut self: Box<Self>, _: u64, _: bool) -> io::Result<()> {
        self.write_out();
        self.error.map_or(Ok(()), Err)?;
        self.out.flush()
    }
}

fn track(uuid: u64, name: &str) -> TrackDescriptor {
    TrackDescriptor { uuid: Some(uuid), name: Some(name.into()), ..TrackDescriptor::default() }
}

/// A FIFO's counter is named as it is.
fn name_of(level: &CounterInfo) -> String {
    if level.what == "fill" { level.of.clone() } else { format!("{}: {}", level.of, level.what) }
}

/// Assigns numbers to the names of bus transfers: reads and writes of each client.
fn intern_transfers(board: &TimelineLayout, names: &mut Vec<InternedName>) -> Vec<[u64; 2]> {
    let mut add = |name: String| {
        let iid = names.len() as u64 + 1;
        names.push(interned(iid, name));
        iid
    };
    board.diagram.clients.iter().map(|client| ["read", "write"].map(|kind| add(format!("{} {kind}", client.name)))).collect()
}

fn event(kind: i32, track: u64) -> TrackEvent {
    TrackEvent { r#type: Some(kind), track_uuid: Some(track), ..TrackEvent::default() }
}

/// The common end of all packets of events.
fn tail() -> Vec<u8> {
    let packet = TracePacket {
        trusted_packet_sequence_id: Some(SEQUENCE),
        sequence_flags: Some(proto::NEEDS_INCREMENTAL_STATE),
        ..TracePacket::default()
    };
    packet.encode_to_vec()
}

/// Encodes the attribution of a slice and its memory requests.
fn annotate(arguments: &mut Vec<u8>, whose: &StepAttribution, clients: &[String]) {
    arguments.clear();
    let numbers = whose.numbers();
    for (name_iid, (_, uint_value)) in (1..).zip(numbers) {
        if uint_value.is_some() {
            let argument = DebugAnnotation { name_iid: Some(name_iid), uint_value, string_value: None };
            message::encode(proto::DEBUG_ANNOTATIONS, &argument, arguments);
        }
    }
    if whose.asks != 0 {
        let name_iid = Some(numbers.len() as u64 + 1);
        let argument = DebugAnnotation { name_iid, uint_value: None, string_value: Some(whose.clients(clients)) };
        message::encode(proto::DEBUG_ANNOTATIONS, &argument, arguments);
    }
}

/// Appends the packet of an event with its time \[ns\] and arguments. Its head is made in an array: byte by byte, a vector asks each time
/// whether it must grow.
fn at_time(buffer: &mut Vec<u8>, time: u64, [event, arguments, tail]: [&[u8]; 3]) {
    let of_event = event.len() + arguments.len();
    let ahead =
        key_len(proto::TIMESTAMP) + encoded_len_varint(time) + key_len(proto::TRACK_EVENT) + encoded_len_varint(of_event as u64);
    let mut head = [0; HEAD];
    let mut free = &mut head[..];
    encode_key(proto::PACKET, WireType::LengthDelimited, &mut free);
    encode_varint((ahead + of_event + tail.len()) as u64, &mut free);
    uint64::encode(proto::TIMESTAMP, &time, &mut free);
    encode_key(proto::TRACK_EVENT, WireType::LengthDelimited, &mut free);
    encode_varint(of_event as u64, &mut free);
    let used = HEAD - free.len();
    [&head[..used], event, arguments, tail].into_iter().for_each(|part| buffer.extend_from_slice(part));
}

fn interned(iid: u64, name: String) -> InternedName {
    InternedName { iid: Some(iid), name: Some(name) }
}

/// Numbers every cause of every stage, so that a slice's name takes one or two bytes.
fn intern(stages: &[StageTopology]) -> (Vec<SliceTemplate>, Vec<InternedName>) {
    let mut names = vec![interned(BUSY, "busy".into()), interned(DONE, "done".into())];
    let mut slices = Vec::new();
    for (track, stage) in (FIRST_UNIT..).zip(stages) {
        let begin = |name, color| {
            let (name_iid, correlation_id) = (Some(name), Some(color));
            TrackEvent { name_iid, correlation_id, ..event(proto::SLICE_BEGIN, track) }.encode_to_vec()
        };
        let mut add = |list: &[String], cause: fn(usize) -> StallCause, color| {
            let first = names.len() as u64 + 1;
            names.extend((first..).zip(0..list.len()).map(|(iid, i)| interned(iid, wait_name(stage, cause(i)))));
            (first..).take(list.len()).map(|name| begin(name, color)).collect()
        };
        slices.push(SliceTemplate {
            busy: begin(BUSY, BUSY_COLOR),
            done: begin(DONE, DONE_COLOR),
            starved: add(&stage.inputs, StallCause::Starved, STARVED_COLOR),
            blocked: add(&stage.outputs, StallCause::Blocked, BLOCKED_COLOR),
            memory: add(&stage.clients, StallCause::Memory, MEMORY_COLOR),
            end: event(proto::SLICE_END, track).encode_to_vec(),
            clients: stage.clients.clone(),
        });
    }
    (slices, names)
}
