//! `basrelief schema`: JSON schemas.

use super::plans::view_schema;
use crate::args::{SchemaArgs, SchemaName};
use crate::error::{CommandResult, print};
use crate::views;
use basrelief_dse::plan_schema;
use basrelief_signals::{Camera, schema_of};

/// Prints a schema.
pub fn schema(args: &SchemaArgs) -> CommandResult {
    let schema = match args.of {
        SchemaName::Trace => basrelief_trace::schema(),
        SchemaName::Report => basrelief_report::schema(),
        SchemaName::Config => args.machine.schema(),
        SchemaName::Camera => schema_of::<Camera>("camera-1").to_value(),
        SchemaName::Views => views::schema(),
        SchemaName::Plan => plan_schema(args.machine, &view_schema()),
    };
    print(&format!("{schema:#}\n"))
}
