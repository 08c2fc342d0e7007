//! A server: one thread for each of a limited number of [connections](super::connections).

use super::connections::{ConnectionState, Connections};
use super::hosts::AllowedHosts;
use super::http::{HeaderParse, MAX_HEAD, Request, Response};
use crate::protocol::MIN_BYTES_PER_SECOND;
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Limits of a server.
#[derive(Clone, Copy, Debug)]
pub struct ServerLimits {
    /// Longest time for a request to arrive, and for a client to read nothing of a response.
    pub idle: Duration,
    /// Minimum average rate of a response that lasts longer than `idle` \[bytes/s\].
    pub slowest: u64,
    /// Concurrent connections.
    pub connections: usize,
    /// Maximum size of the bodies that exist for single responses at the same time \[bytes\].
    pub bodies: u64,
}

impl Default for ServerLimits {
    fn default() -> Self {
        Self { idle: Duration::from_secs(10), slowest: MIN_BYTES_PER_SECOND, connections: 256, bodies: 32 << 20 }
    }
}

/// Pause after a failed `accept`, for example with too many open files.
const PAUSE: Duration = Duration::from_millis(10);
/// Bytes written at a time.
const PART: usize = 1 << 14;

/// Handler of requests.
pub(crate) trait RequestHandler: Send + Sync + 'static {
    /// Returns the response to a path.
    fn answer(&self, path: &str) -> Response;
    /// Returns the maximum size of a body that exists for the response to this path alone \[bytes\].
    fn body_bytes(&self, _path: &str) -> u64 {
        0
    }
    /// Returns the headers of every response, one per line.
    fn headers(&self) -> &str;
    /// Returns the names of the server, besides its address, that the header Host may hold.
    fn host_names(&self) -> &[String] {
        &[]
    }
    /// Called when a response is sent completely: it arrives even if the process ends now.
    fn sent(&self, _answer: &Response) {}
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
///
/// # Errors
/// The address cannot be used.
pub(crate) fn listen(
    answers: impl RequestHandler,
    address: SocketAddr,
    limits: ServerLimits,
) -> Result<(SocketAddr, ListeningServer), String> {
    let refused =
        |error| format!("{address}: cannot be listened at: {error}; choose another address or port (port 0: a free one)");
    let listener = TcpListener::bind(address).map_err(refused)?;
    let address = listener.local_addr().map_err(refused)?;
    let hosts = Arc::new(AllowedHosts::new(address, answers.host_names()));
    let answers: Arc<dyn RequestHandler> = Arc::new(answers);
    Ok((address, ListeningServer(thread::spawn(move || accept(&listener, &answers, &hosts, limits)))))
}

fn accept(listener: &TcpListener, answers: &Arc<dyn RequestHandler>, hosts: &Arc<AllowedHosts>, limits: ServerLimits) {
    let connections = Arc::new(Connections::new(limits.bodies));
    for number in 0.. {
        let Ok((stream, _)) = listener.accept() else {
            connections.evict_one();
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
    limits: ServerLimits,
}

impl ServedClient<'_> {
    /// Answers one request after another.
    fn serve(&self, answers: &dyn RequestHandler) -> io::Result<()> {
        // RequestHandler are sent in parts as large as they come.
        self.stream.set_nodelay(true)?;
        let mut received = Vec::new();
        loop {
            self.connections.set_state(self.number, ConnectionState::Idle);
            let head = self.read_request(&mut received)?;
            self.connections.set_state(self.number, ConnectionState::Computing);
            let mut room = self.connections.wait_for_room(0);
            let (answer, last, only_head) = match head {
                HeaderParse::Incomplete => return Ok(()),
                HeaderParse::Complete(asked, length) => {
                    received.drain(..length);
                    room = self.connections.wait_for_room(answers.body_bytes(&asked.path));
                    let answer = self.answer(answers, &asked);
                    (answer, asked.last || self.others_wait(), asked.head)
                }
                HeaderParse::Rejected(status, why) => (Response::refused(status, why), true, false),
            };
            room.shrink_to(answer.body.len() as u64);
            self.connections.set_state(self.number, ConnectionState::Sending);
            let body: [&[u8]; 2] = if only_head { [&[]; 2] } else { [&answer.body, &answer.tail] };
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
        self.connections.are_crowded() || self.connections.is_evicted(self.number)
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

    fn send(&self, [body, tail]: [&[u8]; 2], head: &[u8]) -> io::Result<()> {
        self.stream.set_write_timeout(Some(self.limits.idle))?;
        let (began, mut sent) = (Instant::now(), 0);
        let mut stream = self.stream;
        // A small response is one packet with its head.
        let (first, rest) = body.split_at(body.len().min(PART));
        for part in std::iter::once(&*[head, first].concat()).chain(rest.chunks(PART)).chain(tail.chunks(PART)) {
            stream.write_all(part)?;
            sent += part.len() as u64;
            self.connections.set_progress(self.number, sent);
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
        self.connections.set_state(self.number, ConnectionState::Lingering);
        let end = Instant::now() + self.limits.idle;
        let mut bytes = [0; PART];
        while self.read(&mut bytes, end)? > 0 && !self.connections.is_evicted(self.number) {}
        Ok(())
    }
}
