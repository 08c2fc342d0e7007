//! Connections of a server: as many as it grants, a thread each, and none that keeps others out by state nothing.
//!
//! Where all are taken and another client comes, the one goes that has asked for nothing for longest; only where all are
//! being answered, one that has taken nothing for half a second. And as long as another waits, answers announce that they are the last
//! of their connection: so those that ask all the time take turns, and hardly a request is lost by a connection that is closed on it.

use super::http::{HeaderParse, MAX_HEAD, Response};
use crate::protocol::MIN_BYTES_PER_SECOND;
use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// What a server grants its clients.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Longest that a request may take to come, and that nothing of an answer may be taken.
    pub idle: Duration,
    /// What must have been taken of an answer, on average, when it has lasted longer than that \[bytes/s\].
    pub slowest: u64,
    /// Connections at a time.
    pub connections: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { idle: Duration::from_secs(10), slowest: MIN_BYTES_PER_SECOND, connections: 256 }
    }
}

/// A client that has taken nothing for so long can be let go for another.
const STALLED: Duration = Duration::from_millis(500);
/// How often it is looked whether there is one.
const LOOK: Duration = Duration::from_millis(50);
/// Pause where a connection could not be accepted, as where too many files are open.
const PAUSE: Duration = Duration::from_millis(10);
/// Part of an answer that is sent at a time \[bytes\].
const PART: usize = 1 << 14;

/// What the server does with a request.
pub(crate) trait RequestHandler: Send + Sync + 'static {
    /// The answer to a path.
    fn answer(&self, path: &str) -> Response;
    /// Headers that every answer has, a line each.
    fn headers(&self) -> &str;
    /// All of an answer is on its way: it arrives even if the program ends now.
    fn sent(&self, _answer: &Response) {}
}

/// What a connection does; the first of these goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ConnectionState {
    /// The last answer is sent; the client has only to go.
    Lingering,
    /// The client has asked for nothing, or for half of it.
    Idle,
    /// The client takes its answer.
    Sending,
    /// The answer is being made.
    Computing,
}

#[derive(Debug)]
struct Connection {
    stream: Arc<TcpStream>,
    state: ConnectionState,
    /// When that began; of an answer, when something of it was taken last.
    since: Instant,
    evicted: bool,
}

/// All connections.
#[derive(Debug, Default)]
struct Connections {
    open: Mutex<BTreeMap<u64, Connection>>,
    closed: Condvar,
    /// Another waits until one of them is closed.
    crowded: AtomicBool,
}

impl Connections {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<u64, Connection>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes another in, as soon as there is room.
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
            // Who was let go while it asked, and has an answer to take after all, may be let go again.
            connection.evicted &= state != ConnectionState::Sending;
        }
    }

    /// Whether this one is to be closed behind what is under way.
    fn is_evicted(&self, number: u64) -> bool {
        self.lock().get(&number).is_none_or(|connection| connection.evicted)
    }

    fn close(&self, number: u64) {
        self.lock().remove(&number);
        self.closed.notify_all();
    }
}

/// The one that others can do without, if there is any. Its thread finds that nothing more comes; what has come by then is answered.
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
        // One that is shut already is gone too.
        let _ = connection.stream.shutdown(shut);
    }
}

/// A server that answers.
#[derive(Debug)]
pub struct ListeningServer(JoinHandle<()>);

impl ListeningServer {
    /// Waits for its end: it has none.
    ///
    /// # Errors
    /// A sentence, where it has failed.
    pub fn join(self) -> Result<(), String> {
        self.0.join().map_err(|_| "the server has failed".into())
    }
}

/// RequestHandler at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
pub(crate) fn listen(
    answers: impl RequestHandler,
    address: SocketAddr,
    limits: Limits,
) -> io::Result<(SocketAddr, ListeningServer)> {
    let listener = TcpListener::bind(address)?;
    let address = listener.local_addr()?;
    let answers: Arc<dyn RequestHandler> = Arc::new(answers);
    Ok((address, ListeningServer(thread::spawn(move || accept(&listener, &answers, limits)))))
}

fn accept(listener: &TcpListener, answers: &Arc<dyn RequestHandler>, limits: Limits) {
    let connections = Arc::new(Connections::default());
    for number in 0.. {
        let Ok((stream, _)) = listener.accept() else {
            evict_one(&mut connections.lock());
            thread::sleep(PAUSE);
            continue;
        };
        let stream = Arc::new(stream);
        connections.admit(number, Arc::clone(&stream), limits.connections);
        let (answers, all) = (Arc::clone(answers), Arc::clone(&connections));
        let serve = move || {
            let client = ServedClient { stream: &stream, number, connections: &all, limits };
            // A client that is gone, or was let go, has no wishes.
            let _ = client.serve(&*answers);
            drop(stream);
            all.close(number);
        };
        if thread::Builder::new().spawn(serve).is_err() {
            connections.close(number);
        }
    }
}

/// One connection, as its thread sees it.
struct ServedClient<'a> {
    stream: &'a TcpStream,
    number: u64,
    connections: &'a Connections,
    limits: Limits,
}

impl ServedClient<'_> {
    /// RequestHandler one request after another.
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
                    let answer = answers.answer(&asked.path).accepted(asked.accepts.as_deref()).unless(asked.has.as_deref());
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

    /// Whether this connection is wanted for another client.
    fn others_wait(&self) -> bool {
        self.connections.crowded.load(Ordering::Relaxed) || self.connections.is_evicted(self.number)
    }

    /// Waits for a request; half of one where no more comes.
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
            // Whoever drips would go on.
            if self.connections.is_evicted(self.number) {
                return Ok(HeaderParse::read(received));
            }
        }
    }

    /// Reads what comes before `end`.
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
        // A small answer is one packet with its head.
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

    /// Says that no more comes, and waits until the client is gone: closed on what it still sends, the connection would be
    /// reset, and the answer lost.
    fn linger_close(&self) -> io::Result<()> {
        self.stream.shutdown(Shutdown::Write)?;
        self.connections.now(self.number, ConnectionState::Lingering);
        let end = Instant::now() + self.limits.idle;
        let mut bytes = [0; PART];
        while self.read(&mut bytes, end)? > 0 && !self.connections.is_evicted(self.number) {}
        Ok(())
    }
}
