use crate::perfetto::{CHUNK, SEQUENCE};
use crate::proto::{self, TracePacket};
use crate::samples;
use crate::*;
use basrelief_kernel::{
    CacheCounts, Cycle, Engine, Interval, MemoryEvent, Outcome, Probe, Recorder, RunLimits, RunReport, StallCause, run_with,
};
use basrelief_kernel_conformance::plan::{Plan, PlanMachine, UnitKind};
use prost::Message;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// A trace, as a reader sees it.
#[derive(Clone, PartialEq, prost::Message)]
struct DecodedTrace {
    #[prost(message, repeated, tag = "1")]
    packet: Vec<TracePacket>,
}

fn record(probe: &mut dyn Probe, engine: Engine) -> RunReport {
    record_plan(&samples::plan(), probe, engine, u64::MAX)
}

fn record_plan(plan: &Plan, probe: &mut dyn Probe, engine: Engine, max_cycles: u64) -> RunReport {
    let mut machine = PlanMachine::new(plan).unwrap();
    run_with(&mut machine, engine, Some(probe), RunLimits { max_cycles, progress: &mut |_| true })
}

/// Report and trace of a run with an engine.
fn traced(board: &TimelineLayout, engine: Engine) -> (RunReport, Vec<u8>) {
    traced_plan(&samples::plan(), board, engine, u64::MAX)
}

fn traced_plan(plan: &Plan, board: &TimelineLayout, engine: Engine, max_cycles: u64) -> (RunReport, Vec<u8>) {
    let mut bytes = vec![];
    let mut watcher = TimelineProbe::new(board.clone(), vec![Box::new(PerfettoTrace::new(&mut bytes, board))]);
    let run = record_plan(plan, &mut watcher, engine, max_cycles);
    watcher.finish(&run).into_iter().collect::<io::Result<()>>().unwrap();
    (run, bytes)
}

/// Trace of events that the test passes to a probe.
fn told(board: &TimelineLayout, run: &RunReport, tell: impl FnOnce(&mut TimelineProbe<'_>)) -> Vec<u8> {
    let mut bytes = vec![];
    let mut watcher = TimelineProbe::new(board.clone(), vec![Box::new(PerfettoTrace::new(&mut bytes, board))]);
    tell(&mut watcher);
    watcher.finish(run).into_iter().collect::<io::Result<()>>().unwrap();
    bytes
}

/// The part of the first 42 cycles or so that is cut at both ends.
fn window() -> TimelineLayout {
    TimelineLayout { from: 17, to: 41, ..samples::board() }
}

/// The slices of units and frames.
fn slices(bytes: &[u8]) -> Vec<(String, String, u64, u64)> {
    all_slices(bytes).into_iter().filter(|(track, ..)| !track.starts_with("memory ")).collect()
}

/// (track, name, from, to), by decoding and sorting as Perfetto does: by time, then by place in the file.
fn all_slices(bytes: &[u8]) -> Vec<(String, String, u64, u64)> {
    let mut packets = DecodedTrace::decode(bytes).unwrap().packet;
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
    counters_of(bytes, "slots")
}

/// (track, cycle, number) of counters with this unit of measure.
fn counters_of(bytes: &[u8], unit: &str) -> Vec<(String, u64, i64)> {
    let packets = DecodedTrace::decode(bytes).unwrap().packet;
    let described = packets.iter().filter_map(|p| p.track_descriptor.clone());
    let counted = described.filter(|t| t.counter.as_ref().is_some_and(|c| c.unit_name.as_deref() == Some(unit)));
    let tracks: BTreeMap<u64, String> = counted.map(|t| (t.uuid.unwrap(), t.name.unwrap())).collect();
    let events = packets.iter().filter_map(|p| Some((p.timestamp?, p.track_event.as_ref()?)));
    let events = events.filter(|(_, event)| event.r#type == Some(proto::COUNTER));
    events.filter_map(|(at, event)| Some((tracks.get(&event.track_uuid?)?.clone(), at, event.counter_value.unwrap()))).collect()
}

fn expected(recorder: &Recorder, board: &TimelineLayout, total: u64) -> Vec<(String, String, u64, u64)> {
    let names = &board.diagram.stages;
    let name = |i: &Interval| match i.cause {
        None => "busy".into(),
        Some(StallCause::Starved(k)) => format!("starved: {}", names[i.stage].inputs[k]),
        Some(StallCause::Blocked(k)) => format!("blocked: {}", names[i.stage].outputs[k]),
        Some(StallCause::Memory(k)) => format!("memory: {}", names[i.stage].clients[k]),
    };
    let all = recorder.stages.iter().flatten();
    let mut all: Vec<_> = all.map(|i| (names[i.stage].name.clone(), name(i), i.from.0, i.to.0)).collect();
    for (stage, intervals) in names.iter().zip(&recorder.stages) {
        if let Some(end) = intervals.last().map(|i| i.to.0).filter(|&end| end < total) {
            all.push((stage.name.clone(), "done".into(), end, total));
        }
    }
    let cut = |(unit, name, from, to): (String, String, u64, u64)| (unit, name, from.max(board.from), to.min(board.to));
    let mut all: Vec<_> = all.into_iter().map(cut).filter(|(.., from, to)| from < to).collect();
    all.sort();
    all
}

#[test]
fn slices_have_one_color_per_cause_and_flows_per_token() {
    let board = samples::board();
    let mut bytes = vec![];
    let mut trace = Box::new(PerfettoTrace::new(&mut bytes, &board));
    let life =
        |number| StepAttribution { life: Some(TokenLife { number, pixel: None, pixels: 1 }), ..StepAttribution::default() };
    let stages = &board.diagram.stages;
    let states: Vec<(usize, UnitState)> = (0..stages.len())
        .flat_map(|stage| {
            let waits = |count: usize, cause: fn(usize) -> StallCause| (0..count).map(move |i| UnitState::Waits(cause(i)));
            let starved = waits(stages[stage].inputs.len(), StallCause::Starved);
            let blocked = waits(stages[stage].outputs.len(), StallCause::Blocked);
            let memory = waits(stages[stage].clients.len(), StallCause::Memory);
            [UnitState::Busy, UnitState::Done]
                .into_iter()
                .chain(starved)
                .chain(blocked)
                .chain(memory)
                .map(move |state| (stage, state))
        })
        .collect();
    for (at, (stage, state)) in (0..).zip(&states) {
        trace.state(*stage, *state, &life(7), at, at + 1);
    }
    trace.finish(states.len() as u64, true).unwrap();
    let packets = DecodedTrace::decode(bytes.as_slice()).unwrap().packet;
    let begun =
        packets.into_iter().filter_map(|packet| packet.track_event).filter(|event| event.r#type == Some(proto::SLICE_BEGIN));
    let begun: Vec<_> = begun.collect();
    let color = |state: &UnitState| match state {
        UnitState::Busy => 1,
        UnitState::Waits(StallCause::Starved(_)) => 2,
        UnitState::Waits(StallCause::Blocked(_)) => 3,
        UnitState::Waits(StallCause::Memory(_)) => 4,
        UnitState::Done => 5,
    };
    let colors: Vec<_> = begun.iter().map(|event| event.correlation_id).collect();
    assert_eq!(colors, states.iter().map(|(_, state)| Some(color(state))).collect::<Vec<_>>());
    let flows: Vec<_> = begun.iter().map(|event| event.flow_ids.as_slice()).collect();
    let of_state = |state: &UnitState| if *state == UnitState::Busy { &[8][..] } else { &[] };
    assert_eq!(flows, states.iter().map(|(_, state)| of_state(state)).collect::<Vec<_>>(), "a token waits between flows");
}

#[test]
fn both_engines_show_the_same_slices_in_every_window() {
    let mut recorder = Recorder::default();
    let run = record(&mut recorder, Engine::Timed);
    for board in [samples::board(), window()] {
        let expected = expected(&recorder, &board, run.total);
        for engine in [Engine::Timed, Engine::Ticked] {
            let (told, bytes) = traced(&board, engine);
            assert_eq!((told, slices(&bytes)), (run.clone(), expected.clone()), "{engine:?}");
        }
    }
    let all = expected(&recorder, &samples::board(), run.total);
    for kind in ["busy", "starved: f", "blocked: f", "memory: p"] {
        assert!(all.iter().any(|(_, name, ..)| name == kind), "{kind}");
    }
}

#[test]
fn slices_of_a_unit_sum_to_its_account() {
    sums_equal_accounts(&samples::plan(), u64::MAX);
}

#[test]
fn unit_without_a_step_has_slices() {
    let mut plan = samples::plan();
    plan.units[0].kind = UnitKind::Source { tokens: 0 };
    let run = sums_equal_accounts(&plan, u64::MAX);
    assert!(run.outcome == Outcome::Complete && run.units[1].account.starved[0] > 0 && run.units[0].account.done > 0);
}

#[test]
fn cut_run_has_slices_to_its_end() {
    let total = samples::run().total;
    for max_cycles in (1..total).step_by(7) {
        assert_eq!(sums_equal_accounts(&samples::plan(), max_cycles).outcome, Outcome::Limit);
    }
}

/// Checks that the slices of each unit sum to its account, and returns the report.
fn sums_equal_accounts(plan: &Plan, max_cycles: u64) -> RunReport {
    let (run, bytes) = traced_plan(plan, &samples::board(), Engine::Timed, max_cycles);
    let mut sums = BTreeMap::new();
    for (unit, state, from, to) in slices(&bytes).into_iter().filter(|(track, ..)| track != "frames") {
        *sums.entry((unit, state)).or_insert(0) += to - from;
    }
    let mut expected = BTreeMap::new();
    for unit in &run.units {
        let account = &unit.account;
        let named = |cause: &str, names: &[String], cycles: &[u64]| -> Vec<(String, u64)> {
            names.iter().zip(cycles).map(|(name, cycles)| (format!("{cause}: {name}"), *cycles)).collect()
        };
        let waits = [
            named("starved", &unit.inputs, &account.starved),
            named("blocked", &unit.outputs, &account.blocked),
            named("memory", &unit.clients, &account.memory),
        ];
        let all = waits.concat().into_iter().chain([("busy".into(), account.busy), ("done".into(), account.done)]);
        expected.extend(all.filter(|(_, cycles)| *cycles > 0).map(|(state, cycles)| ((unit.name.clone(), state), cycles)));
    }
    assert_eq!(sums, expected, "limit {max_cycles}");
    run
}

#[test]
fn fifos_have_counters_that_begin_with_what_they_hold() {
    let mut recorder = Recorder::default();
    record(&mut recorder, Engine::Timed);
    for board in [samples::board(), window()] {
        let mut shown = counters(&traced(&board, Engine::Timed).1);
        shown.sort();
        let told = |(name, fills): (&str, &Vec<(Cycle, usize)>)| -> Vec<(String, u64, i64)> {
            let before = fills.iter().rfind(|(at, _)| at.0 <= board.from).map_or(0, |(_, slots)| *slots);
            let within = fills.iter().filter(|(at, _)| board.from < at.0 && at.0 < board.to);
            let within = within.map(|&(at, slots)| (at.0, slots));
            std::iter::once((board.from, before)).chain(within).map(|(at, n)| (name.to_owned(), at, n as i64)).collect()
        };
        let expected: Vec<_> = ["f", "g"].into_iter().zip(&recorder.fifos).flat_map(told).collect();
        assert!(expected.iter().any(|(name, _, slots)| name == "f" && *slots == 3), "it was full");
        assert_eq!(shown, expected);
    }
}

#[test]
fn selected_units_show_with_their_fifos() {
    let all = slices(&traced(&samples::board(), Engine::Timed).1);
    let mut board = samples::board();
    board.show_only(&["source".into()]).unwrap();
    let (_, bytes) = traced(&board, Engine::Timed);
    let of_source: Vec<_> = all.into_iter().filter(|(unit, ..)| unit == "source").collect();
    assert_eq!(slices(&bytes), of_source);
    assert!(counters(&bytes).iter().all(|(fifo, ..)| fifo == "f") && !counters(&bytes).is_empty());
    assert!(!tracks(&bytes).iter().any(|name| name == "g" || name == "sink"));
}

/// Names of all tracks.
fn tracks(bytes: &[u8]) -> Vec<String> {
    DecodedTrace::decode(bytes).unwrap().packet.into_iter().filter_map(|p| p.track_descriptor?.name).collect()
}

#[test]
fn time_is_device_time_and_units_have_numerals() {
    let mut board = TimelineLayout { hz: 200_000_000, ..samples::board() };
    board.numerals[0] = "110".into();
    let shown = slices(&traced(&board, Engine::Timed).1);
    let cycles = slices(&traced(&samples::board(), Engine::Timed).1);
    let real = |(unit, name, from, to): (String, String, u64, u64)| {
        (if unit == "source" { "source (110)".into() } else { unit }, name, 5 * from, 5 * to)
    };
    let mut expected: Vec<_> = cycles.into_iter().map(real).collect();
    expected.sort();
    assert_eq!(shown, expected);
    assert_eq!(tracks(&traced(&board, Engine::Timed).1)[0], "plan: a cycle is 5 ns");
}

#[test]
fn slices_carry_attribution_and_end_with_it() {
    let board = samples::board();
    let stage = board.diagram.stages.iter().position(|stage| !stage.clients.is_empty()).unwrap();
    let some = StepAttribution { frame: Some(0), object: Some(2), polygon: Some(9), level: Some(1), asks: 0, life: None };
    let other = StepAttribution { level: None, ..some };
    let run = RunReport { total: 6, outcome: Outcome::Complete, ..record(&mut Recorder::default(), Engine::Timed) };
    let bytes = told(&board, &run, |watcher| {
        for (at, whose) in [some, some, other, StepAttribution { asks: 1, ..StepAttribution::default() }].iter().enumerate() {
            let from = at as u64;
            watcher.add(Interval { stage, cause: None, from: Cycle(from), to: Cycle(from + 1) }, whose);
        }
    });
    let trace = DecodedTrace::decode(&*bytes).unwrap();
    let data = trace.packet.iter().filter_map(|p| p.interned_data.clone()).flat_map(|d| d.debug_annotation_names);
    let names: BTreeMap<u64, String> = data.map(|n| (n.iid.unwrap(), n.name.unwrap())).collect();
    let begins = trace.packet.iter().filter(|p| p.track_event.as_ref().is_some_and(|e| e.r#type == Some(proto::SLICE_BEGIN)));
    let of_unit = begins.filter(|p| p.track_event.as_ref().unwrap().name_iid == Some(1));
    let arguments = of_unit.map(|p| {
        let event = p.track_event.clone().unwrap();
        let argument = |a: proto::DebugAnnotation| {
            (names[&a.name_iid.unwrap()].clone(), a.uint_value.map_or_else(|| a.string_value.unwrap(), |n| n.to_string()))
        };
        (p.timestamp.unwrap(), event.debug_annotations.into_iter().map(argument).collect::<Vec<_>>())
    });
    let all: Vec<(u64, Vec<(String, String)>)> = arguments.collect();
    let whose = [("frame", "1"), ("object", "2"), ("polygon", "9"), ("level", "1")]
        .map(|(name, value)| (name.to_owned(), value.to_owned()));
    let asks = ("asks".to_owned(), board.diagram.stages[stage].clients[0].clone());
    assert_eq!(all, [(0, whose.to_vec()), (2, whose[..3].to_vec()), (3, vec![asks])]);
}

#[test]
fn frames_have_a_track_of_their_own() {
    let mut run = samples::run();
    (run.marks, run.units) = (vec![30, 12], vec![]);
    let frame = |name: &str, from, to| ("frames".to_owned(), name.to_owned(), from, to);
    assert_eq!(slices(&told(&samples::board(), &run, |_| ())), [frame("frame 1", 0, 30), frame("frame 2", 30, 42)]);
    assert_eq!(slices(&told(&window(), &run, |_| ())), [frame("frame 1", 17, 30), frame("frame 2", 30, 41)]);
}

#[test]
fn slices_end_with_an_incomplete_run() {
    let mut run = samples::run();
    (run.total, run.outcome, run.units) = (10, Outcome::Limit, vec![]);
    let bytes = told(&samples::board(), &run, |watcher| {
        watcher.on_busy(0, Cycle(4), Cycle(90));
        watcher.on_busy(1, Cycle(10), Cycle(11));
        watcher.on_busy(99, Cycle(0), Cycle(1));
    });
    assert_eq!(slices(&bytes), [("source".to_owned(), "busy".to_owned(), 4, 10)]);
}

#[test]
fn a_window_behind_the_end_shows_nothing() {
    let board = TimelineLayout { from: 1 << 40, ..samples::board() };
    let (_, bytes) = traced(&board, Engine::Timed);
    assert_eq!((slices(&bytes), counters(&bytes)), (vec![], vec![]));
}

/// (counter, cycle, value) of those that have fractions.
fn rates(bytes: &[u8]) -> Vec<(String, u64, f64)> {
    let packets = DecodedTrace::decode(bytes).unwrap().packet;
    let described = packets.iter().filter_map(|p| p.track_descriptor.clone());
    let tracks: BTreeMap<u64, String> = described.map(|t| (t.uuid.unwrap(), t.name.unwrap())).collect();
    let events = packets.iter().filter_map(|p| Some((p.timestamp?, p.track_event.as_ref()?)));
    events.filter_map(|(at, event)| Some((tracks[&event.track_uuid?].clone(), at, event.double_counter_value?))).collect()
}

/// The plan's machine with a cache.
fn cached() -> TimelineLayout {
    let mut board = samples::board();
    board.diagram.clients[0].cache = Some("c".into());
    board
}

#[test]
fn rates_are_those_of_256_cycles() {
    let moved =
        |from, to| MemoryEvent::Moved { memory: 0, channel: 0, client: 0, write: false, from: Cycle(from), to: Cycle(to) };
    let looked_up = |at, hits, misses| {
        let found = CacheCounts { hits, misses, merged: 0 };
        MemoryEvent::LookedUp { client: 0, at: Cycle(at), found }
    };
    let mut run = samples::run();
    run.total = 2000;
    let bytes = told(&cached(), &run, |watcher| {
        for event in [
            moved(0, 4),
            moved(254, 258),
            moved(1024, 1024 + 256),
            looked_up(3, 1, 0),
            looked_up(255, 0, 3),
            looked_up(512, 2, 0),
        ] {
            watcher.on_memory_event(event);
        }
    });
    // Bursts of 32 bytes in 4 cycles; the last interval in which the bus moves anything ends in 1280.
    let expected = |name: &str, whole: f64| {
        let busy = [(0, 6.0), (256, 2.0), (512, 0.0), (1024, 256.0), (1280, 0.0)];
        busy.map(|(at, busy)| (name.to_owned(), at, whole * busy / 256.0)).to_vec()
    };
    let of = |name: &str| rates(&bytes).into_iter().filter(|(of, ..)| of == name).collect::<Vec<_>>();
    assert_eq!(of("memory m: bytes per cycle"), expected("memory m: bytes per cycle", 8.0));
    assert_eq!(of("memory m: bus use"), expected("memory m: bus use", 100.0));
    let hits = [(0, 25.0), (512, 100.0)].map(|(at, rate)| ("cache c: hit rate".to_owned(), at, rate));
    assert_eq!(of("cache c: hit rate"), hits);
}

#[test]
fn memory_tracks_add_up_to_the_report() {
    for engine in [Engine::Timed, Engine::Ticked] {
        let (run, bytes) = traced(&samples::board(), engine);
        let (memory, slices) = (&run.memories[0], all_slices(&bytes));
        let of = |track: &str| slices.iter().filter(|(name, ..)| name == track).cloned().collect::<Vec<_>>();
        let cycles = |slices: &[(String, String, u64, u64)]| slices.iter().map(|(.., from, to)| to - from).sum::<u64>();
        let bus = of("memory m: bus");
        assert!(bus.iter().all(|(_, name, ..)| name == "p read" || name == "p write"), "{bus:?}");
        assert_eq!(cycles(&bus) / 4, memory.ports[0].counts.rows.bursts());
        let rows = [of("memory m: bank 0"), of("memory m: bank 1")].concat();
        let counts = memory.channels[0].rows;
        assert_eq!(rows.len() as u64, counts.closed + counts.conflicts);
        assert!(rows.iter().all(|(_, name, ..)| name.starts_with("row ")));
        let credits: Vec<_> = counters_of(&bytes, "credits").into_iter().map(|(.., credits)| credits).collect();
        assert_eq!((credits[0], credits.iter().min()), (2, Some(&0)), "they are all used at some time");
    }
}

/// Takes some bytes, then no more.
struct FullWriter(usize);

impl Write for FullWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or_else(|| io::Error::other("disk full"))?;
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn memory_is_bounded_and_write_errors_are_reported() {
    let mut timeline = Box::new(PerfettoTrace::new(FullWriter(10 * CHUNK), &samples::board()));
    for k in 0..20_000 {
        timeline.state(0, UnitState::Busy, &StepAttribution::default(), 2 * k, 2 * k + 1);
        assert!(timeline.buffer.capacity() <= 2 * CHUNK);
    }
    assert_eq!(timeline.finish(u64::MAX, true).unwrap_err().to_string(), "disk full");
}
