//! Transfer metrics of the network path.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Counts bytes and requests. Clones count together.
#[derive(Clone, Debug, Default)]
pub struct TransferMetrics(Arc<SharedCounts>);

#[derive(Debug, Default)]
struct SharedCounts {
    clock: Mutex<PathActivity>,
    connections: AtomicU64,
    requests: AtomicU64,
    sent: AtomicU64,
    received: AtomicU64,
    scene: AtomicU64,
    tiles: AtomicU64,
    tile_bytes: AtomicU64,
    other: AtomicU64,
    abandoned: AtomicU64,
}

/// Activity of the path.
#[derive(Clone, Copy, Debug, Default)]
struct PathActivity {
    /// Time of the request for the scene.
    began: Option<Instant>,
    /// Requests in flight.
    under_way: u32,
    /// Start of the current idle period.
    idle_since: Option<Instant>,
    /// Idle time before that.
    idle: Duration,
    /// Last arrival of data on any connection.
    came: Option<Instant>,
}

/// Time since the request for the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Elapsed {
    /// \[ms\]
    pub milliseconds: f64,
    /// Part of it without requests in flight \[ms\].
    pub idle: f64,
}

/// A request in flight while this value lives.
#[derive(Debug)]
pub(super) struct RequestGuard(TransferMetrics);

impl Drop for RequestGuard {
    fn drop(&mut self) {
        let mut clock = self.0.clock();
        clock.under_way -= 1;
        clock.idle_since = (clock.under_way == 0).then(Instant::now);
    }
}

/// Kind of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    /// The scene.
    Scene,
    /// A tile.
    Tile,
    /// A list of hashes, or a number.
    Other,
}

/// Counted values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TransferCounts {
    /// Opened connections.
    pub connections: u64,
    /// Requests.
    pub requests: u64,
    /// Sent bytes.
    pub sent: u64,
    /// Received bytes: heads and bodies.
    pub received: u64,
    /// Bytes of the scene.
    pub scene: u64,
    /// Valid tiles.
    pub tiles: u64,
    /// Bytes of valid tiles.
    pub tile_bytes: u64,
    /// Bytes of other valid bodies.
    pub other: u64,
    /// Tiles that were not requested because their view was left.
    pub abandoned: u64,
}

impl TransferMetrics {
    /// Starts the clock at the request for the scene; the last call counts.
    pub fn begin(&self) {
        let mut clock = self.clock();
        *clock = PathActivity { began: Some(Instant::now()), under_way: clock.under_way, ..PathActivity::default() };
    }

    /// Returns the time of the request for the scene, or the present.
    pub(super) fn start_time(&self) -> Instant {
        self.clock().began.unwrap_or_else(Instant::now)
    }

    /// Returns the time since the request for the scene.
    pub fn elapsed(&self) -> Elapsed {
        let clock = *self.clock();
        let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
        let idle = clock.idle + clock.idle_since.map_or(Duration::ZERO, |since| since.elapsed());
        Elapsed { milliseconds: clock.began.map_or(0.0, |began| milliseconds(began.elapsed())), idle: milliseconds(idle) }
    }

    /// Starts a request.
    pub(super) fn under_way(&self) -> RequestGuard {
        let mut clock = self.clock();
        clock.under_way += 1;
        let idle = clock.idle_since.take().map_or(Duration::ZERO, |since| since.elapsed());
        clock.idle += idle;
        RequestGuard(self.clone())
    }

    /// Counts an opened connection.
    pub(super) fn count_connection(&self) {
        add(&self.0.connections, 1);
    }

    /// Counts sent bytes.
    pub(super) fn count_sent(&self, bytes: usize) {
        add(&self.0.sent, bytes as u64);
    }

    /// Counts received bytes.
    pub(super) fn count_received(&self, bytes: usize) {
        add(&self.0.received, bytes as u64);
        if bytes > 0 {
            self.clock().came = Some(Instant::now());
        }
    }

    /// Returns true if data arrived on any connection within this time.
    pub(super) fn came_within(&self, time: Duration) -> bool {
        self.clock().came.is_some_and(|came| came.elapsed() < time)
    }

    fn clock(&self) -> MutexGuard<'_, PathActivity> {
        self.0.clock.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts a request.
    pub(super) fn count_request(&self) {
        add(&self.0.requests, 1);
    }

    /// Counts abandoned tiles.
    pub(super) fn count_abandoned(&self, tiles: u64) {
        add(&self.0.abandoned, tiles);
    }

    /// Counts a valid body.
    pub(super) fn count_body(&self, body: BodyKind, bytes: u64) {
        match body {
            BodyKind::Scene => add(&self.0.scene, bytes),
            BodyKind::Tile => {
                add(&self.0.tiles, 1);
                add(&self.0.tile_bytes, bytes);
            }
            BodyKind::Other => add(&self.0.other, bytes),
        }
    }

    /// Counted values.
    pub fn read(&self) -> TransferCounts {
        let read = |count: &AtomicU64| count.load(Ordering::Relaxed);
        let c = &*self.0;
        TransferCounts {
            connections: read(&c.connections),
            requests: read(&c.requests),
            sent: read(&c.sent),
            received: read(&c.received),
            scene: read(&c.scene),
            tiles: read(&c.tiles),
            tile_bytes: read(&c.tile_bytes),
            other: read(&c.other),
            abandoned: read(&c.abandoned),
        }
    }
}

fn add(count: &AtomicU64, n: u64) {
    count.fetch_add(n, Ordering::Relaxed);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::sleep;

    #[test]
    fn path_without_requests_in_flight_is_idle() {
        let (meter, pause) = (TransferMetrics::default(), Duration::from_millis(40));
        meter.begin();
        let (first, second) = (meter.under_way(), meter.under_way());
        sleep(pause);
        drop(first);
        sleep(pause);
        assert_eq!(meter.elapsed().idle, 0.0, "one is under way");
        drop(second);
        sleep(pause);
        let third = meter.under_way();
        let idle = meter.elapsed().idle;
        sleep(pause);
        assert_eq!(meter.elapsed().idle, idle, "another is under way");
        drop(third);
        let now = meter.elapsed();
        assert!(idle >= 40.0 && now.idle >= idle && now.milliseconds >= now.idle + 120.0, "{idle} {now:?}");
    }
}
