//! The circuits together, without time: what the patent's page says of them. And of each unit its contract.

mod chain;
mod contract;
mod degenerate;
mod equations;
mod host;
mod short_cuts;
mod specular;
