//! The bump-mapping processor as a whole: its engines, its configurations, and what the patent claims for it.

mod chain;
mod claims;
#[path = "../common/mod.rs"]
mod common;
mod engines;
mod memories;
mod promise;
mod recipe;
mod runs;
mod textures;
mod variants;
