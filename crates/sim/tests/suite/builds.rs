//! Recordings of other builds of the simulator stay readable, and say so.

use crate::common::CollectedRecording;
use basrelief_input::MemoryPool;
use basrelief_report::Report;
use basrelief_sim::{
    AnalysisPolicy, BUILD, MachineConfig, RecordedRun, Recording, RecordingError, ResimulateOptions, RunInput, RunOptions,
    doc_trace, resimulate_to, run, size_fifos,
};
use serde_json::{Value, json};
use std::io::{Cursor, Read};

fn recorded() -> (Report, Vec<u8>) {
    let options = RunOptions { recording: AnalysisPolicy::Always, exact: false, ..RunOptions::default() };
    let mut kept = CollectedRecording::default();
    let source = RunInput::trace(Cursor::new(doc_trace()), "quad.dl.jsonl");
    (run(source, &options, &mut kept, None).unwrap().report, kept.0)
}

/// Returns header and rest of a recording: a line, the letter `H`, the length of the header, the header, and blocks.
fn parts(recording: &[u8]) -> (Value, &[u8]) {
    let start = recording.iter().position(|byte| *byte == b'\n').unwrap() + 2;
    let (length, rest) = recording[start..].split_at(4);
    let (header, rest) = rest.split_at(u32::from_le_bytes(length.try_into().unwrap()) as usize);
    (serde_json::from_slice(header).unwrap(), rest)
}

/// Length of block `S`: a letter, a length, and a SHA-256.
const SEAL: usize = 1 + 4 + 32;

/// Returns the recording with another header, and without its seal, as earlier builds wrote it.
fn with_header(recording: &[u8], change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let (mut header, rest) = parts(recording);
    change(&mut header);
    let header = header.to_string();
    let rest = &rest[..rest.len() - SEAL];
    [b"basrelief-tape/1\nH", &(header.len() as u32).to_le_bytes()[..], header.as_bytes(), rest].concat()
}

fn of_another_build(recording: &[u8]) -> Vec<u8> {
    with_header(recording, |header| header["version"] = "0.1.0".into())
}

fn resimulated(recording: &[u8]) -> Result<(Report, Vec<u8>), RecordingError> {
    let mut kept = CollectedRecording::default();
    Ok((resimulate_to(&mut Cursor::new(recording), &ResimulateOptions::default(), &mut kept)?.report, kept.0))
}

#[test]
fn report_and_recording_state_their_build() {
    let (report, recording) = recorded();
    assert_eq!((report.build.as_str(), parts(&recording).0["version"].as_str()), (BUILD, Some(BUILD)));
    let (again, kept) = resimulated(&recording).unwrap();
    assert_eq!((again.to_json().unwrap(), kept), (report.to_json().unwrap(), recording));
}

// Claim: analysis: A recording with a changed header or result, or with data behind its end, is rejected.
#[test]
fn any_change_of_header_or_result_is_noticed() {
    let (_, recording) = recorded();
    let steps = parts(&recording).1;
    let length = u32::from_le_bytes(steps[1..5].try_into().unwrap()) as usize;
    let header = recording.len() - steps.len();
    assert_eq!((steps[0], steps[5 + length]), (b'R', b'E'), "the steps fit in one block");
    for place in (0..header).chain(header + 5 + length..recording.len()) {
        let mut changed = recording.clone();
        changed[place] ^= 1 << (place % 8);
        assert!(resimulated(&changed).is_err(), "byte {place} of {}", recording.len());
    }
    let error = |recording: &[u8]| resimulated(recording).unwrap_err().to_string();
    assert!(error(&[&recording[..], b"x"].concat()).contains("more data follow its end"));
    for missing in [1, SEAL - 1, SEAL] {
        assert!(error(&recording[..recording.len() - missing]).contains("truncated behind its result"), "{missing}");
    }
}

#[test]
fn recording_of_another_build_gives_report_with_warning() {
    let (mut report, recording) = recorded();
    let old = of_another_build(&recording);
    let (again, kept) = resimulated(&old).unwrap();
    let warning = format!("recording: build 0.1.0 of basrelief executed the steps, and build {BUILD} computed their timing");
    report.warnings.insert(0, warning.clone());
    assert_eq!(again, report);
    assert_eq!(parts(&kept).0["version"], "0.1.0", "a resimulation does not change who executed the steps");
    let in_memory = Recording::read(&mut Cursor::new(&old), &MemoryPool::default()).unwrap();
    assert_eq!(in_memory.resimulate(&MachineConfig::default()).unwrap(), report);
    let sizes = |recording: &[u8]| {
        let mut cursor = Cursor::new(recording.to_vec());
        size_fifos(vec![&mut cursor as &mut dyn Read], &[0.0], &MemoryPool::default()).unwrap().warnings
    };
    assert_eq!((sizes(&old), sizes(&recording)), (vec![warning], vec![]));
}

#[test]
fn other_timing_is_an_error_of_the_other_build() {
    let (mut report, recording) = recorded();
    let read =
        |report: &Report, recording: &[u8]| RecordedRun::read(report, &mut Cursor::new(recording), &MemoryPool::default()).err();
    assert!(read(&report, &recording).is_none() && read(&report, &of_another_build(&recording)).is_none());
    report.cycles.as_mut().unwrap().total += 1;
    assert!(matches!(read(&report, &recording), Some(RecordingError::OtherRun)));
    let error = read(&report, &of_another_build(&recording)).unwrap();
    assert!(matches!(&error, RecordingError::OtherBuild { build, .. } if build == "0.1.0"), "{error}");
    report.input.sha256.clear();
    assert!(matches!(read(&report, &of_another_build(&recording)), Some(RecordingError::OtherRun)));
}

#[test]
fn parameter_of_another_build_is_named_with_the_build() {
    let (_, recording) = recorded();
    let unknown = |header: &mut Value| {
        header["version"] = "0.1.0".into();
        header["given"]["settings"] = json!([["replacement.gone", "1"]]);
    };
    let error = resimulated(&with_header(&recording, unknown)).err().unwrap().to_string();
    assert!(error.starts_with("build 0.1.0 of basrelief made the recording") && error.contains("replacement.gone"), "{error}");
}
