//! Requests that are made again where they fail.

use super::{DIGITS, HASH, TEXTURES, hash_of};
use std::io::{self, Read};
use std::thread;
use std::time::{Duration, Instant};
use ureq::Agent;

/// How long and how often is tried.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Longest that nothing may come.
    pub stall: Duration,
    /// What must have come on average when a request has lasted longer than that \[bytes/s\].
    pub slowest: u64,
    /// Requests for the same thing before it is given up.
    pub attempts: u32,
    /// Pause before the second attempt; it doubles from one to the next.
    pub pause: Duration,
    /// No further attempt begins later than this behind the first.
    pub whole: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self {
            stall: Duration::from_secs(10),
            slowest: SLOWEST,
            attempts: 5,
            pause: Duration::from_millis(100),
            whole: Duration::from_secs(20),
        }
    }
}

/// Slowest path that is waited for, on either side \[bytes/s\]: a modem's 56 kbit/s are 7,000, and 32 requests may share them.
pub(super) const SLOWEST: u64 = 100;
/// Most requests in flight.
pub const MOST_IN_FLIGHT: u32 = 32;
/// Largest list of polygons that is believed \[bytes\].
const LARGEST_LIST: u64 = 1 << 30;

/// Gets what a server has. Clones share their connections.
#[derive(Clone, Debug)]
pub struct Fetcher {
    agent: Agent,
    base: String,
    patience: Patience,
    /// Hash of the server's textures, where it has told one with the polygons.
    textures: Option<String>,
}

/// What a server has sent, and what it says its textures are.
type Answer = (Vec<u8>, Option<String>);

impl Fetcher {
    /// Of the server at `base`.
    pub fn new(base: &str, patience: Patience) -> Self {
        let stall = Some(patience.stall);
        let config = Agent::config_builder()
            .timeout_resolve(stall)
            .timeout_connect(stall)
            .timeout_recv_response(stall)
            .timeout_per_read(stall)
            .timeout_per_write(stall)
            .max_idle_connections(MOST_IN_FLIGHT as usize)
            .max_idle_connections_per_host(MOST_IN_FLIGHT as usize)
            .http_status_as_error(false)
            // What stands elsewhere is not what the user has named.
            .max_redirects(0)
            .proxy(None);
        Self { agent: config.build().into(), base: base.trim_end_matches('/').to_owned(), patience, textures: None }
    }

    /// Fetches the polygons, and the hash of the textures: that of the list, where the server tells none. From then on an
    /// answer of a server that has other textures is a fault. `came` is told how many bytes have come.
    ///
    /// # Errors
    /// A sentence, when all attempts have failed.
    pub fn polygons(&mut self, came: impl Fn(u64)) -> Result<(Vec<u8>, String), String> {
        let url = format!("{}/polygons", self.base);
        let pause = |pause| {
            thread::sleep(pause);
            true
        };
        let (list, textures) = self
            .retry(pause, || self.once(&url, LARGEST_LIST, &came))
            .map_err(|e| format!("{url}: {e}; is `basrelief serve` running there?"))?;
        self.textures = textures.filter(|hash| hash.len() == DIGITS && hash.bytes().all(|b| b.is_ascii_hexdigit()));
        let known = self.textures.clone().unwrap_or_else(|| hash_of(&list));
        Ok((list, known))
    }

    /// Fetches a tile of at most `largest` bytes that passes the check. `pause` says whether it is still wanted afterwards.
    ///
    /// # Errors
    /// A sentence, when all attempts have failed.
    pub fn tile(
        &self,
        tile: &str,
        largest: u64,
        check: impl Fn(&[u8]) -> Result<(), String>,
        pause: impl Fn(Duration) -> bool,
    ) -> Result<Vec<u8>, String> {
        let url = format!("{}/{tile}", self.base);
        let checked = || {
            let (body, textures) = self.once(&url, largest, &|_| ())?;
            if self.textures.is_some() && textures != self.textures {
                return Err("the server has other textures than when it sent the polygons; begin again".into());
            }
            check(&body).map(|()| body)
        };
        self.retry(pause, checked).map_err(|e| format!("{url}: {e}"))
    }

    /// Ends what is under way, in clones too.
    pub fn shut_down(&self) {
        self.agent.clone().shutdown();
    }

    fn retry<T>(&self, wait: impl Fn(Duration) -> bool, once: impl Fn() -> Result<T, String>) -> Result<T, String> {
        let Patience { attempts, whole, mut pause, .. } = self.patience;
        let (began, mut attempt) = (Instant::now(), 1);
        loop {
            let error = match once() {
                Ok(done) => return Ok(done),
                Err(error) => error,
            };
            if attempt == attempts || began.elapsed() + pause > whole || !wait(pause) {
                let whole = whole.as_secs_f64();
                return Err(format!("{error} (attempt {attempt}; at most {attempts} are made, none {whole} s after the first)"));
            }
            pause *= 2;
            attempt += 1;
        }
    }

    fn once(&self, url: &str, largest: u64, came: &dyn Fn(u64)) -> Result<Answer, String> {
        let mut response = self.agent.get(url).call().map_err(|e| self.told(&e))?;
        if response.status() != 200 {
            return Err(format!("http status: {}", response.status().as_u16()));
        }
        let header = |name| response.headers().get(name).and_then(|h| h.to_str().ok()).map(str::to_owned);
        let (hash, textures) = (header(HASH), header(TEXTURES));
        let hash = hash.ok_or_else(|| format!("no header {HASH}: not a server of tiles"))?;
        let read = self.read(response.body_mut().as_reader(), largest, came);
        let body = read.map_err(|e| e.downcast::<ureq::Error>().map_or_else(|e| e.to_string(), |e| self.told(&e)))?;
        if hash != hash_of(&body) { Err("corrupt: the content does not have its hash".into()) } else { Ok((body, textures)) }
    }

    fn told(&self, error: &ureq::Error) -> String {
        match error {
            ureq::Error::Timeout(_) => format!("nothing has come for {} s", self.patience.stall.as_secs_f64()),
            e => e.to_string(),
        }
    }

    fn read(&self, mut reader: impl Read, largest: u64, came: &dyn Fn(u64)) -> io::Result<Vec<u8>> {
        let Patience { stall, slowest, .. } = self.patience;
        let began = Instant::now();
        let (mut body, mut chunk) = (Vec::new(), vec![0; 1 << 14]);
        loop {
            let n = reader.read(&mut chunk)?;
            body.extend_from_slice(&chunk[..n]);
            came(body.len() as u64);
            if n == 0 {
                return Ok(body);
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
