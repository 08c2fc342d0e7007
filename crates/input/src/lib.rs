//! Reading what strangers send: a budget of memory for it; JSON whose
//! objects are objects, with errors in plain words.

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
