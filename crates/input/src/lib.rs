//! Reading of untrusted input: a limit of memory, and JSON with errors in
//! plain words that does not accept lists as objects.

mod error_text;
mod file;
mod json;
mod json_path;
mod memory_pool;
mod reject_seq;
mod weight;

pub use error_text::{TextFormat, plain_message};
pub use file::{open_in_folder, read_text};
pub use json::{JsonFault, fault_offset, from_slice, from_str, from_str_with_ignored};
pub use json_path::{JsonPath, JsonStep, field_range};
pub use memory_pool::{ByteSize, CountedBuffer, MemoryPool, MemoryReservation, OverBudget, read_to_end};
pub use weight::json_weight;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
