//! The exact renderer against mathematics, metrics and Mesa.

mod common;
mod mesa;
mod metrics;
mod pictures;
mod shading;
