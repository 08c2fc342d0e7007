//! Errors of a plan, with the field and the line.

use basrelief_parameters::at_line;

/// Error of a field of a plan.
#[derive(Debug)]
pub(super) struct PlanFault {
    /// Dotted name of the field. A number selects one of several blocks: `zip.0.fifo.pixels.depth`.
    field: String,
    /// Place, error, expectation and cure.
    message: String,
}

impl PlanFault {
    pub(super) fn new(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self { field: field.into(), message: message.into() }
    }

    /// Adds the number of the block, from 0, to a field of a list of blocks.
    pub(super) fn in_block(self, number: usize) -> Self {
        let field = match self.field.split_once('.') {
            Some((list, rest)) => format!("{list}.{number}.{rest}"),
            None => format!("{}.{number}", self.field),
        };
        Self { field, ..self }
    }

    /// Returns the message, after the line of the field in the text of the plan.
    pub(super) fn at_line(self, plan: &str) -> String {
        at_line(plan, Some(&self.field), self.message)
    }
}

/// A message that begins with its field and a colon.
impl From<String> for PlanFault {
    fn from(message: String) -> Self {
        let field = message.split(':').next().unwrap_or_default();
        Self::new(field, message.clone())
    }
}
