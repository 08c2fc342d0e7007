//! What no single parameter's range can say, as every machine finds it.

use basrelief_kernel::{FifoConfig, Machine, WiringError, check_wiring};

/// Parameters that do not fit together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{key}`: {message}")]
pub struct ConfigProblem {
    /// The parameter to change.
    pub key: String,
    /// What is wrong, what was expected, what to do.
    pub message: String,
}

/// The machine as it is built, its wiring checked. Where a memory has fewer credits than a step needs (law 3), its parameter
/// is at fault.
pub(crate) fn wired<M: Machine>(mut machine: M) -> Result<M, ConfigProblem> {
    let Err(error) = check_wiring(&mut machine) else { return Ok(machine) };
    let (key, message) = match &error {
        WiringError::TooFewCredits { memory, port, needed, outstanding, .. } => (
            format!("memory.{memory}.outstanding"),
            format!("is {outstanding}, but one step needs {needed} requests on port `{port}`; set it to {needed} or more"),
        ),
        other => ("wiring".into(), other.to_string()),
    };
    Err(ConfigProblem { key, message })
}

/// `key` is at fault.
pub(crate) fn problem(key: &str, message: String) -> Result<(), ConfigProblem> {
    Err(ConfigProblem { key: key.into(), message })
}

/// Lines of the cache `name` are a power of two.
pub(crate) fn line_is_power_of_two(name: &str, line_bytes: u32) -> Result<(), ConfigProblem> {
    if line_bytes.is_power_of_two() {
        return Ok(());
    }
    problem(&format!("cache.{name}.line_bytes"), format!("is {line_bytes}, expected a power of two"))
}

/// A FIFO, the latency of the unit that fills it \[cycles\], and the least cycles between two of that unit's tokens.
pub(crate) struct Feed<'a> {
    pub(crate) name: &'a str,
    pub(crate) fifo: &'a FifoConfig,
    pub(crate) latency: u32,
    pub(crate) occupancy: u32,
}

impl<'a> Feed<'a> {
    /// Filled by a unit that may emit in every cycle.
    pub(crate) fn new(name: &'a str, fifo: &'a FifoConfig, latency: u32) -> Self {
        Self { name, fifo, latency, occupancy: 1 }
    }

    /// Says that the FIFO cannot hold full rate (law 2), and the rate that it allows.
    pub(crate) fn warning(&self) -> Option<String> {
        let held = u64::from(self.latency) + u64::from(self.fifo.latency) + 1;
        let (needed, depth) = (held.div_ceil(u64::from(self.occupancy.max(1))), u64::from(self.fifo.depth));
        (depth < needed).then(|| {
            format!(
                "fifo.{}.depth = {depth} allows {depth} tokens in {held} cycles (unit latency {} + FIFO latency {} + 1); full rate needs {needed}",
                self.name, self.latency, self.fifo.latency
            )
        })
    }
}
