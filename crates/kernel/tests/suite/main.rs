//! The kernel: examples, labels, parts, steps in flight and the memory controller against DRAMsim3.

#[cfg(all(feature = "config", feature = "ticked"))]
mod dramsim3;
mod examples;
mod in_flight;
mod labels;
#[cfg(feature = "config")]
mod parts;
