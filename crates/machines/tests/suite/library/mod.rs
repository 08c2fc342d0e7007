//! The library's own interface: parameters, schemas, block diagrams and units.

mod configuration_schema;
mod connections;
mod diagram;
mod leaving;
mod neighbours;
mod parameter_info;
mod registry;
mod units;
