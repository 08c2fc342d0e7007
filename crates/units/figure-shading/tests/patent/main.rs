//! The circuits together, without time: what the patent's page says of them. And of each unit its contract.

mod chain;
mod contract;
mod costs;
mod degenerate;
mod equations;
mod host;
mod said;
mod short_cuts;
mod specular;
