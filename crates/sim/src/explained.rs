//! What explains the difference of two runs, measured: the tape of one is timed again with a part of the other's parameters.
//!
//! Parameters that change times only and differ are put in groups, by what they belong to. Of each, run B is timed with this group as A
//! has it: what that changes is its share. All the rest is work: A's tape, timed with all times of B, is B with the work of A. Shares
//! need not sum to the difference: what is left changes only together.

use crate::machines::{MachineConfig, MachineSpec, for_machine};
use crate::tape::{Loaded, TapeFileError, same_work};
use basrelief_input::Budget;
use basrelief_parameters::{Effect, Parameter};
use basrelief_report::compare::WORK;
use basrelief_report::{Explained, Report, Share};
use basrelief_threads as threads;
use std::io::Read;

/// Most FIFOs that are told apart.
const FIFOS: usize = 6;
/// How often values that follow from others are looked for, until none is left that should not change.
const LOOKS: usize = 4;

/// A run whose tape is there.
pub struct Taped {
    tape: Loaded,
    config: MachineConfig,
    cycles: u64,
}

impl Taped {
    /// Reads the tape of the run that this report tells of.
    ///
    /// # Errors
    /// A tape that is none, or of another run.
    pub fn read(report: &Report, reader: &mut dyn Read, budget: &Budget) -> Result<Self, TapeFileError> {
        let tape = Loaded::read(reader, budget)?;
        let config = tape.config()?;
        let cycles = report.frame_cycles();
        let is_of_report = config.machine().name == report.machine
            && config.to_value() == report.config
            && (&tape.ended.input, &tape.ended.image) == (&report.input, &report.image)
            && timed_as(&tape, &config) == Some(cycles);
        if is_of_report { Ok(Self { tape, config, cycles }) } else { Err(TapeFileError::OtherRun) }
    }
}

/// What explains how many cycles more or fewer `b` takes than `a`; nothing, where these are two machines.
pub fn explain(a: &Taped, b: &Taped) -> Option<Explained> {
    if a.config.machine().name != b.config.machine().name {
        return None;
    }
    let (of_a, of_b) = (a.config.parameters(), b.config.parameters());
    let (timing, work): (Vec<_>, Vec<_>) = differing(&of_b, &of_a).into_iter().partition(|p| p.effect == Effect::Timing);
    let mut shares = threads::map(groups(&timing), |(group, of_group)| {
        let set = options(b, &with(&of_b, &of_group));
        let cycles = set.as_ref().and_then(|(_, config)| timed_as(&b.tape, config));
        share(group, set, cycles, b)
    });
    if !work.is_empty() || a.tape.work != b.tape.work {
        let timing: Vec<&Parameter> = of_b.iter().filter(|p| p.effect == Effect::Timing).collect();
        let cycles = options(a, &with(&of_a, &timing)).and_then(|(_, config)| timed_as(&a.tape, &config));
        shares.push(share(WORK, options(b, &with(&of_b, &work)), cycles, b));
    }
    shares.sort_by_key(|share| std::cmp::Reverse(share.by.map(i64::unsigned_abs)));
    let counted: i64 = shares.iter().filter_map(|share| share.by).sum();
    Some(Explained { shares, together: b.cycles as i64 - a.cycles as i64 - counted })
}

/// Options, and the configuration that they come to.
type Set = (Vec<(String, String)>, MachineConfig);

fn share(group: &str, set: Option<Set>, cycles: Option<u64>, b: &Taped) -> Share {
    let set = set.map(|(set, _)| set).unwrap_or_default();
    Share {
        group: group.to_owned(),
        set: set.into_iter().map(|(key, value)| format!("{key}={value}")).collect(),
        cycles,
        by: cycles.map(|cycles| b.cycles as i64 - cycles as i64),
    }
}

/// Parameters of `target` that have another value than they have here; both are of one machine.
fn differing<'a>(here: &[Parameter], target: &'a [Parameter]) -> Vec<&'a Parameter> {
    here.iter().zip(target).filter(|(here, target)| here.default != target.default).map(|(_, target)| target).collect()
}

/// These parameters, with those over them.
fn with(these: &[Parameter], those: &[&Parameter]) -> Vec<Parameter> {
    let over = |p: &Parameter| those.iter().find(|other| other.key == p.key).map_or_else(|| p.clone(), |p| (*p).clone());
    these.iter().map(over).collect()
}

/// What each parameter belongs to, and the parameters, in the order of the block diagram.
fn groups<'a>(parameters: &[&'a Parameter]) -> Vec<(&'a str, Vec<&'a Parameter>)> {
    let mut groups: Vec<(&str, Vec<&Parameter>)> = Vec::new();
    let fifos = parameters.iter().map(|p| group_of(&p.key)).filter(|group| group.starts_with("fifo."));
    let mut fifos: Vec<&str> = fifos.collect();
    fifos.dedup();
    for parameter in parameters {
        let group = match group_of(&parameter.key) {
            fifo if fifo.starts_with("fifo.") && fifos.len() > FIFOS => "fifo",
            group => group,
        };
        match groups.iter_mut().find(|(name, _)| *name == group) {
            Some((_, members)) => members.push(parameter),
            None => groups.push((group, vec![parameter])),
        }
    }
    groups
}

/// One memory, cache or FIFO; otherwise the first part of a key.
fn group_of(key: &str) -> &str {
    let parts = if ["memory.", "cache.", "fifo."].iter().any(|kind| key.starts_with(kind)) { 2 } else { 1 };
    key.match_indices('.').nth(parts - 1).map_or(key, |(at, _)| &key[..at])
}

/// The options over those of a run with which its parameters have these values. What follows from a parameter that is set, such as
/// cycles of a memory from its part, is set too where it would change.
fn options(of: &Taped, target: &[Parameter]) -> Option<Set> {
    let (mut set, mut config) = (Vec::<(String, String)>::new(), of.config.clone());
    for _ in 0..LOOKS {
        let here = config.parameters();
        let differing = differing(&here, target);
        if differing.is_empty() {
            return Some((set, config));
        }
        for parameter in differing {
            set.push((parameter.key.clone(), parameter.as_option()));
        }
        config = of.tape.config_with(&set).ok()?;
    }
    None
}

/// Cycles of the frames of a tape with these parameters; none where its machine would do other work, or not come to its end.
fn timed_as(tape: &Loaded, config: &MachineConfig) -> Option<u64> {
    for_machine!(config, spec => timed_on(tape, spec))
}

fn timed_on<S: MachineSpec>(tape: &Loaded, spec: &S) -> Option<u64> {
    let recorded: S = tape.given.load(&[]).ok()?;
    let shape = same_work((&recorded, spec), tape.way).ok()?;
    tape.tape.cycles(shape).ok()?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_put_together_by_what_they_belong_to() {
        let parameter = |key: &str| Parameter { key: key.into(), ..MachineConfig::default().parameters().swap_remove(0) };
        let grouped = |keys: &[&str]| {
            let parameters: Vec<Parameter> = keys.iter().map(|key| parameter(key)).collect();
            let groups = groups(&parameters.iter().collect::<Vec<_>>());
            groups.into_iter().map(|(name, members)| format!("{name} {}", members.len())).collect::<Vec<_>>()
        };
        let some = ["fifo.a.depth", "fifo.a.latency", "memory.x.cl", "memory.y.cl", "memory.x.rp", "cache.x.ways", "ideal.units"];
        assert_eq!(grouped(&some), ["fifo.a 2", "memory.x 2", "memory.y 1", "cache.x 1", "ideal 1"]);
        let fifos =
            ["fifo.a.depth", "fifo.b.depth", "fifo.c.depth", "fifo.d.depth", "fifo.e.depth", "fifo.f.depth", "fifo.g.depth"];
        assert_eq!(grouped(&fifos[1..]).len(), 6);
        assert_eq!(grouped(&fifos), ["fifo 7"]);
    }
}
