//! Output of a command: its text, its error and its exit code.

pub use basrelief_sim::{CommandError, CommandResult};

use crate::terminal;
use basrelief_report::TextStyle;
use std::io::{self, Write};
use std::process::ExitCode;

/// Prints to standard output. A closed pipe (`| head`) is no error: the command continues to its own exit code.
pub fn print(text: &str) -> CommandResult {
    print_styled(text, TextStyle { color: false, ..TextStyle::default() })
}

/// Prints a text with the colours of a style to standard output.
pub fn print_styled(text: &str, style: TextStyle) -> CommandResult {
    let mut out = io::stdout();
    let text = terminal::without_control_characters(text, style.color);
    checked(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Converts an error of standard output.
fn checked(printed: io::Result<()>) -> CommandResult {
    match printed {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(CommandError::BadInput(format!("standard output: cannot be written: {e}")))
        }
        _ => Ok(()),
    }
}

/// Prints help, version or usage error of the option parser. Returns the exit code.
pub fn parser_exit_code(stop: &clap::Error) -> ExitCode {
    let printed = stop.print().and_then(|()| io::stdout().flush());
    match stop.use_stderr() {
        true => ExitCode::from(2),
        false => exit_code(checked(printed)),
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
