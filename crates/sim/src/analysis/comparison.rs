//! Comparison of two runs: measures how much each group of parameters contributes to the difference in cycles.
//!
//! Timing parameters that differ are grouped by unit, memory, cache or FIFO. For each group, run B is resimulated with the group's values
//! of run A; the change in cycles is the contribution of the group. All other differences are work: the recording of A, resimulated
//! with all timing parameters of B, is B with the work of A. The remainder of the difference is the interaction of the groups.

use crate::recording::{LoadedRecording, RecordingError, netlist_of_same_work, of_build};
use basrelief_input::MemoryPool;
use basrelief_machines::{MachineConfig, MachineSpec, for_machine};
use basrelief_parameters::{Effect, Parameter};
use basrelief_report::compare::WORK;
use basrelief_report::{CauseShare, MeasuredCauses, Report};
use basrelief_threads as threads;
use std::io::Read;

/// Maximum number of FIFOs that have a group each. More FIFOs share one group.
const FIFOS: usize = 6;
/// Maximum number of passes that fix derived values.
const PASSES: usize = 4;

/// A run with its recording.
pub struct RecordedRun {
    recording: LoadedRecording,
    config: MachineConfig,
    cycles: u64,
}

impl RecordedRun {
    /// Reads the recording of the run with this report.
    ///
    /// # Errors
    /// An invalid recording, the recording of another run, or a recording of another build whose timing this build does not reproduce.
    pub fn read(report: &Report, reader: &mut dyn Read, budget: &MemoryPool) -> Result<Self, RecordingError> {
        let recording = LoadedRecording::read(reader, budget)?;
        let config = recording.config(&[])?;
        let cycles = report.frame_cycles();
        let is_of_run = (&recording.result.input, &recording.result.image) == (&report.input, &report.image);
        let is_of_report = config.machine().name == report.machine
            && is_of_run
            && config.to_value() == report.config
            && resimulated_cycles(&recording, &config) == Some(cycles);
        match is_of_report {
            true => Ok(Self { recording, config, cycles }),
            false if is_of_run => Err(of_build(&recording.build, RecordingError::OtherRun)),
            false => Err(RecordingError::OtherRun),
        }
    }
}

/// Explains the difference in cycles of `b` against `a`. Returns `None` if the machines are different.
pub fn explain(a: &RecordedRun, b: &RecordedRun) -> Option<MeasuredCauses> {
    if a.config.machine().name != b.config.machine().name {
        return None;
    }
    let (of_a, of_b) = (a.config.parameters(), b.config.parameters());
    let (timing, work): (Vec<_>, Vec<_>) =
        differing(&of_b, &of_a).into_iter().filter(|p| p.effect != Effect::Cost).partition(|p| p.effect == Effect::Timing);
    let mut shares = threads::par_map(groups(&timing), |(group, of_group)| {
        let set = options_for(b, &with_values(&of_b, &of_group));
        let cycles = set.as_ref().and_then(|(_, config)| resimulated_cycles(&b.recording, config));
        cause_share(group, set, cycles, b)
    });
    if !work.is_empty() || a.recording.work != b.recording.work {
        let timing: Vec<&Parameter> = of_b.iter().filter(|p| p.effect == Effect::Timing).collect();
        let cycles =
            options_for(a, &with_values(&of_a, &timing)).and_then(|(_, config)| resimulated_cycles(&a.recording, &config));
        shares.push(cause_share(WORK, options_for(b, &with_values(&of_b, &work)), cycles, b));
    }
    shares.sort_by_key(|share| std::cmp::Reverse(share.by.map(i64::unsigned_abs)));
    let counted: i64 = shares.iter().filter_map(|share| share.by).sum();
    Some(MeasuredCauses { shares, together: b.cycles as i64 - a.cycles as i64 - counted })
}

/// Settings, and the resulting configuration.
type NewConfig = (Vec<(String, String)>, MachineConfig);

fn cause_share(group: &str, set: Option<NewConfig>, cycles: Option<u64>, b: &RecordedRun) -> CauseShare {
    let set = set.map(|(set, _)| set).unwrap_or_default();
    CauseShare {
        group: group.to_owned(),
        set: set.into_iter().map(|(key, value)| format!("{key}={value}")).collect(),
        cycles,
        by: cycles.map(|cycles| b.cycles as i64 - cycles as i64),
    }
}

/// Returns the parameters of `target` whose values differ from `here`. Both lists are of the same machine.
fn differing<'a>(here: &[Parameter], target: &'a [Parameter]) -> Vec<&'a Parameter> {
    here.iter().zip(target).filter(|(here, target)| here.default != target.default).map(|(_, target)| target).collect()
}

/// Returns `these` with the values of `those`.
fn with_values(these: &[Parameter], those: &[&Parameter]) -> Vec<Parameter> {
    let over = |p: &Parameter| those.iter().find(|other| other.key == p.key).map_or_else(|| p.clone(), |p| (*p).clone());
    these.iter().map(over).collect()
}

/// StageGroups parameters, in the order of the block diagram.
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

/// Returns the group of a key: one memory, cache or FIFO, or otherwise the first component of the key.
fn group_of(key: &str) -> &str {
    let parts = if ["memory.", "cache.", "fifo."].iter().any(|kind| key.starts_with(kind)) { 2 } else { 1 };
    key.match_indices('.').nth(parts - 1).map_or(key, |(at, _)| &key[..at])
}

/// Returns the settings that give the parameters of a run these values. Derived values that would change, such as the cycles of a
/// memory that follow from its part, are set explicitly.
fn options_for(of: &RecordedRun, target: &[Parameter]) -> Option<NewConfig> {
    let (mut set, mut config) = (Vec::<(String, String)>::new(), of.config.clone());
    for _ in 0..PASSES {
        let here = config.parameters();
        let differing = differing(&here, target);
        if differing.is_empty() {
            return Some((set, config));
        }
        for parameter in differing {
            set.push((parameter.key.clone(), parameter.as_option()));
        }
        config = of.recording.config(&set).ok()?;
    }
    None
}

/// Returns the render cycles with these parameters; `None` if the machine would do other work or would not finish.
fn resimulated_cycles(recording: &LoadedRecording, config: &MachineConfig) -> Option<u64> {
    for_machine!(config, spec => cycles_as(recording, spec))
}

fn cycles_as<S: MachineSpec>(recording: &LoadedRecording, spec: &S) -> Option<u64> {
    let recorded: S = recording.overrides.load(&[]).ok()?;
    let netlist = netlist_of_same_work(&recorded, spec, recording.input).ok()?;
    recording.recording.cycles(netlist).ok()?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_grouped_by_component() {
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
