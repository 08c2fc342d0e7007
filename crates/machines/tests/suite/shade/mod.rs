//! Tests of the whole figure shading device: engines, configurations, paths, and statements of the patent.

mod engines;
mod patent;
mod recipe;
mod runs;
mod waiting;
