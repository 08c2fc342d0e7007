//! The schema of one line.

use crate::command::TraceCommand;
use basrelief_signals::schema_of;

/// JSON schema (2020-12) of one line of a trace in JSON Lines.
pub fn schema() -> serde_json::Value {
    let mut schema = schema_of::<TraceCommand>("trace-1");
    schema.insert("title".into(), "One line of a Basrelief display list".into());
    schema.to_value()
}
