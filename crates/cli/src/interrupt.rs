//! Signals that stop the program: unfinished outputs are removed, and the exit code is 128 + the number of the signal.

use crate::{outputs, terminal};
use std::process;
use std::sync::{Mutex, PoisonError};

/// The message for a signal.
static MESSAGE: Mutex<&str> = Mutex::new("interrupted; nothing was written");

/// Sets the message for a signal, which states the files that remain. The last call counts.
pub fn set_message(message: &'static str) {
    *MESSAGE.lock().unwrap_or_else(PoisonError::into_inner) = message;
}

/// Installs the signal handlers. If that fails, a signal still ends the process, but leaves hidden files for the next run to remove.
///
/// A thread of its own ends the process, because a flag would not stop a command that waits for input from a pipe.
#[cfg(unix)]
pub fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    // `nohup` starts programs with SIGHUP ignored, and it must stay so.
    let signals = [SIGINT, SIGTERM, SIGQUIT, SIGHUP].into_iter().filter(|signal| *signal != SIGHUP || !is_ignored(SIGHUP));
    // With a handler, a write beyond the limit of file sizes (`ulimit -f`) is an error, and the command removes its files.
    let Ok(mut signals) = Signals::new(signals.chain([SIGXFSZ])) else { return };
    let wait = move || {
        if let Some(signal) = signals.forever().find(|signal| *signal != SIGXFSZ) {
            stop(128 + signal);
        }
    };
    // Without a thread the handlers would only swallow the signals.
    if let Err(error) = std::thread::Builder::new().spawn(wait) {
        terminal::print_note(&format!("warning: signals cannot be handled: {error}"));
    }
}

/// Returns true if this process ignores a signal. Known on Linux only.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Installs a handler for Ctrl-C.
#[cfg(not(unix))]
pub fn listen() {
    let _ = ctrlc::set_handler(|| stop(130));
}

fn stop(code: i32) -> ! {
    let _no_new_files = outputs::remove_all();
    terminal::clear_progress();
    terminal::print_note(*MESSAGE.lock().unwrap_or_else(PoisonError::into_inner));
    process::exit(code);
}
