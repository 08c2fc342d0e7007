//! Requests that are made again where they fail.

use super::{DIGITS, HASH, LATER, TEXTURES, hash_of};
use basrelief_input::{Budget, Growing, Held, OverBudget};
use std::io::{self, Read, Write};
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
    /// Longest that a server may go on making its list of polygons.
    pub making: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self {
            stall: Duration::from_secs(10),
            slowest: SLOWEST,
            attempts: 5,
            pause: Duration::from_millis(100),
            whole: Duration::from_secs(20),
            making: Duration::from_secs(600),
        }
    }
}

/// Slowest path that is waited for, on either side \[bytes/s\]: a modem's 56 kbit/s are 7,000, and 32 requests may share them.
pub(super) const SLOWEST: u64 = 100;
/// Most requests in flight.
pub const MOST_IN_FLIGHT: u32 = 32;

/// Gets what a server has. Clones share their connections.
#[derive(Clone, Debug)]
pub struct Fetcher {
    agent: Agent,
    base: String,
    patience: Patience,
    /// Hash of the server's textures, where it has told one with the polygons.
    textures: Option<String>,
    budget: Budget,
}

/// What a server has sent, what that takes, and what it says its textures are.
type Answer = (Vec<u8>, Held, Option<String>);

/// Why a request has failed.
struct Fault {
    sentence: String,
    then: Then,
}

/// What another attempt would come to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Then {
    /// Something else, perhaps.
    Again,
    /// The same.
    Never,
    /// What was asked for, once the server has made it.
    Later,
}

impl From<String> for Fault {
    fn from(sentence: String) -> Self {
        Self { sentence, then: Then::Again }
    }
}

impl Fetcher {
    /// Of the server at `base`; what it sends is counted against a budget of its own.
    #[cfg(test)]
    pub fn new(base: &str, patience: Patience) -> Self {
        Self::within(base, patience, &Budget::default())
    }

    /// Of the server at `base`, within a budget.
    pub fn within(base: &str, patience: Patience, budget: &Budget) -> Self {
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
        let base = base.trim_end_matches('/').to_owned();
        Self { agent: config.build().into(), base, patience, textures: None, budget: budget.clone() }
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
        let (list, held, textures) =
            self.made(pause, || self.once(&url, u64::MAX, &came)).map_err(|Fault { sentence, then }| {
                let hint = if then == Then::Again { "; is `basrelief serve` running there?" } else { "" };
                format!("{url}: {sentence}{hint}")
            })?;
        // It is there to the end of the program.
        held.keep();
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
            let (body, _, textures) = self.once(&url, largest, &|_| ())?;
            if self.textures.is_some() && textures != self.textures {
                return Err("the server has other textures than when it sent the polygons; begin again".to_owned().into());
            }
            Ok(check(&body).map(|()| body)?)
        };
        self.retry(pause, checked).map_err(|fault| format!("{url}: {}", fault.sentence))
    }

    /// What is sent is counted against it.
    pub fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Ends what is under way, in clones too.
    pub fn shut_down(&self) {
        self.agent.clone().shutdown();
    }

    /// Asks again, as long as the server says that it is at work on what is asked for.
    fn made<T>(&self, wait: impl Fn(Duration) -> bool, once: impl Fn() -> Result<T, Fault>) -> Result<T, Fault> {
        let Patience { making, pause, .. } = self.patience;
        let began = Instant::now();
        loop {
            match self.retry(&wait, &once) {
                Err(Fault { then: Then::Later, .. }) if began.elapsed() < making && wait(pause) => {}
                Err(Fault { sentence, then: Then::Later }) => {
                    return Err(Fault { sentence: format!("{sentence}, after {} s", making.as_secs_f64()), then: Then::Later });
                }
                done => return done,
            }
        }
    }

    fn retry<T>(&self, wait: impl Fn(Duration) -> bool, once: impl Fn() -> Result<T, Fault>) -> Result<T, Fault> {
        let Patience { attempts, whole, mut pause, .. } = self.patience;
        let (began, mut attempt) = (Instant::now(), 1);
        loop {
            let error = match once() {
                Ok(done) => return Ok(done),
                Err(fault) if fault.then != Then::Again => return Err(fault),
                Err(Fault { sentence, .. }) => sentence,
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

    fn once(&self, url: &str, largest: u64, came: &dyn Fn(u64)) -> Result<Answer, Fault> {
        let mut response = self.agent.get(url).call().map_err(|e| self.told(&e))?;
        match response.status().as_u16() {
            200 => {}
            LATER if response.headers().contains_key(TEXTURES) => {
                return Err(Fault { sentence: "the server is still making its list".into(), then: Then::Later });
            }
            status => return Err(format!("http status: {status}").into()),
        }
        let header = |name| response.headers().get(name).and_then(|h| h.to_str().ok()).map(str::to_owned);
        let (hash, textures) = (header(HASH), header(TEXTURES));
        let hash = hash.ok_or_else(|| format!("no header {HASH}: not a server of tiles"))?;
        let read = self.read(response.body_mut().as_reader(), largest, came);
        let (body, held) = read.map_err(|e| match OverBudget::within(&e) {
            Some(error) => Fault { sentence: error.to_string(), then: Then::Never },
            None => e.downcast::<ureq::Error>().map_or_else(|e| e.to_string(), |e| self.told(&e)).into(),
        })?;
        if hash != hash_of(&body) {
            return Err("corrupt: the content does not have its hash".to_owned().into());
        }
        Ok((body, held, textures))
    }

    fn told(&self, error: &ureq::Error) -> String {
        match error {
            ureq::Error::Timeout(_) => format!("nothing has come for {} s", self.patience.stall.as_secs_f64()),
            e => e.to_string(),
        }
    }

    fn read(&self, mut reader: impl Read, largest: u64, came: &dyn Fn(u64)) -> io::Result<(Vec<u8>, Held)> {
        let Patience { stall, slowest, .. } = self.patience;
        let began = Instant::now();
        let (mut body, mut chunk) = (Growing::new(&self.budget, "what a server sends"), vec![0; 1 << 14]);
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
