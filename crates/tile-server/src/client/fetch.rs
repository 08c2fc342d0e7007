//! Requests, repeated if they fail.

use super::metrics::{BodyKind, TransferMetrics};
use super::transport::CountingConnector;
use crate::protocol::{
    MAX_TILE_BYTES, MIN_BYTES_PER_SECOND, check_hash, check_scene_status, check_status, hash_from_etag, split,
};
use basrelief_input::{CountedBuffer, MemoryPool, MemoryReservation, OverBudget};
use std::io::{self, Read, Write};
use std::thread;
use std::time::{Duration, Instant};
use ureq::Agent;
use ureq::unversioned::resolver::DefaultResolver;
use ureq::unversioned::transport::{Connector as _, TcpConnector};

/// Timeouts and retries.
#[derive(Clone, Copy, Debug)]
pub struct RetryPolicy {
    /// Longest time without data on any connection.
    pub stall: Duration,
    /// Minimum average rate of a request that lasts longer than `stall` \[bytes/s\].
    pub slowest: u64,
    /// Maximum number of attempts.
    pub attempts: u32,
    /// Pause before the second attempt; doubles with each attempt.
    pub pause: Duration,
    /// No attempt starts later than this after the first.
    pub whole: Duration,
    /// Longest wait for a server that does not listen.
    pub starting: Duration,
}

impl Default for RetryPolicy {
    fn default() -> Self {
        Self {
            stall: Duration::from_secs(10),
            slowest: MIN_BYTES_PER_SECOND,
            attempts: 5,
            pause: Duration::from_millis(100),
            whole: Duration::from_secs(20),
            starting: Duration::from_secs(30),
        }
    }
}

/// Maximum number of requests in flight.
pub const MAX_IN_FLIGHT: u32 = 32;

/// Longest time until the first byte of a response. It is long because many requests may share a slow path. From the first byte on, the
/// head may take no longer than a stall.
const MAX_HEAD: Duration = Duration::from_secs(600);
/// Interval between connection attempts.
const LOOK: Duration = Duration::from_millis(100);
/// Statuses of a proxy whose server does not listen or answer.
const NOBODY_BEHIND: [u16; 3] = [502, 503, 504];
/// Maximum length of a number \[bytes\].
const LONGEST_NUMBER: u64 = 20;

/// Client of a server. Clones share connections.
#[derive(Clone, Debug)]
pub struct Fetcher {
    agent: Agent,
    base: String,
    retry_policy: RetryPolicy,
    budget: MemoryPool,
    meter: TransferMetrics,
}

/// A received body and its memory.
type FetchedBody = (Vec<u8>, MemoryReservation);

/// Earlier attempts for the same content.
#[derive(Clone, Copy, Debug)]
pub struct EarlierAttempts {
    /// Start of the first attempt.
    pub began: Instant,
    /// Number of failed attempts.
    pub failed: u32,
}

impl Default for EarlierAttempts {
    fn default() -> Self {
        Self { began: Instant::now(), failed: 0 }
    }
}

/// Error of a request.
struct FetchError {
    sentence: String,
    then: RetryAdvice,
}

/// Reaction to an error.
#[derive(Clone, Copy, PartialEq, Eq)]
enum RetryAdvice {
    /// Another attempt may succeed.
    Retry,
    /// Another attempt would fail too.
    GiveUp,
    /// The server does not listen, or a proxy cannot reach it: another attempt may succeed once it has started.
    WaitForServer,
}

impl From<String> for FetchError {
    fn from(sentence: String) -> Self {
        Self { sentence, then: RetryAdvice::Retry }
    }
}

impl Fetcher {
    /// Makes a client of the server at `base`.
    pub fn new(base: &str, patience: RetryPolicy, budget: &MemoryPool) -> Self {
        let stall = Some(patience.stall);
        let config = Agent::config_builder()
            .timeout_resolve(stall)
            .timeout_connect(stall)
            .timeout_recv_response(Some(MAX_HEAD))
            .timeout_per_read(stall)
            .timeout_per_write(stall)
            .max_idle_connections(MAX_IN_FLIGHT as usize)
            .max_idle_connections_per_host(MAX_IN_FLIGHT as usize)
            .http_status_as_error(false)
            // The user named this server and no other.
            .max_redirects(0)
            .proxy(None)
            .build();
        let meter = TransferMetrics::default();
        let connector = ().chain(TcpConnector::default()).chain(CountingConnector(meter.clone(), patience.stall));
        let agent = Agent::with_parts(config, connector, DefaultResolver::default());
        Self { agent, base: base.trim_end_matches('/').to_owned(), retry_policy: patience, budget: budget.clone(), meter }
    }

    /// Fetches the compressed scene at an address. Returns its URL, its bytes and their memory. Waits for a server that does not listen
    /// yet. `came` receives the number of bytes so far.
    ///
    /// # Errors
    /// All attempts have failed.
    pub fn scene(&self, address: &str, came: impl Fn(u64)) -> Result<(String, Vec<u8>, MemoryReservation), String> {
        let url = format!("{}/{address}", self.base);
        let once = || {
            self.meter.begin();
            self.try_once(&url, u64::MAX, check_scene_status, &came)
        };
        match self.with_retries(EarlierAttempts::default(), &sleep, once) {
            Ok((scene, held)) => {
                self.meter.count_body(BodyKind::Scene, scene.len() as u64);
                Ok((url, scene, held))
            }
            Err(FetchError { sentence, then }) => {
                let hint = if then == RetryAdvice::GiveUp { "" } else { "; is `basrelief serve` running there?" };
                Err(format!("{url}: {sentence}{hint}"))
            }
        }
    }

    /// Fetches a body of at most `largest` bytes that passes the check. `pause` waits, and returns false if it is no longer needed.
    ///
    /// # Errors
    /// All attempts have failed.
    pub fn body(
        &self,
        address: &str,
        largest: u64,
        kind: BodyKind,
        check: impl Fn(&[u8]) -> Result<(), String>,
        attempts: EarlierAttempts,
        pause: &dyn Fn(Duration) -> bool,
    ) -> Result<Vec<u8>, String> {
        let body = self.checked(address, largest, |body| check(&body).map(|()| body), attempts, pause)?;
        self.meter.count_body(kind, body.len() as u64);
        Ok(body)
    }

    /// Makes one request for several tiles, each of which must pass the check. Returns `None` after any failure; the caller then
    /// requests the tiles one by one.
    pub fn tiles(&self, tiles: &str, count: usize, check: impl Fn(usize, &[u8]) -> Result<(), String>) -> Option<Vec<Vec<u8>>> {
        let (body, _held) = self.try_once(&format!("{}/{tiles}", self.base), MAX_TILE_BYTES, check_status, &|_| ()).ok()?;
        let tiles = split(&body, count).ok()?;
        tiles.iter().enumerate().try_for_each(|(i, tile)| check(i, tile)).ok()?;
        tiles.iter().for_each(|tile| self.meter.count_body(BodyKind::Tile, tile.len() as u64));
        Some(tiles.into_iter().map(<[u8]>::to_vec).collect())
    }

    /// Fetches a number.
    ///
    /// # Errors
    /// All attempts have failed.
    pub fn number(&self, address: &str) -> Result<u64, String> {
        let number = |body: Vec<u8>| {
            let text = std::str::from_utf8(&body).map_err(|e| e.to_string())?;
            text.parse::<u64>().map(|number| (number, body.len())).map_err(|e| format!("no number: {e}"))
        };
        let (number, bytes) = self.checked(address, LONGEST_NUMBER, number, EarlierAttempts::default(), &sleep)?;
        self.meter.count_body(BodyKind::Other, bytes as u64);
        Ok(number)
    }

    /// Fetches a body and converts it.
    fn checked<T>(
        &self,
        address: &str,
        largest: u64,
        check: impl Fn(Vec<u8>) -> Result<T, String>,
        attempts: EarlierAttempts,
        pause: &dyn Fn(Duration) -> bool,
    ) -> Result<T, String> {
        let url = format!("{}/{address}", self.base);
        let once = || -> Result<T, FetchError> { Ok(check(self.try_once(&url, largest, check_status, &|_| ())?.0)?) };
        self.with_retries(attempts, pause, once).map_err(|fault| format!("{url}: {}", fault.sentence))
    }

    /// Returns the transfer metrics.
    pub fn metrics(&self) -> &TransferMetrics {
        &self.meter
    }

    /// Returns the memory limit for received data.
    pub fn budget(&self) -> &MemoryPool {
        &self.budget
    }

    /// Aborts all requests, also of clones.
    pub fn shut_down(&self) {
        self.agent.clone().shutdown();
    }

    /// Repeats a failed request, and waits for a server that does not listen.
    fn with_retries<T>(
        &self,
        attempts: EarlierAttempts,
        wait: &dyn Fn(Duration) -> bool,
        once: impl Fn() -> Result<T, FetchError>,
    ) -> Result<T, FetchError> {
        let (began, starting) = (Instant::now(), self.retry_policy.starting);
        loop {
            match self.retry(attempts, wait, &once) {
                Err(FetchError { then: RetryAdvice::WaitForServer, .. }) if began.elapsed() < starting && wait(LOOK) => {}
                Err(FetchError { sentence, then: RetryAdvice::WaitForServer }) => {
                    let sentence = format!("{sentence}, for {} s", starting.as_secs_f64());
                    return Err(FetchError { sentence, then: RetryAdvice::WaitForServer });
                }
                done => return done,
            }
        }
    }

    fn retry<T>(
        &self,
        EarlierAttempts { began, failed: made }: EarlierAttempts,
        wait: &dyn Fn(Duration) -> bool,
        once: impl Fn() -> Result<T, FetchError>,
    ) -> Result<T, FetchError> {
        let RetryPolicy { attempts, whole, mut pause, .. } = self.retry_policy;
        let mut attempt = made + 1;
        loop {
            let error = match once() {
                Ok(done) => return Ok(done),
                Err(fault) if fault.then != RetryAdvice::Retry => return Err(fault),
                Err(FetchError { sentence, .. }) => sentence,
            };
            if attempt == attempts || began.elapsed() + pause > whole || !wait(pause) {
                let whole = whole.as_secs_f64();
                let tried = format!("attempt {attempt}; at most {attempts} are made, none {whole} s after the first");
                return Err(format!("{error} ({tried})").into());
            }
            pause *= 2;
            attempt += 1;
        }
    }

    fn try_once(
        &self,
        url: &str,
        largest: u64,
        check_status: fn(u16) -> Result<(), String>,
        came: &dyn Fn(u64),
    ) -> Result<FetchedBody, FetchError> {
        let _under_way = self.meter.under_way();
        let called = self.agent.get(url).call().map_err(|e| self.fault(&e));
        // A refused connection is no request.
        if !matches!(called, Err(FetchError { then: RetryAdvice::WaitForServer, .. })) {
            self.meter.count_request();
        }
        let mut response = called?;
        let status = response.status().as_u16();
        check_status(status).map_err(|sentence| FetchError {
            sentence,
            then: if NOBODY_BEHIND.contains(&status) { RetryAdvice::WaitForServer } else { RetryAdvice::Retry },
        })?;
        let tag = response.headers().get("etag").and_then(|tag| tag.to_str().ok()).unwrap_or_default();
        let hash = hash_from_etag(tag)?.to_owned();
        let read = self.read(response.body_mut().as_reader(), largest, came);
        let (body, held) = read.map_err(|e| match OverBudget::in_io_error(&e) {
            Some(error) => FetchError { sentence: error.to_string(), then: RetryAdvice::GiveUp },
            None => e.downcast::<ureq::Error>().map_or_else(|e| e.to_string(), |e| self.error_text(&e)).into(),
        })?;
        check_hash(&body, &hash)?;
        Ok((body, held))
    }

    /// Converts an error before the response.
    fn fault(&self, error: &ureq::Error) -> FetchError {
        let refused = matches!(error, ureq::Error::Io(e) if e.kind() == io::ErrorKind::ConnectionRefused);
        FetchError {
            sentence: self.error_text(error),
            then: if refused { RetryAdvice::WaitForServer } else { RetryAdvice::Retry },
        }
    }

    fn error_text(&self, error: &ureq::Error) -> String {
        match error {
            ureq::Error::Timeout(_) => format!("nothing has come for {} s", self.retry_policy.stall.as_secs_f64()),
            ureq::Error::Io(e) if e.get_ref().is_some() => e.to_string(),
            e => e.to_string(),
        }
    }

    fn read(&self, mut reader: impl Read, largest: u64, came: &dyn Fn(u64)) -> io::Result<(Vec<u8>, MemoryReservation)> {
        let RetryPolicy { stall, slowest, .. } = self.retry_policy;
        let began = Instant::now();
        let (mut body, mut chunk) = (CountedBuffer::new(&self.budget, "what a server sends"), vec![0; 1 << 14]);
        loop {
            let n = reader.read(&mut chunk)?;
            body.write_all(&chunk[..n])?;
            came(body.len() as u64);
            if n == 0 {
                return Ok(body.into_parts());
            }
            if body.len() as u64 > largest {
                return Err(io::Error::other(format!("too long: more than {largest} bytes")));
            }
            if began.elapsed() > stall + Duration::from_secs(body.len() as u64 / slowest) {
                return Err(io::Error::other(format!("too slow: less than {slowest} bytes/s")));
            }
        }
    }
}

/// Waits; the content is still needed.
fn sleep(pause: Duration) -> bool {
    thread::sleep(pause);
    true
}
