//! Traces: round trips, damaged files, the schema, and the memory that reading may take.

mod budget;
mod common;
mod malformed;
mod round_trip;
mod schema;
