//! Reading what strangers send: JSON whose objects are objects, with
//! errors in plain words.

mod json;
mod strict;
mod words;

pub use json::{JsonFault, from_slice, from_str};
