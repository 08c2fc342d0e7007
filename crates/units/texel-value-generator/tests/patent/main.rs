//! Tests of the texel value generator (310) and the units around it against the patent.

mod chain;
mod contract;
mod figures;
mod lines;
mod mip;
mod read_back;
mod spans;
mod timing;
