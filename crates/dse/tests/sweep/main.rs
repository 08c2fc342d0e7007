//! Plans and sweeps, without the command line.

mod exploring;
mod plan_errors;
mod plans;
mod running;
mod sensitivity;
mod support;
