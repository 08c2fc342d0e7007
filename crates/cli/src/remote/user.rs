//! Who looks at the pictures of a real path: turns from view to view by the clock.

use super::exchange::Exchange;
use basrelief_deferred_renderer::{Ahead, User};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Leaves views at times, counted from the request for the scene.
#[derive(Debug)]
pub(super) struct RemoteUser {
    exchange: Arc<Exchange>,
    left_at_ms: Vec<f64>,
}

impl RemoteUser {
    pub(super) fn new(exchange: Arc<Exchange>, left_at_ms: Vec<f64>) -> Self {
        Self { exchange, left_at_ms }
    }

    /// When this view is left, if it is.
    fn left_at(&self, view: Option<u64>) -> Option<Instant> {
        let ms = *self.left_at_ms.get(usize::try_from(view?).ok()?)?;
        Some(self.exchange.meter().began() + Duration::from_secs_f64(ms / 1e3))
    }
}

impl User for RemoteUser {
    fn turn_to(&self, view: u64) {
        if let Some(time) = self.left_at(view.checked_sub(1)) {
            self.exchange.pause(time.saturating_duration_since(Instant::now()));
        }
        self.exchange.ask_until(self.left_at(Some(view)));
    }

    fn leaves(&self, tiles: Ahead<'_>) -> bool {
        let is_left = !self.exchange.is_there_in_time(tiles);
        if is_left {
            self.exchange.abandon();
        }
        is_left
    }
}
