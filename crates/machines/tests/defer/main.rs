//! Tests of the whole rate-limited renderer: engines, modes, views, and statements of the patent.

#[path = "../common/mod.rs"]
mod common;
mod depth_of_layers;
mod embodiments;
mod engines;
mod modes;
mod path;
mod recipe;
mod runs;
