//! A progress bar on standard error, if that is a terminal; silent in a pipe.

use basrelief_tile_server::client::FetchProgress;
use indicatif::{HumanBytes, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A bar that is hidden if quiet or not on a terminal.
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

/// Shows how far a run is.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    drawn: Instant,
}

impl Progress {
    /// A bar over `total` things of a kind; hidden if quiet or not on a terminal.
    pub fn new(total: Option<u64>, of: &str, quiet: bool) -> Self {
        let bar = bar(total.map_or_else(ProgressBar::no_length, ProgressBar::new), quiet);
        let template = match total {
            Some(_) => format!("{{wide_bar}} {{percent:>3}} % of {{human_len}} {of}, {{per_sec}}, {{eta}} left"),
            None => format!("{{spinner}} {{human_pos}} {of}, {{per_sec}}"),
        };
        set_style(&bar, &template);
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

/// Shows how far the points of a sweep have come. Of what was there before none is counted in its rate.
#[derive(Debug)]
pub struct PointProgress(ProgressBar);

impl PointProgress {
    /// Hidden if quiet or not on a terminal.
    pub fn new(quiet: bool) -> Self {
        let bar = bar(ProgressBar::new(0), quiet);
        set_style(&bar, "{wide_bar} {human_pos} of {human_len} points, {per_sec}, {eta} left{msg}");
        Self(bar)
    }

    /// So many are done of so many that were missing; so many of them have failed.
    pub fn at(&self, (done, of): (u64, u64), failed: usize) {
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

/// What has come from a server.
#[derive(Clone, Copy, Debug, Default)]
struct Come {
    acquisitions: u64,
    tiles: u64,
    bytes: u64,
}

/// Shows how far a server's tiles have come: of those that the current acquisition lists, since how many the whole run will
/// need nobody knows before. Clones show the same.
#[derive(Clone, Debug)]
pub struct TileProgress {
    bar: ProgressBar,
    come: Arc<Mutex<Come>>,
}

impl TileProgress {
    /// The scene first.
    pub fn new(quiet: bool) -> Self {
        let bar = bar(ProgressBar::no_length(), quiet);
        set_style(&bar, "{spinner} {msg}");
        bar.set_message("waiting for the server");
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, come: Arc::default() }
    }

    /// So many bytes of the scene have come.
    pub fn scene(&self, bytes: u64) {
        self.bar.set_message(format!("scene, {}", HumanBytes(bytes)));
    }

    /// A picture is there; better ones follow, perhaps.
    pub fn shown(&self, frame: u32, round: u32, milliseconds: f64) {
        let line = format!("frame {}, picture {round}: there after {:.2} s", frame + 1, milliseconds / 1e3);
        self.bar.println(line);
    }

    fn change(&self, change: impl FnOnce(&mut Come)) -> Come {
        let mut come = self.come.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut come);
        self.bar.set_message(format!("{} tiles, {}", come.tiles, HumanBytes(come.bytes)));
        *come
    }
}

impl FetchProgress for TileProgress {
    fn listed(&self, tiles: u64) {
        let acquisitions = self.change(|come| come.acquisitions += 1).acquisitions;
        set_style(&self.bar, "acquisition {prefix} {wide_bar} {pos} of {len} tiles; in all {msg}");
        self.bar.set_prefix(acquisitions.to_string());
        self.bar.set_length(tiles);
        self.bar.set_position(0);
    }

    fn arrived(&self, bytes: u64) {
        self.change(|come| {
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
    fn tiles_are_counted_by_acquisition_and_in_all_and_those_of_the_cache_have_no_bytes() {
        let progress = TileProgress::new(true);
        progress.listed(3);
        progress.arrived(1000);
        progress.clone().arrived(1048);
        progress.arrived(0);
        let shown = || (progress.bar.prefix(), progress.bar.position(), progress.bar.length(), progress.bar.message());
        assert_eq!(shown(), ("1".into(), 3, Some(3), "3 tiles, 2.00 KiB".into()));
        progress.listed(5);
        progress.arrived(2048);
        assert_eq!(shown(), ("2".into(), 1, Some(5), "4 tiles, 4.00 KiB".into()));
    }
}
