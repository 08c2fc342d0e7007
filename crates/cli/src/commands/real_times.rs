//! Times of images of a scene from a server, and its traffic.

use crate::progress::TileProgress;
use basrelief_report::model::RealPath;
use basrelief_tile_server::client::{Elapsed, TransferMetrics};

/// Times of images.
#[derive(Debug)]
pub struct RealTimes {
    meter: TransferMetrics,
    progress: TileProgress,
    /// Frame and time of each image.
    shown: Vec<(u32, Elapsed)>,
    /// Message for a signal after the first image.
    pub interrupted: &'static str,
}

impl RealTimes {
    /// Records times of these transfer metrics, and reports each image on this progress bar.
    pub const fn new(meter: TransferMetrics, progress: TileProgress, interrupted: &'static str) -> Self {
        Self { meter, progress, shown: vec![], interrupted }
    }

    /// Records an image.
    pub fn record_image(&mut self, frame: u32, round: u32) {
        let now = self.meter.elapsed();
        self.shown.push((frame, now));
        self.progress.print_image(frame, round, now.milliseconds);
    }

    /// Returns the part of the report.
    pub fn path(&self) -> RealPath {
        let counted = self.meter.read();
        let moment = |shown: Option<&(u32, Elapsed)>| shown.map_or_else(Elapsed::default, |(_, moment)| *moment);
        let first = moment(self.shown.first());
        let last = moment(self.shown.iter().rev().find(|(frame, _)| *frame == 0));
        RealPath {
            first_picture_ms: rounded(first.milliseconds),
            final_picture_ms: rounded(last.milliseconds),
            first_picture_idle_ms: rounded(first.idle),
            final_picture_idle_ms: rounded(last.idle),
            picture_ms: by_frame(&self.shown),
            picture_at_ms: self.shown.iter().map(|(_, moment)| rounded(moment.milliseconds)).collect(),
            connections: counted.connections,
            requests: counted.requests,
            request_bytes: counted.sent,
            scene_bytes: counted.scene,
            tiles: counted.tiles,
            tile_bytes: counted.tile_bytes,
            hash_bytes: counted.other,
            abandoned_tiles: counted.abandoned,
            head_bytes: counted.received.saturating_sub(counted.scene + counted.tile_bytes + counted.other),
        }
    }
}

/// Returns the times of images since the end of the previous frame.
fn by_frame(shown: &[(u32, Elapsed)]) -> Vec<f64> {
    let since = |i: usize| {
        let frame = shown[i].0;
        shown[..i].iter().rev().find(|(other, _)| *other < frame).map_or(0.0, |(_, end)| end.milliseconds)
    };
    shown.iter().enumerate().map(|(i, (_, moment))| rounded(moment.milliseconds - since(i))).collect()
}

/// Rounds to microseconds.
fn rounded(milliseconds: f64) -> f64 {
    (milliseconds * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_timed_from_the_end_of_the_frame_before() {
        let shown = [(0, 10.0), (0, 30.0), (1, 31.5), (1, 40.0), (2, 41.0)];
        let shown = shown.map(|(frame, milliseconds)| (frame, Elapsed { milliseconds, idle: 0.0 }));
        assert_eq!(by_frame(&shown), [10.0, 30.0, 1.5, 10.0, 1.0]);
    }
}
