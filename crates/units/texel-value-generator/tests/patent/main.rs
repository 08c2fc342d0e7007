//! What the patent's page says of the texel value generator (310) and the units around it.

mod chain;
mod contract;
mod figures;
mod lines;
mod mip;
mod read_back;
mod spans;
mod timing;
