//! Tests of the circuits together, without time, against the patent, and of the contract of each unit.

mod chain;
mod contract;
mod costs;
mod degenerate;
mod equations;
mod host;
mod said;
mod short_cuts;
mod specular;
