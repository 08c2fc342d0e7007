//! Ctrl-C: nothing half-written stays, and the exit code is 130.

use crate::outputs;
use std::io::IsTerminal;
use std::process;
use std::sync::OnceLock;

/// What a command that writes nothing says in place of that nothing was written.
static SAID: OnceLock<&str> = OnceLock::new();

/// From now on this is said when the signal comes.
pub fn say(sentence: &'static str) {
    // Only one command runs.
    let _ = SAID.set(sentence);
}

/// Starts to listen. The signal ends the process from a thread of its own, whatever the others wait for: a flag that
/// they look at would not help one that reads a pipe into which nobody writes.
pub fn listen() {
    // Where no handler can be installed, the default action ends the process: nothing is in its place then either.
    let _ = ctrlc::set_handler(|| {
        let _nothing_more_is_written = outputs::abandon();
        let line = if std::io::stderr().is_terminal() { "\r\x1b[2K" } else { "" };
        eprintln!("{line}{}", SAID.get().unwrap_or(&"interrupted; nothing was written"));
        process::exit(130);
    });
}
