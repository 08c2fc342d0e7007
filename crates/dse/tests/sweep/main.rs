//! Plans and sweeps, without the command line.

mod plans;
mod running;
mod sensitivity;
mod support;
