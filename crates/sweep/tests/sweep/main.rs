//! Plans and sweeps, without the command line.

mod plans;
mod running;
mod support;
