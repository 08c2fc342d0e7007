//! What every unit did when, as a trace for ui.perfetto.dev: one track per unit, slices named `busy`,
//! `starved: <fifo>`, `blocked: <fifo>`, `memory: <client>` and, after its last step, `done`; a track of frames; and a counter per FIFO:
//! the slots that it holds.
//!
//! **One cycle is shown as one nanosecond**: a trace counts in whole nanoseconds, and cycles shall be read off exactly,
//! whatever `clock.hz` says.
//!
//! [`Timeline`] is a probe that writes as the run goes: it keeps one open slice per unit and a buffer of fixed size, so
//! memory does not grow with the run. Packets therefore stand in the order in which the engine finds out: in order of
//! time on each track, but one unit may be far ahead of another. Perfetto sorts a trace without flush events as a whole,
//! by time and then by place in the file, so the end of a slice stays ahead of the begin that follows in the same cycle.
//! Sorting in windows here was rejected: a unit may run ahead by any number of cycles, so no window is long enough.

mod proto;

use crate::blame::Wait;
use crate::text::cause;
use basrelief_kernel::{Cause, Cycle, Interval, Outcome, Probe, Recorder, RunReport, UnitReport};
use prost::Message;
use prost::encoding::{WireType, encode_key, encode_varint, encoded_len_varint, key_len, message, uint64};
use proto::{CounterDescriptor, EventName, InternedData, TracePacket, TrackDescriptor, TrackEvent};
use std::io::{self, Write};

/// Names of a stage and of what it may wait for, in the order of the wiring.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StageNames {
    /// The unit.
    pub unit: String,
    /// Its input FIFOs.
    pub inputs: Vec<String>,
    /// Its output FIFOs.
    pub outputs: Vec<String>,
    /// Its memory clients.
    pub clients: Vec<String>,
}

impl From<&UnitReport> for StageNames {
    fn from(unit: &UnitReport) -> Self {
        Self {
            unit: unit.name.clone(),
            inputs: unit.inputs.clone(),
            outputs: unit.outputs.clone(),
            clients: unit.clients.clone(),
        }
    }
}

/// Bytes that are written at once.
const CHUNK: usize = 1 << 16;
/// Most bytes ahead of what follows the time of a packet: two keys, two numbers of at most ten bytes.
const HEAD: usize = 22;
/// All packets are of one sequence: one writer.
const SEQUENCE: u32 = 1;
/// Track of the machine; its children are the frames, then the units.
const MACHINE: u64 = 1;
const FRAMES: u64 = 2;
const FIRST_UNIT: u64 = 3;
/// Interned names of a unit at work, and after its last step; the first cause of the first stage follows.
const BUSY: u64 = 1;
const DONE: u64 = 2;

/// The packets of a stage's slices, but for their time: they differ in nothing else, so each is encoded once.
#[derive(Clone, Debug)]
struct Slices {
    busy: Vec<u8>,
    starved: Vec<Vec<u8>>,
    blocked: Vec<Vec<u8>>,
    memory: Vec<Vec<u8>>,
    done: Vec<u8>,
    end: Vec<u8>,
}

impl Slices {
    /// The packet that begins a slice of this cause; `None` where the stage has no such FIFO or client.
    fn begin(&self, cause: Option<Cause>) -> Option<&Vec<u8>> {
        match cause {
            None => Some(&self.busy),
            Some(Cause::Starved(i)) => self.starved.get(i),
            Some(Cause::Blocked(i)) => self.blocked.get(i),
            Some(Cause::Memory(i)) => self.memory.get(i),
        }
    }
}

/// A probe that writes a Perfetto trace. Write errors end the writing and are told by [`Timeline::finish`].
#[derive(Debug)]
pub struct Timeline<W> {
    out: W,
    /// Packets, encoded as they come: keeping them as such until they are written took longer than the encoding.
    buffer: Vec<u8>,
    slices: Vec<Slices>,
    /// The slice of each stage that may still grow.
    open: Vec<Option<Interval>>,
    /// Track of the first FIFO; the others follow, in the order of the wiring by producer.
    first_fifo: u64,
    error: Option<io::Error>,
}

impl<W: Write> Timeline<W> {
    /// Starts a trace of `machine` with these stages, in the order of the wiring.
    pub fn new(out: W, machine: &str, stages: &[StageNames]) -> Self {
        let (slices, names) = intern(stages);
        let open = vec![None; stages.len()];
        let first_fifo = FIRST_UNIT + stages.len() as u64;
        let mut timeline = Self { out, buffer: Vec::with_capacity(2 * CHUNK), slices, open, first_fifo, error: None };
        timeline.packet(TracePacket {
            interned_data: Some(InternedData { event_names: names }),
            sequence_flags: Some(proto::INCREMENTAL_STATE_CLEARED),
            ..TracePacket::default()
        });
        timeline.track(TrackDescriptor { child_ordering: Some(proto::EXPLICIT_ORDER), ..track(MACHINE, machine) });
        let children = std::iter::once((FRAMES, "frames")).chain((FIRST_UNIT..).zip(stages.iter().map(|s| s.unit.as_str())));
        let fifos = (first_fifo..).zip(stages.iter().flat_map(|s| &s.outputs).map(String::as_str));
        let all = children.map(|child| (child, None)).chain(fifos.map(|fifo| (fifo, Some(slots()))));
        for (rank, ((uuid, name), counter)) in (0..).zip(all) {
            let (parent_uuid, sibling_order_rank) = (Some(MACHINE), Some(rank));
            timeline.track(TrackDescriptor { parent_uuid, sibling_order_rank, counter, ..track(uuid, name) });
        }
        timeline
    }

    /// Writes what is still open, cut at the end of the run, and the frames; gives the writer back.
    ///
    /// What units wait for after their last step, in a run that did not complete, no probe is shown: it stands in the
    /// report.
    ///
    /// # Errors
    /// The first error that the writer gave.
    pub fn finish(mut self, run: &RunReport) -> io::Result<W> {
        for stage in 0..self.open.len() {
            if let Some(mut slice) = self.open.get_mut(stage).and_then(Option::take) {
                slice.to = slice.to.min(Cycle(run.total));
                self.slice(slice);
                if run.outcome == Outcome::Complete {
                    self.done(stage, slice.to.0, run.total);
                }
            }
        }
        let mut start = 0;
        for (k, &cycles) in run.marks.iter().enumerate() {
            let name = Some(format!("frame {}", k + 1));
            self.event(start, TrackEvent { name, ..event(proto::SLICE_BEGIN, FRAMES) });
            start = start.saturating_add(cycles);
            self.event(start, event(proto::SLICE_END, FRAMES));
        }
        self.write_out();
        self.error.map_or(Ok(()), Err)?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn add(&mut self, new: Interval) {
        let Some(open) = self.open.get_mut(new.stage) else { return };
        match open {
            Some(last) if last.cause == new.cause && last.to == new.from => last.to = new.to,
            _ => {
                if let Some(last) = open.replace(new) {
                    self.slice(last);
                }
            }
        }
    }

    fn slice(&mut self, slice: Interval) {
        let Some(stage) = self.slices.get(slice.stage).filter(|_| slice.from < slice.to) else { return };
        let Some(begin) = stage.begin(slice.cause) else { return };
        at_time(&mut self.buffer, slice.from.0, begin);
        at_time(&mut self.buffer, slice.to.0, &stage.end);
        self.write_out_if_full();
    }

    /// A unit makes no step any more, but others go on.
    fn done(&mut self, stage: usize, from: u64, to: u64) {
        let Some(stage) = self.slices.get(stage).filter(|_| from < to) else { return };
        at_time(&mut self.buffer, from, &stage.done);
        at_time(&mut self.buffer, to, &stage.end);
    }

    fn event(&mut self, cycle: u64, event: TrackEvent) {
        at_time(&mut self.buffer, cycle, &timeless(event));
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

impl<W: Write> Probe for Timeline<W> {
    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: None, from, to });
    }

    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: Some(cause), from, to });
    }

    fn held(&mut self, fifo: usize, at: Cycle, slots: usize) {
        let counter_value = i64::try_from(slots).ok();
        self.event(at.0, TrackEvent { counter_value, ..event(proto::COUNTER, self.first_fifo + fifo as u64) });
    }
}

/// Writes a recorded run as [`Timeline`] would have written it.
///
/// # Errors
/// The first error that the writer gave.
pub fn write_recorded<W: Write>(out: W, machine: &str, recorder: &Recorder, run: &RunReport) -> io::Result<W> {
    let names: Vec<StageNames> = run.units.iter().map(StageNames::from).collect();
    let mut timeline = Timeline::new(out, machine, &names);
    for &interval in recorder.stages.iter().flatten() {
        timeline.add(interval);
    }
    for (fifo, fills) in recorder.fifos.iter().enumerate() {
        fills.iter().for_each(|&(at, slots)| timeline.held(fifo, at, slots));
    }
    timeline.finish(run)
}

fn track(uuid: u64, name: &str) -> TrackDescriptor {
    TrackDescriptor { uuid: Some(uuid), name: Some(name.into()), ..TrackDescriptor::default() }
}

/// What is counted of a FIFO.
fn slots() -> CounterDescriptor {
    CounterDescriptor { unit_name: Some("slots".into()) }
}

fn event(kind: i32, track: u64) -> TrackEvent {
    TrackEvent { r#type: Some(kind), track_uuid: Some(track), ..TrackEvent::default() }
}

/// The packet of an event, but for its time.
fn timeless(event: TrackEvent) -> Vec<u8> {
    let packet = TracePacket {
        track_event: Some(event),
        trusted_packet_sequence_id: Some(SEQUENCE),
        sequence_flags: Some(proto::NEEDS_INCREMENTAL_STATE),
        ..TracePacket::default()
    };
    packet.encode_to_vec()
}

/// Appends a packet with its time put ahead of the rest. Its head is made in an array: byte by byte, a vector asks each time
/// whether it must grow.
fn at_time(buffer: &mut Vec<u8>, cycle: u64, rest: &[u8]) {
    let mut head = [0; HEAD];
    let mut free = &mut head[..];
    encode_key(proto::PACKET, WireType::LengthDelimited, &mut free);
    encode_varint((key_len(proto::TIMESTAMP) + encoded_len_varint(cycle) + rest.len()) as u64, &mut free);
    uint64::encode(proto::TIMESTAMP, &cycle, &mut free);
    let used = HEAD - free.len();
    buffer.extend_from_slice(&head[..used]);
    buffer.extend_from_slice(rest);
}

/// Numbers every cause of every stage, so that a slice's name takes one or two bytes.
fn intern(stages: &[StageNames]) -> (Vec<Slices>, Vec<EventName>) {
    let mut names =
        vec![EventName { iid: Some(BUSY), name: Some("busy".into()) }, EventName { iid: Some(DONE), name: Some("done".into()) }];
    let mut slices = Vec::new();
    for (track, stage) in (FIRST_UNIT..).zip(stages) {
        let begin = |name| timeless(TrackEvent { name_iid: Some(name), ..event(proto::SLICE_BEGIN, track) });
        let mut add = |list: &[String], wait: fn(&str) -> Wait<'_>| {
            let first = names.len() as u64 + 1;
            names.extend((first..).zip(list).map(|(iid, name)| EventName { iid: Some(iid), name: Some(cause(wait(name))) }));
            (first..).take(list.len()).map(begin).collect()
        };
        slices.push(Slices {
            busy: begin(BUSY),
            done: begin(DONE),
            starved: add(&stage.inputs, |name| Wait::Starved(name)),
            blocked: add(&stage.outputs, |name| Wait::Blocked(name)),
            memory: add(&stage.clients, |name| Wait::Memory(name)),
            end: timeless(event(proto::SLICE_END, track)),
        });
    }
    (slices, names)
}

#[cfg(test)]
mod tests;
