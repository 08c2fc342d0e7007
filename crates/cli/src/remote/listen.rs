//! Connections of a server: as many as it grants, a thread each, and none that keeps others out by doing nothing.
//!
//! Where all are taken and another client comes, the one goes that has asked for nothing for longest; only where all are
//! being answered, one that has taken nothing for half a second. And as long as another waits, answers announce that they are the last
//! of their connection: so those that ask all the time take turns, and hardly a request is lost by a connection that is closed on it.

use super::http::{Answer, Head, LONGEST_HEAD};
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
        Self { idle: Duration::from_secs(10), slowest: super::fetch::SLOWEST, connections: 256 }
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
pub(super) trait Answers: Send + Sync + 'static {
    /// The answer to a path.
    fn answer(&self, path: &str) -> Answer;
    /// Headers that every answer has, a line each.
    fn headers(&self) -> &str;
    /// All of an answer is on its way: it arrives even if the program ends now.
    fn sent(&self, _answer: &Answer) {}
}

/// What a connection does; the first of these goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Doing {
    /// The last answer is sent; the client has only to go.
    Parting,
    /// The client has asked for nothing, or for half of it.
    Asking,
    /// The client takes its answer.
    Taking,
    /// The answer is being made.
    Making,
}

#[derive(Debug)]
struct Connection {
    stream: Arc<TcpStream>,
    doing: Doing,
    /// When that began; of an answer, when something of it was taken last.
    since: Instant,
    let_go: bool,
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
            let_one_go(&mut open);
            open = self.closed.wait_timeout(open, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
        self.crowded.store(false, Ordering::Relaxed);
        open.insert(number, Connection { stream, doing: Doing::Asking, since: Instant::now(), let_go: false });
    }

    fn now(&self, number: u64, doing: Doing) {
        if let Some(connection) = self.lock().get_mut(&number) {
            (connection.doing, connection.since) = (doing, Instant::now());
            // Who was let go while it asked, and has an answer to take after all, may be let go again.
            connection.let_go &= doing != Doing::Taking;
        }
    }

    /// Whether this one is to be closed behind what is under way.
    fn is_let_go(&self, number: u64) -> bool {
        self.lock().get(&number).is_none_or(|connection| connection.let_go)
    }

    fn close(&self, number: u64) {
        self.lock().remove(&number);
        self.closed.notify_all();
    }
}

/// The one that others can do without, if there is any. Its thread finds that nothing more comes; what has come by then is answered.
fn let_one_go(open: &mut BTreeMap<u64, Connection>) {
    let idle = |c: &&mut Connection| match c.doing {
        Doing::Parting | Doing::Asking => true,
        Doing::Taking => c.since.elapsed() > STALLED,
        Doing::Making => false,
    };
    let all = open.values_mut().filter(|c| !c.let_go).filter(idle);
    if let Some(connection) = all.min_by_key(|c| (c.doing, c.since)) {
        connection.let_go = true;
        let shut = if connection.doing == Doing::Taking { Shutdown::Both } else { Shutdown::Read };
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

/// Answers at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
pub(super) fn listen(answers: impl Answers, address: SocketAddr, limits: Limits) -> io::Result<(SocketAddr, ListeningServer)> {
    let listener = TcpListener::bind(address)?;
    let address = listener.local_addr()?;
    let answers: Arc<dyn Answers> = Arc::new(answers);
    Ok((address, ListeningServer(thread::spawn(move || accept(&listener, &answers, limits)))))
}

fn accept(listener: &TcpListener, answers: &Arc<dyn Answers>, limits: Limits) {
    let connections = Arc::new(Connections::default());
    for number in 0.. {
        let Ok((stream, _)) = listener.accept() else {
            let_one_go(&mut connections.lock());
            thread::sleep(PAUSE);
            continue;
        };
        let stream = Arc::new(stream);
        connections.admit(number, Arc::clone(&stream), limits.connections);
        let (answers, all) = (Arc::clone(answers), Arc::clone(&connections));
        let talk = move || {
            let client = Client { stream: &stream, number, connections: &all, limits };
            // A client that is gone, or was let go, has no wishes.
            let _ = client.talk(&*answers);
            drop(stream);
            all.close(number);
        };
        if thread::Builder::new().spawn(talk).is_err() {
            connections.close(number);
        }
    }
}

/// One connection, as its thread sees it.
struct Client<'a> {
    stream: &'a TcpStream,
    number: u64,
    connections: &'a Connections,
    limits: Limits,
}

impl Client<'_> {
    /// Answers one request after another.
    fn talk(&self, answers: &dyn Answers) -> io::Result<()> {
        // Answers are sent in parts as large as they come.
        self.stream.set_nodelay(true)?;
        let mut received = Vec::new();
        loop {
            self.connections.now(self.number, Doing::Asking);
            let head = self.ask(&mut received)?;
            self.connections.now(self.number, Doing::Making);
            let (answer, last, only_head) = match head {
                Head::Half => return Ok(()),
                Head::Whole(asked, length) => {
                    received.drain(..length);
                    let answer = answers.answer(&asked.path).accepted(asked.accepts.as_deref()).unless(asked.has.as_deref());
                    (answer, asked.last || self.others_wait(), asked.head)
                }
                Head::Wrong(status, why) => (Answer::refused(status, why), true, false),
            };
            self.connections.now(self.number, Doing::Taking);
            let body = if only_head { &[] } else { &*answer.body };
            self.send(body, answer.head(answers.headers(), last).as_bytes())?;
            if !only_head {
                answers.sent(&answer);
            }
            if last {
                return self.part();
            }
        }
    }

    /// Whether this connection is wanted for another client.
    fn others_wait(&self) -> bool {
        self.connections.crowded.load(Ordering::Relaxed) || self.connections.is_let_go(self.number)
    }

    /// Waits for a request; half of one where no more comes.
    fn ask(&self, received: &mut Vec<u8>) -> io::Result<Head> {
        let end = Instant::now() + self.limits.idle;
        let mut bytes = [0; LONGEST_HEAD];
        loop {
            let head = Head::read(received);
            if head != Head::Half {
                return Ok(head);
            }
            let n = self.read(&mut bytes, end)?;
            if n == 0 {
                return Ok(Head::Half);
            }
            received.extend_from_slice(&bytes[..n]);
            // Whoever drips would go on.
            if self.connections.is_let_go(self.number) {
                return Ok(Head::read(received));
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
            self.connections.now(self.number, Doing::Taking);
            sent += part.len() as u64;
            if began.elapsed() > self.limits.idle + Duration::from_secs(sent / self.limits.slowest) {
                return Err(io::ErrorKind::TimedOut.into());
            }
        }
        Ok(())
    }

    /// Says that no more comes, and waits until the client is gone: closed on what it still sends, the connection would be
    /// reset, and the answer lost.
    fn part(&self) -> io::Result<()> {
        self.stream.shutdown(Shutdown::Write)?;
        self.connections.now(self.number, Doing::Parting);
        let end = Instant::now() + self.limits.idle;
        let mut bytes = [0; PART];
        while self.read(&mut bytes, end)? > 0 && !self.connections.is_let_go(self.number) {}
        Ok(())
    }
}
