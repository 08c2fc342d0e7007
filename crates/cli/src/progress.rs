//! Progress bars on standard error, hidden if it is no terminal.

use basrelief_tile_server::client::FetchProgress;
use indicatif::{HumanBytes, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::io::IsTerminal;
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Hides a bar if `quiet` or not on a terminal.
fn bar(bar: ProgressBar, quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar
}

fn set_style(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
}

/// Progress of a run.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    drawn: Instant,
}

impl Progress {
    /// Makes a bar over `total` items; hidden if `quiet` or not on a terminal.
    pub fn new(total: Option<u64>, of: &str, quiet: bool) -> Self {
        let bar = bar(total.map_or_else(ProgressBar::no_length, ProgressBar::new), quiet);
        let template = match total {
            Some(_) => format!("{{wide_bar}} {{percent:>3}} % of {{human_len}} {of}, {{per_sec}}, {{eta}} left"),
            None => format!("{{spinner}} {{human_pos}} {of}, {{per_sec}}"),
        };
        set_style(&bar, &template);
        Self { bar, drawn: Instant::now() }
    }

    /// Sets the position.
    pub fn set_position(&mut self, position: u64) {
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

/// Progress of a run over its input.
#[derive(Debug)]
pub struct InputProgress {
    pub bar: Progress,
    /// Bytes of the trace read so far; `None` if the bar counts commands.
    pub read: Option<Rc<Cell<u64>>>,
}

impl InputProgress {
    /// Sets the position after this number of commands.
    pub fn set_position(&mut self, commands: u64) {
        self.bar.set_position(self.read.as_ref().map_or(commands, |read| read.get()));
    }
}

/// Progress of a sweep. Reused points do not count in its rate.
#[derive(Debug)]
pub struct PointProgress(ProgressBar);

impl PointProgress {
    /// Makes a bar; hidden if `quiet` or not on a terminal.
    pub fn new(quiet: bool) -> Self {
        let bar = bar(ProgressBar::new(0), quiet);
        set_style(&bar, "{wide_bar} {human_pos} of {human_len} points, {per_sec}, {eta} left{msg}");
        Self(bar)
    }

    /// Sets the number of finished points, the number of points to run, and the number of failures.
    pub fn set_position(&self, done: u64, of: u64, failed: usize) {
        self.0.set_length(of);
        self.0.set_position(done);
        if failed > 0 {
            self.0.set_message(format!(", {failed} failed"));
        }
    }
}

impl Drop for PointProgress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Received tiles and bytes.
#[derive(Clone, Copy, Debug, Default)]
struct ReceivedTiles {
    acquisitions: u64,
    tiles: u64,
    bytes: u64,
}

/// Progress of the tiles of the current acquisition; the total of the run is unknown. Clones share a bar.
#[derive(Clone, Debug)]
pub struct TileProgress {
    bar: ProgressBar,
    come: Arc<Mutex<ReceivedTiles>>,
}

impl TileProgress {
    /// Makes a bar that waits for the scene.
    pub fn new(quiet: bool) -> Self {
        let bar = bar(ProgressBar::no_length(), quiet);
        set_style(&bar, "{spinner} {msg}");
        bar.set_message("waiting for the server");
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, come: Arc::default() }
    }

    /// Sets the received bytes of the scene.
    pub fn scene(&self, bytes: u64) {
        self.bar.set_message(format!("scene, {}", HumanBytes(bytes)));
    }

    /// Reports a finished image.
    pub fn print_image(&self, frame: u32, round: u32, milliseconds: f64) {
        let line = format!("frame {}, image {round}: complete after {:.2} s", frame + 1, milliseconds / 1e3);
        self.bar.println(line);
    }

    fn update(&self, change: impl FnOnce(&mut ReceivedTiles)) -> ReceivedTiles {
        let mut come = self.come.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut come);
        self.bar.set_message(format!("{} tiles, {}", come.tiles, HumanBytes(come.bytes)));
        *come
    }
}

impl FetchProgress for TileProgress {
    fn add_acquisition(&self, tiles: u64) {
        let acquisitions = self.update(|come| come.acquisitions += 1).acquisitions;
        set_style(&self.bar, "acquisition {prefix} {wide_bar} {pos} of {len} tiles; total {msg}");
        self.bar.set_prefix(acquisitions.to_string());
        self.bar.set_length(tiles);
        self.bar.set_position(0);
    }

    fn add_bytes(&self, bytes: u64) {
        self.update(|come| {
            come.tiles += 1;
            come.bytes += bytes;
        });
        self.bar.inc(1);
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tile_progress_counts_by_acquisition_and_total() {
        let progress = TileProgress::new(true);
        progress.add_acquisition(3);
        progress.add_bytes(1000);
        progress.clone().add_bytes(1048);
        progress.add_bytes(0);
        let shown = || (progress.bar.prefix(), progress.bar.position(), progress.bar.length(), progress.bar.message());
        assert_eq!(shown(), ("1".into(), 3, Some(3), "3 tiles, 2.00 KiB".into()));
        progress.add_acquisition(5);
        progress.add_bytes(2048);
        assert_eq!(shown(), ("2".into(), 1, Some(5), "4 tiles, 4.00 KiB".into()));
    }
}
