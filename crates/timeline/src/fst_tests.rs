use crate::samples;
use crate::*;
use basrelief_input::MemoryPool;
use basrelief_kernel::{ClientTopology, Cycle, Engine, MemoryEvent, Probe, Recorder, RunLimits, RunReport, StallCause, run_with};
use basrelief_kernel_conformance::plan::PlanMachine;
use fst_reader::{FstFilter, FstHierarchyEntry, FstReader, FstSignalValue};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::io::Cursor;

/// Time per cycle of the boards of these tests.
const NS: u64 = 5;

fn board() -> TimelineLayout {
    TimelineLayout { hz: 200_000_000, ..samples::board() }
}

fn record(probe: &mut dyn Probe, engine: Engine) -> RunReport {
    let mut machine = PlanMachine::new(&samples::plan()).unwrap();
    run_with(&mut machine, engine, Some(probe), RunLimits { max_cycles: u64::MAX, progress: &mut |_| true })
}

/// The waves of a run, in sections of so many bytes.
fn waves(board: &TimelineLayout, engine: Engine, section: usize) -> (RunReport, Vec<u8>) {
    let mut file = Cursor::new(vec![]);
    let mut waves = FstWaves::new(&mut file, board, &MemoryPool::default());
    waves.section = section;
    let mut watcher = TimelineProbe::new(board.clone(), vec![Box::new(waves)]);
    let run = record(&mut watcher, engine);
    watcher.finish(&run).into_iter().collect::<std::io::Result<()>>().unwrap();
    (run, file.into_inner())
}

/// Changes of each signal by its full name: cycle and value (bits of a real number).
fn read(bytes: &[u8]) -> BTreeMap<String, Vec<(u64, Option<u64>)>> {
    let mut reader = FstReader::open(Cursor::new(bytes)).unwrap();
    assert_eq!(reader.get_header().timescale_exponent, -9);
    let (mut scopes, mut names): (Vec<String>, BTreeMap<usize, String>) = Default::default();
    let hierarchy = |entry| match entry {
        FstHierarchyEntry::Scope { name, .. } => scopes.push(name),
        FstHierarchyEntry::UpScope => drop(scopes.pop()),
        FstHierarchyEntry::Var { name, handle, .. } => {
            names.insert(handle.get_index(), format!("{}.{name}", scopes.join(".")));
        }
        other => panic!("{other:?}"),
    };
    reader.read_hierarchy(hierarchy).unwrap();
    let mut changes: BTreeMap<String, Vec<(u64, Option<u64>)>> = names.values().map(|name| (name.clone(), vec![])).collect();
    let all = FstFilter::all();
    let take = |at, handle: fst_reader::FstSignalHandle, value: FstSignalValue<'_>| {
        let value = match value {
            FstSignalValue::String(bits) => u64::from_str_radix(std::str::from_utf8(bits).unwrap(), 2).ok(),
            FstSignalValue::Real(real) => Some(real).filter(|real| !real.is_nan()).map(f64::to_bits),
        };
        changes.get_mut(&names[&handle.get_index()]).unwrap().push((at, value));
        Ok::<(), Infallible>(())
    };
    reader.read_signals(&all, take).unwrap();
    changes
}

/// A signal in each cycle up to `end`.
fn by_cycle(changes: &[(u64, Option<u64>)], end: u64) -> Vec<Option<u64>> {
    let at = |cycle: u64| changes.iter().rfind(|(at, _)| *at <= NS * cycle).and_then(|(_, value)| *value);
    (0..end).map(at).collect()
}

/// State of a stage in each cycle, from a recorder.
fn states(recorder: &Recorder, stage: usize, total: u64) -> Vec<&'static str> {
    let name = |cause: Option<StallCause>| match cause {
        None => "busy",
        Some(StallCause::Starved(_)) => "starved",
        Some(StallCause::Blocked(_)) => "blocked",
        Some(StallCause::Memory(_)) => "memory",
    };
    let at = |cycle| {
        let found = recorder.stages[stage].iter().find(|i| (i.from..i.to).contains(&Cycle(cycle)));
        found.map_or("done", |interval| name(interval.cause))
    };
    (0..total).map(at).collect()
}

/// Occupied slots of a FIFO in each cycle, from a recorder.
fn fills(recorder: &Recorder, fifo: usize, total: u64) -> Vec<u64> {
    let at = |cycle: u64| recorder.fifos[fifo].iter().rfind(|(at, _)| at.0 <= cycle).map_or(0, |(_, slots)| *slots as u64);
    (0..total).map(at).collect()
}

/// Whether a token of a FIFO is visible in each cycle, from a recorder.
fn valid(recorder: &Recorder, fifo: usize, total: u64) -> Vec<u64> {
    let at = |cycle: u64| recorder.visible[fifo].iter().rfind(|(at, _)| at.0 <= cycle).map_or(0, |(_, tokens)| *tokens);
    (0..total).map(|cycle| u64::from(at(cycle) > 0)).collect()
}

/// Signals of the memory of the plan in each cycle, from a recorder. It has one channel of two banks, one client, and bursts of 32
/// bytes in 4 cycles.
fn memory_by_cycle(recorder: &Recorder, total: u64) -> Vec<(String, Vec<u64>)> {
    let cycles = 0..total;
    let events = |source: [usize; 4]| recorder.memories.get(&source).cloned().unwrap_or_default();
    let during = |source, of: fn(&MemoryEvent) -> u64| -> Vec<u64> {
        let events = events(source);
        let at = |cycle: u64| {
            let found = events.iter().find(|event| match event {
                MemoryEvent::Moved { from, to, .. } | MemoryEvent::Open { from, to, .. } => (from.0..to.0).contains(&cycle),
                other => panic!("{other:?}"),
            });
            found.map_or(0, of)
        };
        cycles.clone().map(at).collect()
    };
    let level = |source, start: u64, of: fn(u64, usize) -> u64| -> Vec<u64> {
        let told: Vec<(u64, usize)> = events(source)
            .iter()
            .map(|event| match *event {
                MemoryEvent::Queued { at, bursts: n, .. } | MemoryEvent::InFlight { at, requests: n, .. } => (at.0, n),
                other => panic!("{other:?}"),
            })
            .collect();
        let at = |cycle: u64| told.iter().rfind(|(at, _)| *at <= cycle).map_or(start, |(_, n)| of(start, *n));
        cycles.clone().map(at).collect()
    };
    let is_write = |event: &MemoryEvent| matches!(event, MemoryEvent::Moved { write: true, .. }).into();
    let row = |event: &MemoryEvent| if let MemoryEvent::Open { row, .. } = event { *row } else { 0 };
    let bus = during([0, 0, 0, 0], |_| 1);
    let mut signals: Vec<(String, Vec<u64>)> = vec![
        ("memory_m.write".into(), during([0, 0, 0, 0], is_write)),
        ("memory_m.client_p".into(), bus.clone()),
        ("memory_m.queue".into(), level([2, 0, 0, 0], 0, |_, n| n as u64)),
        ("client_p.credits".into(), level([3, 0, 0, 0], 2, |start, n| start - n as u64)),
    ];
    for bank in 0..2 {
        signals.push((format!("memory_m.bank_{bank}.open"), during([1, 0, 0, bank], |_| 1)));
        signals.push((format!("memory_m.bank_{bank}.row"), during([1, 0, 0, bank], row)));
    }
    for (name, whole) in [("bytes_per_cycle", 32.0 / 4.0), ("bus_use", 100.0)] {
        let rate = |interval: &[u64]| vec![(interval.iter().sum::<u64>() as f64 * whole / 256.0).to_bits(); interval.len()];
        signals.push((format!("memory_m.{name}"), bus.chunks(256).flat_map(rate).collect()));
    }
    for name in ["bank_0.open", "bank_1.open", "queue", "bus_use"] {
        let values = &signals.iter().find(|(signal, _)| signal.ends_with(name)).unwrap().1;
        assert!(values.iter().any(|value| *value > 0), "{name} is shown to change");
    }
    signals.push(("memory_m.bus".into(), bus));
    signals
}

#[test]
fn waves_equal_the_recorder_in_every_cycle() {
    let mut recorder = Recorder::default();
    let run = record(&mut recorder, Engine::Timed);
    let (from, to) = (run.total / 4, run.total / 2);
    for board in [board(), TimelineLayout { from, to, ..board() }] {
        for (engine, section) in [(Engine::Timed, 1 << 22), (Engine::Ticked, 1 << 22), (Engine::Timed, 100)] {
            let (told, bytes) = waves(&board, engine, section);
            assert_eq!(told, run);
            let shown = board.from..board.to.min(run.total);
            // The reader takes the start time from the first section, but GTKWave from the header.
            let header = [&bytes[9..17], &bytes[17..25]].map(|word| u64::from_be_bytes(word.try_into().unwrap()));
            assert_eq!(header, [NS * shown.start, NS * shown.end]);
            let read = read(&bytes);
            let check = |name: &str, expected: &[u64]| {
                let value = by_cycle(&read[name], run.total);
                for cycle in 0..run.total {
                    let expected = shown.contains(&cycle).then_some(expected[cycle as usize]);
                    let beyond = cycle >= shown.end;
                    assert!(beyond || value[cycle as usize] == expected, "{name} in {cycle}: {value:?}");
                }
            };
            for (number, stage) in board.diagram.stages.iter().enumerate() {
                let states = states(&recorder, number, run.total);
                for state in ["busy", "starved", "blocked", "memory", "done"] {
                    let expected: Vec<u64> = states.iter().map(|is| u64::from(*is == state)).collect();
                    check(&format!("plan.{}.{state}", stage.name), &expected);
                }
            }
            for (number, fifo) in board.diagram.fifos.iter().enumerate() {
                let fills = fills(&recorder, number, run.total);
                check(&format!("plan.{}.fill", fifo.name), &fills);
                let ready: Vec<u64> = fills.iter().map(|&held| u64::from(held < fifo.depth as u64)).collect();
                check(&format!("plan.{}.ready", fifo.name), &ready);
                check(&format!("plan.{}.valid", fifo.name), &valid(&recorder, number, run.total));
            }
            for (name, expected) in memory_by_cycle(&recorder, run.total) {
                check(&format!("plan.{name}"), &expected);
            }
        }
    }
}

#[test]
fn valid_does_not_depend_on_shown_units() {
    let mut recorder = Recorder::default();
    let run = record(&mut recorder, Engine::Timed);
    let mut board = board();
    board.show_only(&["source".into()]).unwrap();
    let read = read(&waves(&board, Engine::Timed, 1 << 22).1);
    let valid = valid(&recorder, 0, run.total);
    let held = fills(&recorder, 0, run.total).iter().filter(|held| **held > 0).count() as u64;
    assert!(valid.iter().sum::<u64>() < held, "slots are reserved before a token is visible");
    assert_eq!(by_cycle(&read["plan.f.valid"], run.total), valid.into_iter().map(Some).collect::<Vec<_>>());
}

#[test]
fn bus_names_the_client_of_a_transfer() {
    let mut board = board();
    let other = ClientTopology { name: "q r".into(), ..board.diagram.clients[0].clone() };
    board.diagram.clients.push(other);
    let mut file = Cursor::new(vec![]);
    let mut watcher = TimelineProbe::new(board.clone(), vec![Box::new(FstWaves::new(&mut file, &board, &MemoryPool::default()))]);
    for (client, from, to) in [(0, 1, 2), (1, 2, 3)] {
        let (from, to) = (Cycle(from), Cycle(to));
        watcher.on_memory_event(MemoryEvent::Moved { memory: 0, channel: 0, client, write: false, from, to });
    }
    assert!(watcher.finish(&samples::run()).into_iter().all(|finished| finished.is_ok()));
    let read = read(&file.into_inner());
    let signal = |name: &str| by_cycle(&read[&format!("plan.memory_m.{name}")], 4);
    let bits = |values: [u64; 4]| values.map(Some).to_vec();
    assert_eq!([signal("bus"), signal("client_p"), signal("client_q_r")], [[0, 1, 1, 0], [0, 1, 0, 0], [0, 0, 1, 0]].map(bits));
}

#[test]
fn frames_are_numbered_and_names_have_numerals() {
    let mut board = TimelineLayout { hz: 200_000_000, ..samples::board() };
    board.numerals[0] = "110".into();
    board.show_only(&["source".into()]).unwrap();
    let mut file = Cursor::new(vec![]);
    let watcher = TimelineProbe::new(board.clone(), vec![Box::new(FstWaves::new(&mut file, &board, &MemoryPool::default()))]);
    let mut run = samples::run();
    run.marks = vec![30, 12];
    assert!(watcher.finish(&run).into_iter().all(|finished| finished.is_ok()));
    let read = read(&file.into_inner());
    let frame = by_cycle(&read["plan.frame"], 45);
    assert_eq!([frame[0], frame[29], frame[30], frame[41], frame[42]], [Some(1), Some(1), Some(2), Some(2), Some(0)]);
    let mut names: Vec<&str> = read.keys().map(String::as_str).collect();
    names.retain(|name| name.ends_with(".busy") || name.ends_with(".fill"));
    assert_eq!(names, ["plan.f.fill", "plan.source_(110).busy"]);
}

#[test]
fn waves_beyond_the_memory_limit_are_an_error() {
    let board = board();
    let mut file = Cursor::new(vec![]);
    let waves = FstWaves::new(&mut file, &board, &MemoryPool::new(200));
    let mut watcher = TimelineProbe::new(board.clone(), vec![Box::new(waves)]);
    let run = record(&mut watcher, Engine::Timed);
    let error = watcher.finish(&run).remove(0).unwrap_err().to_string();
    assert!(error.contains("for waves") && error.contains("--memory-limit"), "{error}");
}

/// Takes bytes in order alone.
#[derive(Debug)]
struct UnseekableWriter;

impl std::io::Write for UnseekableWriter {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl std::io::Seek for UnseekableWriter {
    fn seek(&mut self, _: std::io::SeekFrom) -> std::io::Result<u64> {
        Err(std::io::ErrorKind::NotSeekable.into())
    }
}

#[test]
fn a_pipe_is_refused() {
    let waves = Box::new(FstWaves::new(UnseekableWriter, &board(), &MemoryPool::default()));
    assert!(waves.finish(1, true).unwrap_err().to_string().contains("no pipe"));
}
