//! Connections of a server: a limited number, one thread each, and a client that does nothing loses its connection to the next one.
//!
//! If all connections are in use and another client connects, the server evicts the connection that has been idle longest, or if none is
//! idle, one whose client has read nothing for half a second. While a client waits, each response announces that it is the last of its
//! connection. So busy clients take turns, and few requests are lost to closed connections.

use super::hosts::AllowedHosts;
use super::http::{HeaderParse, MAX_HEAD, Request, Response};
use crate::protocol::MIN_BYTES_PER_SECOND;
use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Limits of a server.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Longest time for a request to arrive, and for a client to read nothing of a response.
    pub idle: Duration,
    /// Minimum average rate of a response that lasts longer than `idle` \[bytes/s\].
    pub slowest: u64,
    /// Concurrent connections.
    pub connections: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { idle: Duration::from_secs(10), slowest: MIN_BYTES_PER_SECOND, connections: 256 }
    }
}

/// Time without progress after which a connection can be evicted.
const STALLED: Duration = Duration::from_millis(500);
/// Interval between attempts to evict.
const LOOK: Duration = Duration::from_millis(50);
/// Pause after a failed `accept`, for example with too many open files.
const PAUSE: Duration = Duration::from_millis(10);
/// Bytes written at a time.
const PART: usize = 1 << 14;

/// Handler of requests.
pub(crate) trait RequestHandler: Send + Sync + 'static {
    /// Returns the response to a path.
    fn answer(&self, path: &str) -> Response;
    /// Returns the headers of every response, one per line.
    fn headers(&self) -> &str;
    /// Returns the names of the server, besides its address, that the header Host may hold.
    fn host_names(&self) -> &[String] {
        &[]
    }
    /// Called when a response is sent completely: it arrives even if the process ends now.
    fn sent(&self, _answer: &Response) {}
}

/// State of a connection; the first in this order is evicted first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ConnectionState {
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
    /// Start of the state; while sending, the last progress.
    since: Instant,
    evicted: bool,
}

/// All connections.
#[derive(Debug, Default)]
struct Connections {
    open: Mutex<BTreeMap<u64, Connection>>,
    closed: Condvar,
    /// Another client waits for a connection.
    crowded: AtomicBool,
}

impl Connections {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<u64, Connection>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Admits a connection as soon as there is room.
    fn admit(&self, number: u64, stream: Arc<TcpStream>, most: usize) {
        let mut open = self.lock();
        while open.len() >= most {
            self.crowded.store(true, Ordering::Relaxed);
            evict_one(&mut open);
            open = self.closed.wait_timeout(open, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
        self.crowded.store(false, Ordering::Relaxed);
        open.insert(number, Connection { stream, state: ConnectionState::Idle, since: Instant::now(), evicted: false });
    }

    fn now(&self, number: u64, state: ConnectionState) {
        if let Some(connection) = self.lock().get_mut(&number) {
            (connection.state, connection.since) = (state, Instant::now());
            // A client evicted while idle may still have a response to receive, and may be evicted again.
            connection.evicted &= state != ConnectionState::Sending;
        }
    }

    /// Returns true if the connection closes after the current response.
    fn is_evicted(&self, number: u64) -> bool {
        self.lock().get(&number).is_none_or(|connection| connection.evicted)
    }

    fn close(&self, number: u64) {
        self.lock().remove(&number);
        self.closed.notify_all();
    }
}

/// Evicts the connection that is needed least, if any. Its thread reads the end of the stream, and still answers a request that has
/// arrived.
fn evict_one(open: &mut BTreeMap<u64, Connection>) {
    let idle = |c: &&mut Connection| match c.state {
        ConnectionState::Lingering | ConnectionState::Idle => true,
        ConnectionState::Sending => c.since.elapsed() > STALLED,
        ConnectionState::Computing => false,
    };
    let all = open.values_mut().filter(|c| !c.evicted).filter(idle);
    if let Some(connection) = all.min_by_key(|c| (c.state, c.since)) {
        connection.evicted = true;
        let shut = if connection.state == ConnectionState::Sending { Shutdown::Both } else { Shutdown::Read };
        // A stream that is already closed needs no shutdown.
        let _ = connection.stream.shutdown(shut);
    }
}

/// A running server.
#[derive(Debug)]
pub struct ListeningServer(JoinHandle<()>);

impl ListeningServer {
    /// Waits for the server, which runs until it fails.
    ///
    /// # Errors
    /// The server thread panicked.
    pub fn join(self) -> Result<(), String> {
        self.0.join().map_err(|_| "the server has failed".into())
    }
}

/// Starts to listen at an address; port 0 selects a free port. Returns the address and the running server.
pub(crate) fn listen(
    answers: impl RequestHandler,
    address: SocketAddr,
    limits: Limits,
) -> io::Result<(SocketAddr, ListeningServer)> {
    let listener = TcpListener::bind(address)?;
    let address = listener.local_addr()?;
    let hosts = Arc::new(AllowedHosts::new(address, answers.host_names()));
    let answers: Arc<dyn RequestHandler> = Arc::new(answers);
    Ok((address, ListeningServer(thread::spawn(move || accept(&listener, &answers, &hosts, limits)))))
}

fn accept(listener: &TcpListener, answers: &Arc<dyn RequestHandler>, hosts: &Arc<AllowedHosts>, limits: Limits) {
    let connections = Arc::new(Connections::default());
    for number in 0.. {
        let Ok((stream, _)) = listener.accept() else {
            evict_one(&mut connections.lock());
            thread::sleep(PAUSE);
            continue;
        };
        let stream = Arc::new(stream);
        connections.admit(number, Arc::clone(&stream), limits.connections);
        let (answers, hosts, all) = (Arc::clone(answers), Arc::clone(hosts), Arc::clone(&connections));
        let serve = move || {
            let client = ServedClient { stream: &stream, number, connections: &all, hosts: &hosts, limits };
            // A client that has closed or was evicted needs no error.
            let _ = client.serve(&*answers);
            drop(stream);
            all.close(number);
        };
        if thread::Builder::new().spawn(serve).is_err() {
            connections.close(number);
        }
    }
}

/// State of one connection in its thread.
struct ServedClient<'a> {
    stream: &'a TcpStream,
    number: u64,
    connections: &'a Connections,
    hosts: &'a AllowedHosts,
    limits: Limits,
}

impl ServedClient<'_> {
    /// Answers one request after another.
    fn serve(&self, answers: &dyn RequestHandler) -> io::Result<()> {
        // RequestHandler are sent in parts as large as they come.
        self.stream.set_nodelay(true)?;
        let mut received = Vec::new();
        loop {
            self.connections.now(self.number, ConnectionState::Idle);
            let head = self.read_request(&mut received)?;
            self.connections.now(self.number, ConnectionState::Computing);
            let (answer, last, only_head) = match head {
                HeaderParse::Incomplete => return Ok(()),
                HeaderParse::Complete(asked, length) => {
                    received.drain(..length);
                    let answer = self.answer(answers, &asked);
                    (answer, asked.last || self.others_wait(), asked.head)
                }
                HeaderParse::Rejected(status, why) => (Response::refused(status, why), true, false),
            };
            self.connections.now(self.number, ConnectionState::Sending);
            let body = if only_head { &[] } else { &*answer.body };
            self.send(body, answer.head(answers.headers(), last).as_bytes())?;
            if !only_head {
                answers.sent(&answer);
            }
            if last {
                return self.linger_close();
            }
        }
    }

    fn answer(&self, answers: &dyn RequestHandler, asked: &Request) -> Response {
        if asked.host.as_deref().is_some_and(|host| !self.hosts.allow(host)) {
            return Response::refused(403, "the header Host names another server; `--allow-host NAME` allows a name\n".into());
        }
        answers.answer(&asked.path).accepted(asked.accepts.as_deref()).unless(asked.has.as_deref())
    }

    /// Returns true if another client needs this connection.
    fn others_wait(&self) -> bool {
        self.connections.crowded.load(Ordering::Relaxed) || self.connections.is_evicted(self.number)
    }

    /// Waits for a request; returns `Incomplete` at the end of the stream.
    fn read_request(&self, received: &mut Vec<u8>) -> io::Result<HeaderParse> {
        let end = Instant::now() + self.limits.idle;
        let mut bytes = [0; MAX_HEAD];
        loop {
            let head = HeaderParse::read(received);
            if head != HeaderParse::Incomplete {
                return Ok(head);
            }
            let n = self.read(&mut bytes, end)?;
            if n == 0 {
                return Ok(HeaderParse::Incomplete);
            }
            received.extend_from_slice(&bytes[..n]);
            // A slow-loris client would otherwise keep its connection.
            if self.connections.is_evicted(self.number) {
                return Ok(HeaderParse::read(received));
            }
        }
    }

    /// Reads before `end`.
    fn read(&self, bytes: &mut [u8], end: Instant) -> io::Result<usize> {
        let left = end.checked_duration_since(Instant::now()).filter(|left| !left.is_zero());
        self.stream.set_read_timeout(Some(left.ok_or(io::ErrorKind::TimedOut)?))?;
        let mut stream = self.stream;
        stream.read(bytes)
    }

    fn send(&self, body: &[u8], head: &[u8]) -> io::Result<()> {
        self.stream.set_write_timeout(Some(self.limits.idle))?;
        let (began, mut sent) = (Instant::now(), 0);
        let mut stream = self.stream;
        // A small response is one packet with its head.
        let (first, rest) = body.split_at(body.len().min(PART));
        for part in std::iter::once(&*[head, first].concat()).chain(rest.chunks(PART)) {
            stream.write_all(part)?;
            self.connections.now(self.number, ConnectionState::Sending);
            sent += part.len() as u64;
            if began.elapsed() > self.limits.idle + Duration::from_secs(sent / self.limits.slowest) {
                return Err(io::ErrorKind::TimedOut.into());
            }
        }
        Ok(())
    }

    /// Announces the end and waits for the client to close. A connection closed while the client still sends would be reset, and the
    /// response lost.
    fn linger_close(&self) -> io::Result<()> {
        self.stream.shutdown(Shutdown::Write)?;
        self.connections.now(self.number, ConnectionState::Lingering);
        let end = Instant::now() + self.limits.idle;
        let mut bytes = [0; PART];
        while self.read(&mut bytes, end)? > 0 && !self.connections.is_evicted(self.number) {}
        Ok(())
    }
}
