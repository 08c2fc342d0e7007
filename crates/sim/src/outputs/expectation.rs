//! Expectations: results of a replay that a trace states.

use basrelief_report::Report;
use basrelief_trace::{ExpectedResults, ExpectedTraffic, ParameterValue};
use std::collections::BTreeMap;

/// Returns the expectation that this report meets, under these settings.
pub fn expectation_of(report: &Report, config: BTreeMap<String, ParameterValue>) -> ExpectedResults {
    let traffic = |c: &basrelief_report::model::Client| ExpectedTraffic { read_bytes: c.read_bytes, write_bytes: c.write_bytes };
    ExpectedResults {
        machine: Some(report.machine.clone()),
        config,
        cycles: report.cycles.as_ref().map(|c| c.total),
        frames: report.cycles.as_ref().map(|c| c.frames.clone()).unwrap_or_default(),
        memories: (report.memories.iter().flatten())
            .map(|(name, m)| (name.clone(), m.clients.iter().map(|(client, c)| (client.clone(), traffic(c))).collect()))
            .collect(),
        images: report.image.iter().filter_map(|i| i.sha256.parse().ok()).collect(),
    }
}

/// Compares a report with an expectation, and returns one sentence per difference. Values that the expectation omits are not checked.
pub fn check_expectation(expected: &ExpectedResults, report: &Report) -> Vec<String> {
    let found = expectation_of(report, expected.config.clone());
    let mut wrong = Vec::new();
    if expected.machine.as_ref().is_some_and(|m| *m != report.machine) {
        wrong.push(format!("machine {}, expected {}", report.machine, expected.machine.as_deref().unwrap_or("")));
    }
    if expected.cycles.is_some() && expected.cycles != found.cycles {
        wrong.push(format!("cycles {}, expected {}", cycles_text(found.cycles), cycles_text(expected.cycles)));
    }
    compare_lists("frames", &expected.frames, &found.frames, &mut wrong);
    compare_lists("images", &expected.images, &found.images, &mut wrong);
    for (memory, clients) in &expected.memories {
        for (client, e) in clients {
            let f = found.memories.get(memory).and_then(|m| m.get(client));
            if f != Some(e) {
                let f = f.map_or("none".into(), |f| format!("{} read, {} written", f.read_bytes, f.write_bytes));
                wrong.push(format!("bytes of {memory}.{client}: {f}; expected {} read, {} written", e.read_bytes, e.write_bytes));
            }
        }
    }
    wrong
}

fn cycles_text(cycles: Option<u64>) -> String {
    cycles.map_or("none".into(), |c| c.to_string())
}

/// Compares lists, unless the expected list is empty.
fn compare_lists<T: PartialEq + std::fmt::Display>(what: &str, expected: &[T], found: &[T], wrong: &mut Vec<String>) {
    if expected.is_empty() || expected == found {
        return;
    }
    let at = expected.iter().zip(found).position(|(e, f)| e != f).unwrap_or(expected.len().min(found.len()));
    let show = |list: &[T]| list.get(at).map_or("none".into(), T::to_string);
    wrong.push(format!("{what}: number {at} is {}, expected {}", show(found), show(expected)));
}
