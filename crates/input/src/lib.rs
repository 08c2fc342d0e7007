//! Reading what strangers send: a budget for what a file may make us hold, and JSON whose objects are objects, with
//! errors in plain words.

mod budget;
mod json;
mod strict;
mod words;

pub use budget::{Budget, OverBudget};
pub use json::{JsonFault, from_slice, from_str};
