//! When the pictures of a server's scene are there, and what they took to come.

use crate::progress::TileProgress;
use crate::remote::Meter;
use basrelief_report::model::RealPath;

/// When pictures are there, by the clock.
#[derive(Debug)]
pub struct RealTimes {
    meter: Meter,
    progress: TileProgress,
    /// Number of the frame of each picture, and milliseconds since the scene was asked for.
    shown: Vec<(u32, f64)>,
}

impl RealTimes {
    /// Of what this meter counts; each picture is told on this progress.
    pub fn new(meter: Meter, progress: TileProgress) -> Self {
        Self { meter, progress, shown: vec![] }
    }

    /// A picture is there.
    pub fn shown(&mut self, frame: u32, round: u32) {
        let milliseconds = self.meter.milliseconds();
        self.shown.push((frame, milliseconds));
        self.progress.shown(frame, round, milliseconds);
    }

    /// What the report says of it.
    pub fn path(&self) -> RealPath {
        let counted = self.meter.read();
        let last_of_first = self.shown.iter().rev().find(|(frame, _)| *frame == 0);
        RealPath {
            first_picture_ms: rounded(self.shown.first().map_or(0.0, |(_, ms)| *ms)),
            final_picture_ms: rounded(last_of_first.map_or(0.0, |(_, ms)| *ms)),
            picture_ms: by_frame(&self.shown),
            connections: counted.connections,
            requests: counted.requests,
            request_bytes: counted.sent,
            scene_bytes: counted.scene,
            tiles: counted.tiles,
            tile_bytes: counted.tile_bytes,
            head_bytes: counted.received.saturating_sub(counted.scene + counted.tile_bytes),
        }
    }
}

/// Times of pictures from the end of the frame before.
fn by_frame(shown: &[(u32, f64)]) -> Vec<f64> {
    let since = |i: usize| {
        let frame = shown[i].0;
        shown[..i].iter().rev().find(|(other, _)| *other < frame).map_or(0.0, |(_, end)| *end)
    };
    shown.iter().enumerate().map(|(i, (_, ms))| rounded(ms - since(i))).collect()
}

/// To the microsecond.
fn rounded(milliseconds: f64) -> f64 {
    (milliseconds * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_timed_from_the_end_of_the_frame_before() {
        let shown = [(0, 10.0), (0, 30.0), (1, 31.5), (1, 40.0), (2, 41.0)];
        assert_eq!(by_frame(&shown), [10.0, 30.0, 1.5, 10.0, 1.0]);
    }
}
