//! Reading of untrusted input: a limit of memory, and JSON with errors in
//! plain words that does not accept lists as objects.

mod budget;
mod file;
mod json;
mod strict;
mod weight;
mod words;

pub use budget::{Budget, Growing, Held, OverBudget, Size, read_to_end};
pub use file::{beside, read_text};
pub use json::{JsonFault, from_slice, from_str};
pub use weight::json_weight;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
