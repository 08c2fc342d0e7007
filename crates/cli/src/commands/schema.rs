//! `basrelief schema`: JSON schemas.

use crate::args::{SchemaArgs, SchemaName};
use crate::error::{CommandResult, print};
use basrelief_signals::{Camera, schema_of};

/// Prints a schema.
pub fn schema(args: &SchemaArgs) -> CommandResult {
    let schema = match args.of {
        SchemaName::Trace => basrelief_trace::schema(),
        SchemaName::Report => basrelief_report::schema(),
        SchemaName::Config => args.machine.schema(),
        SchemaName::Camera => schema_of::<Camera>().to_value(),
    };
    print(&format!("{schema:#}\n"))
}
