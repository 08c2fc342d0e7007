//! Errors and warnings of all machines about parameters that do not fit together.

use crate::front::FRONT_UNITS;
use basrelief_kernel::stats::{SlowFifo, UnitStats};
use basrelief_kernel::{BoundStage, Machine, Visitor, WiringError, check_wiring};

/// Parameters that do not fit together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{key}`: {message}")]
pub struct ConfigProblem {
    /// The parameter to change.
    pub key: String,
    /// Error, expectation and cure.
    pub message: String,
}

/// Checks the wiring of a new machine, and idealizes the units in a comma-separated list. If a memory has fewer credits than a step needs (law 3), the error names
/// the parameter of that memory.
pub(crate) fn wired<M: Machine>(mut machine: M, ideal_units: &str) -> Result<M, ConfigProblem> {
    let Err(error) = check_wiring(&mut machine) else {
        return make_ideal(&mut machine, ideal_units).map(|()| machine);
    };
    let (key, message) = match &error {
        WiringError::TooFewCredits { memory, port, needed, outstanding, .. } => (
            format!("memory.{memory}.outstanding"),
            format!("is {outstanding}, but one step needs {needed} requests on port `{port}`; set it to {needed} or more"),
        ),
        other => ("wiring".into(), other.to_string()),
    };
    Err(ConfigProblem { key, message })
}

/// Idealizes units. `names` is a comma-separated list. It may name the units of the other kind of input, so that one configuration serves
/// scenes and traces.
fn make_ideal(machine: &mut impl Machine, names: &str) -> Result<(), ConfigProblem> {
    /// Units to idealize, and all units.
    struct UnitIdealizer<'a>(Vec<&'a str>, Vec<String>);
    impl UnitIdealizer<'_> {
        /// Records a unit. Returns true if it is to be idealized.
        fn wants(&mut self, unit: &str) -> bool {
            self.1.push(unit.into());
            self.0.contains(&unit)
        }
    }
    impl Visitor for UnitIdealizer<'_> {
        fn stage<P: BoundStage>(&mut self, mut place: P) {
            let (stage, _) = place.open();
            if self.wants(stage.name()) {
                stage.make_ideal();
            }
        }
    }
    let wanted: Vec<&str> = names.split(',').map(str::trim).filter(|name| !name.is_empty()).collect();
    let mut visitor = UnitIdealizer(wanted, vec![]);
    machine.wire(&mut visitor);
    let UnitIdealizer(wanted, all) = visitor;
    let is_unit = |name: &str| all.iter().any(|unit| unit == name) || FRONT_UNITS.contains(&name);
    match wanted.iter().find(|name| !is_unit(name)) {
        Some(name) => problem("ideal.units", format!("has `{name}`, expected units of this machine: {}", all.join(", "))),
        None => Ok(()),
    }
}

/// Returns an error of parameter `key`.
pub(crate) fn problem(key: &str, message: String) -> Result<(), ConfigProblem> {
    Err(ConfigProblem { key: key.into(), message })
}

/// Checks that the line size of cache `name` is a power of two.
pub(crate) fn line_is_power_of_two(name: &str, line_bytes: u32) -> Result<(), ConfigProblem> {
    if line_bytes.is_power_of_two() {
        return Ok(());
    }
    problem(&format!("cache.{name}.line_bytes"), format!("is {line_bytes}, expected a power of two"))
}

/// Returns a warning if a part of a latency is longer than the latency.
pub(crate) fn longer_part((part, cycles): (&str, u32), (whole, latency): (&str, u32)) -> Option<String> {
    (cycles > latency).then(|| format!("{part} = {cycles} counts as {latency}, because it is a part of {whole} = {latency}"))
}

/// Returns a warning if polygons have a normal map. Machines without normal maps call this function.
pub fn unused_normal_maps(facts: &UnitStats) -> Option<String> {
    let mapped = facts.count("bump_polygons");
    (mapped > 0).then(|| format!("{mapped} polygons have a normal map; the device has no normal maps and leaves it out"))
}

/// Returns a warning for each FIFO that cannot sustain full throughput (law 2), with the throughput that it allows. Memory latency is not
/// considered.
pub fn slow_fifos(facts: &UnitStats) -> Vec<String> {
    let sentence = |slow: &SlowFifo| {
        let SlowFifo { name, depth, needed, unit_latency, fifo_latency } = slow;
        let (held, tokens) = (slow.slot_cycles(), if *depth == 1 { "token" } else { "tokens" });
        format!(
            "fifo.{name}.depth = {depth} allows {depth} {tokens} in {held} cycles (unit latency {unit_latency} + FIFO latency {fifo_latency} + 1); full throughput needs a depth of {needed}"
        )
    };
    facts.slow_fifos().iter().map(sentence).collect()
}
