//! The command line: parses options, opens files and chooses exit codes.
//!
//! Exit codes: 0 success, 1 bad input or a failed check, 2 wrong usage, 128 + n after signal n.

// These macros panic if the stream is closed, and they bypass `terminal::safe`.
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

mod address_space;
mod args;
mod commands;
mod error;
mod input;
mod interrupt;
mod legacy;
mod outputs;
mod progress;
mod terminal;
mod views;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let (arguments, notes) = legacy::current_names(std::env::args_os());
    let cli = args::Cli::parse_from(arguments);
    notes.iter().for_each(|note| terminal::note(note));
    // Before any thread starts, because threads reserve address space: the limit must be the same in every run.
    let budget = address_space::budget(cli.memory_limit);
    input::set_allow_outside(cli.allow_outside);
    interrupt::listen();
    match commands::dispatch(cli, &budget) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal::note(&format!("error: {failure}"));
            ExitCode::from(failure.exit_code())
        }
    }
}
