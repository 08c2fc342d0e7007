//! The figure shading device as a whole: its engines, its configurations, its paths, and what the patent says of them.

#[path = "../common/mod.rs"]
mod common;
mod engines;
mod patent;
mod recipe;
mod runs;
