//! The rate-limited renderer as a whole: its engines, its modes, its views, and what the patent says of them.

#[path = "../common/mod.rs"]
mod common;
mod depth_of_layers;
mod embodiments;
mod engines;
mod modes;
mod path;
mod recipe;
mod runs;
