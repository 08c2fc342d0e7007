//! Connections of a server: a limited number, and a client that does nothing loses its connection to the next one.
//!
//! If all connections are in use and another client connects, the server evicts the connection that has been idle longest, or if none is
//! idle, the one that receives its response most slowly. While a client waits, each response announces that it is the last of its
//! connection. So busy clients take turns, and few requests are lost to closed connections.
//!
//! The bodies of responses have a limit, too. A request waits until its body has room, and meanwhile the slowest receivers are evicted.

use std::collections::BTreeMap;
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time after which a connection that receives a response can be evicted. An honest client on a fast path needs less.
const SLOW: Duration = Duration::from_millis(500);
/// Interval between attempts to evict.
const LOOK: Duration = Duration::from_millis(50);

/// State of a connection; the first in this order is evicted first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ConnectionState {
    /// The last response is sent; the client has only to close.
    Lingering,
    /// The client has sent no request, or part of one.
    Idle,
    /// The client receives a response.
    Sending,
    /// The response is being computed.
    Computing,
}

#[derive(Debug)]
struct Connection {
    stream: Arc<TcpStream>,
    state: ConnectionState,
    /// Start of the state.
    since: Instant,
    /// Bytes of the response that were sent.
    sent: u64,
    evicted: bool,
}

impl Connection {
    /// Returns the rate at which the client receives a response \[bytes/s\]; 0 in every other state.
    fn rate(&self) -> u64 {
        (1000 * self.sent) / (self.since.elapsed().as_millis() as u64).max(1)
    }
}

/// All connections.
#[derive(Debug)]
pub(super) struct Connections {
    open: Mutex<BTreeMap<u64, Connection>>,
    closed: Condvar,
    /// Another client waits for a connection.
    crowded: AtomicBool,
    /// Bytes left for bodies.
    room: Mutex<u64>,
    /// Limit for bodies.
    most: u64,
    freed: Condvar,
}

/// Room for a body, given back when dropped.
#[derive(Debug)]
pub(super) struct BodyRoom<'a>(&'a Connections, u64);

impl BodyRoom<'_> {
    /// Gives back all but this many bytes.
    pub(super) fn shrink_to(&mut self, bytes: u64) {
        let back = self.1.saturating_sub(bytes);
        self.1 -= back;
        if back > 0 {
            *self.0.room.lock().unwrap_or_else(PoisonError::into_inner) += back;
            self.0.freed.notify_all();
        }
    }
}

impl Drop for BodyRoom<'_> {
    fn drop(&mut self) {
        self.shrink_to(0);
    }
}

impl Connections {
    /// Makes no connections, with this limit for bodies.
    pub(super) fn new(most: u64) -> Self {
        let (room, freed) = (Mutex::new(most), Condvar::new());
        Self { open: Mutex::default(), closed: Condvar::new(), crowded: AtomicBool::new(false), room, most, freed }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<u64, Connection>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Evicts the connection that is needed least, if any.
    pub(super) fn evict_one(&self) {
        evict_one(&mut self.lock());
    }

    /// Admits a connection as soon as there is a place.
    pub(super) fn admit(&self, number: u64, stream: Arc<TcpStream>, most: usize) {
        let mut open = self.lock();
        while open.len() >= most {
            self.crowded.store(true, Ordering::Relaxed);
            evict_one(&mut open);
            open = self.closed.wait_timeout(open, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
        self.crowded.store(false, Ordering::Relaxed);
        let (state, since) = (ConnectionState::Idle, Instant::now());
        open.insert(number, Connection { stream, state, since, sent: 0, evicted: false });
    }

    /// Waits for room for a body of at most this size, which is limited to all the room that there is.
    pub(super) fn wait_for_room(&self, bytes: u64) -> BodyRoom<'_> {
        let bytes = bytes.min(self.most);
        let mut left = self.room.lock().unwrap_or_else(PoisonError::into_inner);
        while *left < bytes {
            evict_slowest(&mut self.lock());
            left = self.freed.wait_timeout(left, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
        *left -= bytes;
        BodyRoom(self, bytes)
    }

    pub(super) fn set_state(&self, number: u64, state: ConnectionState) {
        if let Some(connection) = self.lock().get_mut(&number) {
            (connection.state, connection.since, connection.sent) = (state, Instant::now(), 0);
            // A client evicted while idle may still have a response to receive, and may be evicted again.
            connection.evicted &= state != ConnectionState::Sending;
        }
    }

    /// Stores the progress of a response.
    pub(super) fn set_progress(&self, number: u64, bytes: u64) {
        if let Some(connection) = self.lock().get_mut(&number) {
            connection.sent = bytes;
        }
    }

    /// Returns true if another client waits for a connection.
    pub(super) fn are_crowded(&self) -> bool {
        self.crowded.load(Ordering::Relaxed)
    }

    /// Returns true if the connection closes after the current response.
    pub(super) fn is_evicted(&self, number: u64) -> bool {
        self.lock().get(&number).is_none_or(|connection| connection.evicted)
    }

    pub(super) fn close(&self, number: u64) {
        self.lock().remove(&number);
        self.closed.notify_all();
    }
}

/// Evicts the connection that is needed least, if any. Its thread reads the end of the stream, and still answers a request that has
/// arrived.
fn evict_one(open: &mut BTreeMap<u64, Connection>) {
    let idle = |c: &&mut Connection| matches!(c.state, ConnectionState::Lingering | ConnectionState::Idle);
    match open.values_mut().filter(|c| !c.evicted).filter(idle).min_by_key(|c| (c.state, c.since)) {
        Some(connection) => evict(connection, Shutdown::Read),
        None => evict_slowest(open),
    }
}

/// Evicts the connection that has received its response most slowly, if any has received it for some time.
fn evict_slowest(open: &mut BTreeMap<u64, Connection>) {
    let slow = |c: &&mut Connection| c.state == ConnectionState::Sending && c.since.elapsed() > SLOW;
    if let Some(connection) = open.values_mut().filter(|c| !c.evicted).filter(slow).min_by_key(|c| c.rate()) {
        evict(connection, Shutdown::Both);
    }
}

fn evict(connection: &mut Connection, shut: Shutdown) {
    connection.evicted = true;
    // A stream that is already closed needs no shutdown.
    let _ = connection.stream.shutdown(shut);
}
