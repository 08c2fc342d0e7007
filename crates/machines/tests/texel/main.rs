//! The texture mapping system as a whole: its engines, its configurations, and what the patent says of it.

mod claims;
#[path = "../common/mod.rs"]
mod common;
mod engines;
mod recipe;
mod runs;
mod width;
