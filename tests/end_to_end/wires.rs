//! `--rtl`: the log of everything that crosses the wires.

use crate::support::Place;
use std::collections::BTreeMap;

/// Returns the facts of a log by kind and number of stage or FIFO, each in order. Different kinds and stages may interleave in any order,
/// and answers of a step may come twice.
fn facts(log: &str) -> BTreeMap<(&str, &str), Vec<&str>> {
    let mut facts = BTreeMap::<_, Vec<_>>::new();
    for line in log.lines() {
        let (kind, rest) = line.split_once(' ').expect("a kind");
        let (number, fact) = rest.split_once(' ').unwrap_or((rest, ""));
        if ["W", "T", "V", "credits", "output", "table", "end"].contains(&kind) {
            facts.entry((kind, number)).or_default().push(fact);
        }
    }
    facts
}

#[test]
fn both_engines_write_the_same_wires() {
    let place = Place::new();
    for engine in ["timed", "ticked"] {
        place.ok(&format!("run PATCH --size 32x24 --quiet --no-exact --engine {engine} --rtl {engine}.wires"));
    }
    let [timed, ticked] = ["timed.wires", "ticked.wires"].map(|name| place.text(name));
    let facts_of_run = facts(&timed);
    assert_eq!(facts_of_run, facts(&ticked));
    let count =
        |wanted: &str| facts_of_run.iter().filter(|((kind, _), _)| *kind == wanted).map(|(_, facts)| facts.len()).sum::<usize>();
    assert_eq!(count("W"), count("T"), "each step has its cycles");
    let is_token = |word: &&str| word.split_once(':').is_some_and(|(output, _)| output.parse::<usize>().is_ok());
    let steps = facts_of_run.iter().filter(|((kind, _), _)| *kind == "W").flat_map(|(_, steps)| steps);
    let tokens = steps.map(|step| step.split(' ').filter(is_token).count()).sum::<usize>();
    assert!(tokens > 100);
    assert_eq!(tokens, count("V"), "each token becomes visible");
    assert_eq!(count("end"), 1);
}
