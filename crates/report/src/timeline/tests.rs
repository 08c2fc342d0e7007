use super::*;
use crate::samples;
use basrelief_kernel::plan::PlanMachine;
use basrelief_kernel::{Engine, Limits, run_with};
use std::collections::BTreeMap;

/// A trace, as a reader sees it.
#[derive(Clone, PartialEq, prost::Message)]
struct Trace {
    #[prost(message, repeated, tag = "1")]
    packet: Vec<TracePacket>,
}

fn record<P: Probe>(probe: &mut P, engine: Engine) -> RunReport {
    let mut machine = PlanMachine::new(&samples::plan()).unwrap();
    run_with(&mut machine, engine, probe, Limits { max_cycles: u64::MAX, progress: &mut |_| true })
}

fn names() -> Vec<StageNames> {
    samples::run().units.iter().map(StageNames::from).collect()
}

/// (track, name, from, to), by decoding and sorting as Perfetto does: by time, then by place in the file.
fn slices(bytes: &[u8]) -> Vec<(String, String, u64, u64)> {
    let mut packets = Trace::decode(bytes).unwrap().packet;
    assert!(packets.iter().all(|p| p.trusted_packet_sequence_id == Some(SEQUENCE)));
    let data = packets.iter().filter_map(|p| p.interned_data.clone()).flat_map(|d| d.event_names);
    let names: BTreeMap<u64, String> = data.map(|n| (n.iid.unwrap(), n.name.unwrap())).collect();
    let described = packets.iter().filter_map(|p| p.track_descriptor.clone());
    let tracks: BTreeMap<u64, String> = described.map(|t| (t.uuid.unwrap(), t.name.unwrap())).collect();
    packets.retain(|p| p.track_event.as_ref().is_some_and(|event| event.r#type != Some(proto::COUNTER)));
    packets.sort_by_key(|p| p.timestamp);
    let (mut open, mut slices) = (BTreeMap::new(), vec![]);
    for packet in packets {
        let (event, at) = (packet.track_event.unwrap(), packet.timestamp.unwrap());
        let track = tracks[&event.track_uuid.unwrap()].clone();
        if event.r#type == Some(proto::SLICE_BEGIN) {
            let name = event.name.unwrap_or_else(|| names[&event.name_iid.unwrap()].clone());
            assert!(open.insert(track, (name, at)).is_none(), "slices of a unit overlap");
        } else {
            let (name, from) = open.remove(&track).unwrap();
            slices.push((track, name, from, at));
        }
    }
    assert!(open.is_empty(), "{open:?}");
    slices.sort();
    slices
}

/// (FIFO, cycle, slots).
fn counters(bytes: &[u8]) -> Vec<(String, u64, i64)> {
    let packets = Trace::decode(bytes).unwrap().packet;
    let described = packets.iter().filter_map(|p| p.track_descriptor.clone());
    let counted = described.filter(|t| t.counter.as_ref().is_some_and(|c| c.unit_name.as_deref() == Some("slots")));
    let tracks: BTreeMap<u64, String> = counted.map(|t| (t.uuid.unwrap(), t.name.unwrap())).collect();
    let events = packets.iter().filter_map(|p| Some((p.timestamp?, p.track_event.as_ref()?)));
    let events = events.filter(|(_, event)| event.r#type == Some(proto::COUNTER));
    events.map(|(at, event)| (tracks[&event.track_uuid.unwrap()].clone(), at, event.counter_value.unwrap())).collect()
}

fn expected(recorder: &Recorder, names: &[StageNames], total: u64) -> Vec<(String, String, u64, u64)> {
    let name = |i: &Interval| match i.cause {
        None => "busy".into(),
        Some(Cause::Starved(k)) => format!("starved: {}", names[i.stage].inputs[k]),
        Some(Cause::Blocked(k)) => format!("blocked: {}", names[i.stage].outputs[k]),
        Some(Cause::Memory(k)) => format!("memory: {}", names[i.stage].clients[k]),
    };
    let all = recorder.stages.iter().flatten();
    let mut all: Vec<_> = all.map(|i| (names[i.stage].unit.clone(), name(i), i.from.0, i.to.0)).collect();
    for (stage, intervals) in names.iter().zip(&recorder.stages) {
        if let Some(end) = intervals.last().map(|i| i.to.0).filter(|&end| end < total) {
            all.push((stage.unit.clone(), "done".into(), end, total));
        }
    }
    all.sort();
    all
}

#[test]
fn the_trace_holds_what_the_recorder_saw() {
    let mut recorder = Recorder::default();
    let run = record(&mut recorder, Engine::Timed);
    let recorded = slices(&write_recorded(vec![], "plan", &recorder, &run).unwrap());
    assert_eq!(recorded, expected(&recorder, &names(), run.total));
    for kind in ["busy", "starved: f", "blocked: f", "memory: p"] {
        assert!(recorded.iter().any(|(_, name, ..)| name == kind), "{kind}");
    }
}

#[test]
fn streaming_and_both_engines_give_the_same_slices() {
    let mut recorder = Recorder::default();
    let run = record(&mut recorder, Engine::Timed);
    for engine in [Engine::Timed, Engine::Ticked] {
        let mut timeline = Timeline::new(vec![], "plan", &names());
        assert_eq!(record(&mut timeline, engine), run);
        assert_eq!(slices(&timeline.finish(&run).unwrap()), expected(&recorder, &names(), run.total), "{engine:?}");
    }
}

#[test]
fn slices_of_a_unit_sum_to_its_account() {
    let mut timeline = Timeline::new(vec![], "plan", &names());
    let run = record(&mut timeline, Engine::Timed);
    let slices = slices(&timeline.finish(&run).unwrap());
    for unit in &run.units {
        let busy = slices.iter().filter(|s| s.0 == unit.name && s.1 == "busy").map(|s| s.3 - s.2).sum::<u64>();
        assert_eq!(busy, unit.account.busy, "{}", unit.name);
        assert_eq!(slices.iter().filter(|s| s.0 == unit.name).map(|s| s.3 - s.2).sum::<u64>(), run.total, "{}", unit.name);
    }
}

#[test]
fn fifos_have_counters() {
    let (mut recorder, mut timeline) = (Recorder::default(), Timeline::new(vec![], "plan", &names()));
    let run = record(&mut recorder, Engine::Timed);
    record(&mut timeline, Engine::Timed);
    let mut shown = counters(&timeline.finish(&run).unwrap());
    shown.sort();
    let told = |(name, fills): (&str, &Vec<(Cycle, usize)>)| -> Vec<(String, u64, i64)> {
        fills.iter().map(|&(at, slots)| (name.to_owned(), at.0, slots as i64)).collect()
    };
    let expected: Vec<_> = ["f", "g"].into_iter().zip(&recorder.fifos).flat_map(told).collect();
    assert!(expected.iter().any(|(name, _, slots)| name == "f" && *slots == 3), "it was full");
    assert_eq!(shown, expected);
}

#[test]
fn frames_have_a_track_of_their_own() {
    let mut run = samples::run();
    run.marks = vec![30, 12];
    let frames = slices(&write_recorded(vec![], "plan", &Recorder::default(), &run).unwrap());
    let frame = |name: &str, from, to| ("frames".to_owned(), name.to_owned(), from, to);
    assert_eq!(frames, [frame("frame 1", 0, 30), frame("frame 2", 30, 42)]);
}

#[test]
fn what_reaches_beyond_a_run_cut_short_is_cut() {
    let mut run = samples::run();
    (run.total, run.outcome) = (10, Outcome::Limit);
    let mut timeline = Timeline::new(vec![], "plan", &names());
    timeline.worked(0, Cycle(4), Cycle(90));
    timeline.worked(1, Cycle(10), Cycle(11));
    timeline.worked(99, Cycle(0), Cycle(1));
    let slices = slices(&timeline.finish(&run).unwrap());
    assert_eq!(slices, [("source".to_owned(), "busy".to_owned(), 4, 10)]);
}

/// Takes some bytes, then no more.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or_else(|| io::Error::other("disk full"))?;
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn memory_does_not_grow_with_the_run_and_write_errors_are_told() {
    let mut timeline = Timeline::new(Full(10 * CHUNK), "plan", &names());
    for k in 0..20_000 {
        timeline.worked(0, Cycle(2 * k), Cycle(2 * k + 1));
        assert!(timeline.buffer.capacity() <= 2 * CHUNK);
    }
    let error = timeline.finish(&samples::run()).err().unwrap();
    assert_eq!(error.to_string(), "disk full");
}
