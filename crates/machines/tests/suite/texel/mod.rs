//! Tests of the whole texture mapping system: engines, configurations, and statements of the patent.

mod claims;
mod engines;
mod recipe;
mod runs;
mod waiting;
mod width;
