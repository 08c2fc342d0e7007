//! View changes at given times.

use super::queue::TileFetchQueue;
use basrelief_deferred_renderer::{UpcomingTiles, ViewUser};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Times at which the user leaves each view, counted from the request for the scene.
#[derive(Debug)]
pub(super) struct ViewSchedule {
    queue: Arc<TileFetchQueue>,
    left_at_ms: Vec<f64>,
}

impl ViewSchedule {
    pub(super) fn new(queue: Arc<TileFetchQueue>, left_at_ms: Vec<f64>) -> Self {
        Self { queue, left_at_ms }
    }

    /// Returns the time at which a view is left.
    fn left_at(&self, view: Option<u64>) -> Option<Instant> {
        let ms = *self.left_at_ms.get(usize::try_from(view?).ok()?)?;
        Some(self.queue.metrics().start_time() + Duration::from_secs_f64(ms / 1e3))
    }
}

impl ViewUser for ViewSchedule {
    fn turn_to(&self, view: u64) {
        if let Some(time) = self.left_at(view.checked_sub(1)) {
            self.queue.pause(time.saturating_duration_since(Instant::now()));
        }
        self.queue.ask_until(self.left_at(Some(view)));
    }

    fn leaves(&self, tiles: UpcomingTiles<'_>) -> bool {
        let is_left = !self.queue.is_there_in_time(tiles);
        if is_left {
            self.queue.abandon();
        }
        is_left
    }
}
