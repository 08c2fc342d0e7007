//! Plans and sweeps, without the command line.

mod exploring;
mod plans;
mod running;
mod sensitivity;
mod support;
