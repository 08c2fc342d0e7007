//! The kernel against its laws: by hand, by vectors, by random plans.

mod common;
mod contract;
mod critical_path;
mod deep_fifos;
mod hand;
mod hidden_deliveries;
mod laws;
mod plans;
mod properties;
mod recording;
mod vectors;
mod wiring;
