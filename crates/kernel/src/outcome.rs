//! How a run ended, as data. Its text is made where it is shown.

use std::fmt;

/// How a run ended (law 8).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Sources exhausted, FIFOs empty, no unit holds tokens.
    Complete,
    /// Nothing can ever start again, and something is left.
    Deadlock(Deadlock),
    /// The limit of cycles was reached.
    Limit,
    /// The caller stopped it.
    Stopped,
    /// A unit could not go on, and says why; or the wiring is wrong.
    Fault(String),
}

/// Who waits for whom, for ever. Displays as one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Deadlock {
    /// Cycles until nothing moved any more.
    pub total: u64,
    /// Every unit that waits, in the order of the wiring.
    pub stuck: Vec<BlockedUnit>,
    /// Units each of which waits for the next, and the last for the first; empty where they wait for tokens that will never
    /// come.
    pub circle: Vec<String>,
}

/// A unit that cannot go on. Displays as a clause: what it waits for, and how full that is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockedUnit {
    /// The unit.
    pub unit: String,
    /// What it waits for.
    pub waits_for: WaitsFor,
}

/// What a unit waits for.
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

/// How full a FIFO is. Displays as `` `name` (2 of 4 slots)``.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoLevel {
    /// The FIFO.
    pub fifo: String,
    /// Slots held.
    pub held: usize,
    /// Slots there are.
    pub depth: usize,
}

impl Deadlock {
    /// Whether any unit waits for a slot.
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

/// The first circle in `waits`: for each stage, the one that it waits for, if any.
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
