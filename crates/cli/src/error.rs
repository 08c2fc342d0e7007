//! Output of a command: its text, its error and its exit code.

pub use basrelief_sim::{CommandError, CommandResult};

use crate::terminal;
use std::io::{self, IsTerminal as _, Write};
use std::process::ExitCode;

/// Prints to standard output. A closed pipe (`| head`) is no error: the command continues to its own exit code.
pub fn print(text: &str) -> CommandResult {
    let mut out = io::stdout();
    let text = terminal::without_control_characters(text, out.is_terminal());
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(CommandError::BadInput(format!("standard output: cannot be written: {e}")))
        }
        _ => Ok(()),
    }
}

/// Prints the error of a command, if there is one. Returns the exit code.
pub fn exit_code(done: CommandResult) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(CommandError::BadInput(text)) => {
            terminal::print_note(&format!("error: {text}"));
            ExitCode::from(1)
        }
        Err(CommandError::Usage(text)) => {
            terminal::print_note(&format!("error: {text}\nFor help, try --help."));
            ExitCode::from(2)
        }
    }
}
