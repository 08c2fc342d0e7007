//! The machines: each against its patent, what they share, and what documents say of the whole.

mod bump;
mod claims;
mod common;
mod defer;
mod display;
mod documents;
mod invariants;
mod library;
mod memories;
mod shade;
mod texel;
