//! The command line: parses options, opens files and chooses exit codes.
//!
//! Exit codes: 0 success, 1 bad input or a failed check, 2 wrong usage, 128 + n after signal n.

// These macros panic if the stream is closed, and they bypass `terminal::safe`.
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

mod address_space;
mod args;
mod clock;
mod commands;
mod error;
mod global;
mod input;
mod inputs_read;
mod interrupt;
mod legacy;
mod outputs;
mod progress;
mod scene_input;
mod terminal;
mod views;

use clap::FromArgMatches;
use std::process::ExitCode;

fn main() -> ExitCode {
    let _start = clock::seconds();
    let (arguments, notes) = legacy::current_names(std::env::args_os());
    let color = args::ColorMode::find(arguments.iter().filter_map(|arg| arg.to_str()));
    let parsed = args::command().color(color.into()).try_get_matches_from(arguments);
    let cli = parsed.map_err(args::with_cure).and_then(|parsed| args::Cli::from_arg_matches(&parsed));
    let cli = match cli {
        Ok(cli) => cli,
        Err(stop) => return error::parser_exit_code(&stop),
    };
    notes.iter().for_each(|note| terminal::print_note(note));
    let global = global::GlobalOptions::new(&cli);
    interrupt::listen();
    error::exit_code(commands::dispatch(cli.command, &global))
}
