//! The command line: a thin layer that parses options, opens files and decides exit codes.
//!
//! 0 success, 1 bad input or a failed check, 2 wrong usage, 130 interrupted.

mod address_space;
mod args;
mod commands;
mod error;
mod input;
mod interrupt;
mod outputs;
mod progress;
mod views;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = args::Cli::parse();
    // In front of all threads, which take address space at times of their own: the same budget in every run.
    let budget = address_space::budget(cli.memory_limit);
    input::set_allow_outside(cli.allow_outside);
    interrupt::listen();
    match commands::dispatch(cli, &budget) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
