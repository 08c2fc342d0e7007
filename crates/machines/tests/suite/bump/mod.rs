//! Tests of the whole bump-mapping processor: engines, configurations, and claims of the patent.

mod chain;
mod claims;
mod engines;
mod memories;
mod promise;
mod recipe;
mod runs;
mod textures;
mod variants;
mod waiting;
