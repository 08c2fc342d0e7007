//! Lives of tokens, read back as Konata reads them.

use crate::samples;
use crate::*;
use basrelief_input::{MemoryPool, OverBudget};
use basrelief_kernel::{Cycle, Engine, Interval, Outcome, RunLimits, RunReport, StallCause, run_with};
use basrelief_kernel_conformance::plan::PlanMachine;
use std::collections::BTreeMap;
use std::ops::Range;

/// A token as a reader sees it.
#[derive(Debug, Default, PartialEq)]
struct DecodedToken {
    label: String,
    /// Lines of the hover text.
    hover: Vec<String>,
    /// (lane, name, from, to), in the order in which they begin.
    stages: Vec<(u64, String, u64, u64)>,
    /// When it ended, and whether it was flushed.
    end: Option<(u64, bool)>,
}

/// Reads a file, and holds it to the format: time goes forwards, a stage ends before the next begins in its lane, nothing is left open.
fn read(text: &str) -> Vec<DecodedToken> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("Kanata\t0004"));
    let mut now = lines.next().unwrap().strip_prefix("C=\t").unwrap().parse::<u64>().unwrap();
    let mut tokens: Vec<DecodedToken> = vec![];
    // By token and lane: location and first cycle.
    let mut open: BTreeMap<(usize, u64), (String, u64)> = BTreeMap::new();
    let mut retired = 0;
    for line in lines {
        let words: Vec<&str> = line.split('\t').collect();
        let number = |i: usize| words[i].parse::<u64>().unwrap();
        if words[0] == "C" {
            assert!(number(1) > 0, "{line}");
            now += number(1);
            continue;
        }
        let id = number(1) as usize;
        match words[0] {
            "I" => {
                assert_eq!(id, tokens.len(), "numbers follow each other");
                tokens.push(DecodedToken::default());
            }
            "L" if words[2] == "0" => tokens[id].label += words[3],
            "L" => tokens[id].hover.extend(words[3].split("\\n").map(str::to_owned)),
            "S" => assert_eq!(open.insert((id, number(2)), (words[3].into(), now)), None, "{line} at {now}"),
            "E" => {
                let (name, from) = open.remove(&(id, number(2))).unwrap();
                assert_eq!(name, words[3]);
                tokens[id].stages.push((number(2), name, from, now));
            }
            "R" => {
                assert_eq!(number(2), retired);
                retired += u64::from(words[3] == "0");
                assert!(tokens[id].end.replace((now, words[3] == "1")).is_none());
            }
            other => panic!("{other}"),
        }
    }
    assert!(open.is_empty(), "{open:?}");
    tokens
}

fn run() -> RunReport {
    let mut machine = PlanMachine::new(&samples::plan()).unwrap();
    run_with(&mut machine, Engine::Timed, None, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true })
}

fn written(board: &TimelineLayout, budget: &MemoryPool, tell: impl FnOnce(&mut TimelineProbe<'_>)) -> std::io::Result<String> {
    written_of(&run(), board, budget, tell)
}

fn written_of(
    run: &RunReport,
    board: &TimelineLayout,
    budget: &MemoryPool,
    tell: impl FnOnce(&mut TimelineProbe<'_>),
) -> std::io::Result<String> {
    let mut bytes = vec![];
    let last = board.diagram.stages.len() - 1;
    let mut watcher = TimelineProbe::new(board.clone(), vec![Box::new(KanataLog::new(&mut bytes, board, Some(last), budget))]);
    tell(&mut watcher);
    watcher.finish(run).into_iter().collect::<std::io::Result<()>>()?;
    Ok(String::from_utf8(bytes).unwrap())
}

fn life(number: u64) -> StepAttribution {
    StepAttribution {
        frame: Some(0),
        polygon: Some(4),
        life: Some(TokenLife { number, pixel: Some([3, 5]), pixels: 4 }),
        ..StepAttribution::default()
    }
}

fn add(watcher: &mut TimelineProbe<'_>, stage: usize, cause: Option<StallCause>, cycles: Range<u64>, whose: &StepAttribution) {
    watcher.add(Interval { stage, cause, from: Cycle(cycles.start), to: Cycle(cycles.end) }, whose);
}

/// Two stages next to each other, the second the last of all, and the FIFO between them.
fn pair(board: &TimelineLayout) -> ([usize; 2], String) {
    let last = board.diagram.stages.len() - 1;
    let fifo = board.diagram.fifos.iter().find(|fifo| fifo.ends[1] == last).unwrap();
    (fifo.ends, fifo.name.clone())
}

#[test]
fn a_token_goes_from_unit_to_unit_and_is_retired_or_flushed() {
    let board = samples::board();
    let ([before, last], fifo) = pair(&board);
    let text = written(&board, &MemoryPool::default(), |watcher| {
        add(watcher, before, Some(StallCause::Starved(0)), 0..2, &life(0));
        add(watcher, before, None, 2..5, &life(0));
        add(watcher, before, None, 5..6, &life(64));
        add(watcher, last, Some(StallCause::Memory(0)), 7..9, &life(0));
        add(watcher, last, None, 9..10, &life(0));
        add(watcher, last, None, 10..11, &StepAttribution::default());
    });
    let tokens = read(&text.unwrap());
    let [name_before, name_last] = [before, last].map(|stage| board.name(stage));
    let stall = format!("memory: {}", board.diagram.stages[last].clients.first().cloned().unwrap_or_default());
    let label = "frame 1, polygon 4, pixel 3, 5 and 3 more";
    let hover = [
        format!("{name_before}: from cycle 2, busy 3"),
        format!("{name_last}: from cycle 7, busy 1, {stall} 2"),
        format!("{name_before}: from cycle 5, busy 1"),
    ];
    let retired = DecodedToken {
        label: label.into(),
        hover: hover[..2].to_vec(),
        stages: vec![(0, name_before.clone(), 2, 5), (1, stall, 7, 9), (0, fifo, 5, 9), (0, name_last, 9, 10)],
        end: Some((10, false)),
    };
    let flushed = DecodedToken {
        label: label.into(),
        hover: hover[2..].to_vec(),
        stages: vec![(0, name_before, 5, 6)],
        end: Some((6, true)),
    };
    assert_eq!(tokens, [retired, flushed]);
}

/// Whether each of three tokens of a run is flushed; the second alone reaches the last stage.
fn flushed(run: &RunReport, board: &TimelineLayout) -> Vec<bool> {
    let ([before, last], _) = pair(board);
    let text = written_of(run, board, &MemoryPool::default(), |watcher| {
        (0..3).for_each(|k| add(watcher, before, None, 2 * k..2 * k + 2, &life(k)));
        add(watcher, last, None, 4..6, &life(1));
    });
    read(&text.unwrap()).iter().map(|token| token.end.unwrap().1).collect()
}

#[test]
fn token_that_leaves_the_window_is_not_flushed() {
    let (run, board) = (run(), samples::board());
    assert_eq!(flushed(&run, &board), [true, false, true]);
    assert_eq!(flushed(&run, &TimelineLayout { to: run.total, ..board.clone() }), [true, false, true]);
    assert_eq!(flushed(&run, &TimelineLayout { to: 8, ..board.clone() }), [true, false, false]);
    let mut first = board.clone();
    let ([before, _], _) = pair(&board);
    first.show_only(&[board.diagram.stages[before].name.clone()]).unwrap();
    assert_eq!(flushed(&run, &first), [false; 3]);
}

#[test]
fn token_in_flight_at_a_limit_is_not_flushed() {
    let cut = RunReport { outcome: Outcome::Limit, total: 9, ..run() };
    assert_eq!(flushed(&cut, &samples::board()), [true, false, false]);
}

#[test]
fn overlapping_unit_ends_when_the_next_begins() {
    let board = samples::board();
    let ([before, last], _) = pair(&board);
    let text = written(&board, &MemoryPool::default(), |watcher| {
        add(watcher, before, None, 2..8, &life(0));
        add(watcher, last, None, 4..6, &life(0));
    });
    let tokens = read(&text.unwrap());
    let names = [before, last].map(|stage| board.name(stage));
    assert_eq!(tokens[0].stages, [(0, names[0].clone(), 2, 4), (0, names[1].clone(), 4, 8)]);
}

#[test]
fn memory_limit_is_kept() {
    let board = samples::board();
    let few = |watcher: &mut TimelineProbe<'_>| {
        (0..1000).for_each(|k| add(watcher, 0, None, 2 * k..2 * k + 1, &life(k)));
    };
    let error = written(&board, &MemoryPool::new(10_000), few).unwrap_err();
    assert!(OverBudget::in_io_error(&error).is_some(), "{error}");
    assert_eq!(
        read(&written(&board, &MemoryPool::default(), few).unwrap()).len(),
        999,
        "the last begins behind the end of the run"
    );
}
