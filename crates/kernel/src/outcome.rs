//! The outcome of a run, as data. The code that shows it makes the text.

use std::fmt;

/// The outcome of a run (law 8).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Sources exhausted, FIFOs empty, no unit holds tokens.
    Complete,
    /// No step can ever start again, and tokens are left.
    Deadlock(Deadlock),
    /// The limit of cycles was reached.
    Limit,
    /// The caller stopped it.
    Stopped,
    /// A unit could not continue and states why, or the wiring is invalid.
    Fault(String),
}

/// The waits of a deadlock. Displays as one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Deadlock {
    /// Cycles until the last event.
    pub total: u64,
    /// Every waiting unit, in the order of the wiring.
    pub stuck: Vec<BlockedUnit>,
    /// Units that each wait for the next, and the last for the first; empty if they wait for tokens that will never come.
    pub circle: Vec<String>,
}

/// A unit that cannot continue. Displays as a clause with the FIFO or port that it waits for and its fill level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockedUnit {
    /// The unit.
    pub unit: String,
    /// The resource that it waits for.
    pub waits_for: WaitsFor,
}

/// The resource that a unit waits for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WaitsFor {
    /// A token.
    Token(FifoLevel),
    /// A slot.
    Slot(FifoLevel),
    /// A credit or an answer.
    Memory {
        /// The port.
        port: String,
    },
}

/// Fill level of a FIFO. Displays as `` `name` (2 of 4 slots)``.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoLevel {
    /// The FIFO.
    pub fifo: String,
    /// Slots in use.
    pub held: usize,
    /// Total number of slots.
    pub depth: usize,
}

impl Deadlock {
    /// Returns true if any unit waits for a slot.
    pub fn is_any_full(&self) -> bool {
        self.stuck.iter().any(|stuck| matches!(stuck.waits_for, WaitsFor::Slot(_)))
    }
}

impl fmt::Display for Deadlock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "deadlock after {} cycles: ", self.total)?;
        for (i, stuck) in self.stuck.iter().enumerate() {
            write!(f, "{}{stuck}", if i == 0 { "" } else { "; " })?;
        }
        f.write_str(if self.is_any_full() {
            ". Give the FIFO that is full more slots (fifo.<name>.depth)"
        } else {
            ". No FIFO is full: a unit holds tokens back for others that never came"
        })
    }
}

impl fmt::Display for BlockedUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` waits for ", self.unit)?;
        match &self.waits_for {
            WaitsFor::Token(fill) => write!(f, "a token from {fill}"),
            WaitsFor::Slot(fill) => write!(f, "a slot in {fill}"),
            WaitsFor::Memory { port } => write!(f, "memory port `{port}`"),
        }
    }
}

impl fmt::Display for FifoLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` ({} of {} slots)", self.fifo, self.held, self.depth)
    }
}

/// Returns the first circle in `waits`, which holds for each stage the stage that it waits for.
pub(crate) fn circle(waits: &[Option<usize>]) -> Vec<usize> {
    for first in 0..waits.len() {
        let mut path = vec![first];
        let mut at = first;
        while let Some(next) = waits[at] {
            if let Some(begin) = path.iter().position(|&stage| stage == next) {
                return path.split_off(begin);
            }
            path.push(next);
            at = next;
        }
    }
    Vec::new()
}
