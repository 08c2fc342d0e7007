//! Errors of traces, with their place and their cure.

use basrelief_input::OverBudget;
use std::fmt;
use std::io;

/// Place in a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TracePlace {
    /// JSON Lines: line, counted from 1, and column \[bytes, from 1\] if known.
    Line {
        /// Line number.
        line: u64,
        /// Column; `None` for the whole line.
        column: Option<usize>,
    },
    /// Binary form: record, counted from 1.
    Record(u64),
    /// While writing: command, counted from 1.
    Command(u64),
    /// The input as a whole: its first bytes.
    Start,
}

impl fmt::Display for TracePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { line, column: Some(column) } => write!(f, "line {line}, column {column}"),
            Self::Line { line, column: None } => write!(f, "line {line}"),
            Self::Record(record) => write!(f, "record {record}"),
            Self::Command(command) => write!(f, "command {command}"),
            Self::Start => write!(f, "start of the trace"),
        }
    }
}

/// Kind of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The reader or writer below failed; the trace may be in order.
    Io,
    /// The trace stops before its `end`.
    Truncated,
    /// The trace says something that is not allowed.
    Malformed,
    /// The trace may be in order, but this build cannot read or write it.
    Unsupported,
    /// The trace may be in order, but holds more than the budget allows.
    OverBudget,
}

/// An error in a trace. Its text names place, command, field, expectation and cure. The caller puts the name of the file
/// in front.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceError {
    /// Place.
    pub place: TracePlace,
    /// Kind.
    pub kind: ErrorKind,
    /// Command and field, such as `polygon.position[2]`; empty if the command is unknown.
    pub path: String,
    /// The value found, the value expected, and the cure.
    pub message: String,
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.place)?;
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for TraceError {}

impl TraceError {
    pub(crate) fn new(place: TracePlace, kind: ErrorKind, path: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place, kind, path: path.into(), message: message.into() }
    }

    /// A failed read. An end that the layer below did not expect (a compressed frame cut short) is a truncation.
    pub(crate) fn read(place: TracePlace, error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::UnexpectedEof {
            return Self::truncated(place, &format!("the input ends early ({error})"));
        }
        if let Some(error) = OverBudget::in_io_error(error) {
            return Self::over_budget(place, error);
        }
        Self::new(place, ErrorKind::Io, "", format!("cannot read: {error}"))
    }

    pub(crate) fn over_budget(place: TracePlace, error: &OverBudget) -> Self {
        Self::new(place, ErrorKind::OverBudget, "", error.to_string())
    }

    pub(crate) fn write(place: TracePlace, error: &io::Error) -> Self {
        Self::new(place, ErrorKind::Io, "", format!("cannot write: {error}"))
    }

    pub(crate) fn truncated(place: TracePlace, what: &str) -> Self {
        Self::new(place, ErrorKind::Truncated, "", format!("{what}: the trace is truncated; record or copy it again"))
    }
}

/// Fault of a command, without its place in the trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CommandFault {
    kind: ErrorKind,
    field: String,
    message: String,
}

impl CommandFault {
    pub(crate) fn new(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self { kind: ErrorKind::Malformed, field: field.into(), message: message.into() }
    }

    pub(crate) fn of_kind(mut self, kind: ErrorKind) -> Self {
        self.kind = kind;
        self
    }

    /// Fault of a field or a command that exceeds the memory limit.
    pub(crate) fn over_budget(field: &'static str) -> impl Fn(OverBudget) -> Self {
        move |error| Self::new(field, error.to_string()).of_kind(ErrorKind::OverBudget)
    }

    /// The error of command `name` at `place`.
    pub(crate) fn at(self, place: TracePlace, name: &str) -> TraceError {
        let dot = if self.field.is_empty() { "" } else { "." };
        TraceError::new(place, self.kind, format!("{name}{dot}{}", self.field), self.message)
    }
}
