//! Conformance tests of the kernel and of units, for development only.
//!
//! - [`contract`]: the promises of every unit, as tests of one unit between sources, sinks and memories.
//! - [`plan`]: machines built from a plan in JSON, to compare the kernel with other readings of the laws of time.
//!
//! The tests of this crate prove the laws of time that the documentation of `basrelief-kernel` states.

pub mod contract;
pub mod plan;
