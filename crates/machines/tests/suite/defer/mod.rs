//! Tests of the whole rate-limited renderer: engines, modes, views, and statements of the patent.

mod depth_of_layers;
mod embodiments;
mod engines;
mod modes;
mod path;
mod recipe;
mod runs;
