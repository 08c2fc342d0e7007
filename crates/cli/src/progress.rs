//! A progress bar on standard error, if that is a terminal; silent in a pipe.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Shows how far a run is.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    drawn: Instant,
}

impl Progress {
    /// A bar over `total` things of a kind; hidden if quiet or not on a terminal.
    pub fn new(total: Option<u64>, of: &str, quiet: bool) -> Self {
        let bar = total.map_or_else(ProgressBar::no_length, ProgressBar::new);
        if quiet || !std::io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        let template = match total {
            Some(_) => format!("{{wide_bar}} {{percent:>3}} % of {{human_len}} {of}, {{per_sec}}, {{eta}} left"),
            None => format!("{{spinner}} {{human_pos}} {of}, {{per_sec}}"),
        };
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        Self { bar, drawn: Instant::now() }
    }

    /// So much is done.
    pub fn at(&mut self, position: u64) {
        if self.drawn.elapsed() > Duration::from_millis(100) {
            self.drawn = Instant::now();
            self.bar.set_position(position);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
