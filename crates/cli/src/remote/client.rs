//! The client: fetches tiles ahead, several at a time, and again where they fail.

use super::{HASH, TileCache, hash_of};
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{Cut, Page, TileEncoding, TileSource};
use basrelief_signals::Texture;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::io::Read;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use ureq::Agent;

/// How long and how often is tried.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Longest that one request may take.
    pub request: Duration,
    /// Requests for the same thing before it is given up.
    pub attempts: u32,
    /// Pause before the second attempt; it doubles from one to the next.
    pub pause: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self { request: Duration::from_secs(10), attempts: 5, pause: Duration::from_millis(100) }
    }
}

/// Largest list of polygons that is believed \[bytes\].
const LARGEST_LIST: u64 = 1 << 30;
/// Largest tile that is believed: more than 512 x 512 texels take in any encoding \[bytes\].
const LARGEST_TILE: u64 = 1 << 21;

/// Gets an address, with retries; the body is what the server hashed.
fn get(agent: &Agent, url: &str, largest: u64, patience: Patience) -> Result<Vec<u8>, String> {
    let mut pause = patience.pause;
    let mut attempt = 1;
    loop {
        match get_once(agent, url, largest) {
            Ok(body) => return Ok(body),
            Err(error) if attempt >= patience.attempts => return Err(format!("{error} (after {attempt} attempts)")),
            Err(_) => thread::sleep(pause),
        }
        pause *= 2;
        attempt += 1;
    }
}

fn get_once(agent: &Agent, url: &str, largest: u64) -> Result<Vec<u8>, String> {
    let mut response = agent.get(url).call().map_err(|e| e.to_string())?;
    if response.status() != 200 {
        return Err(format!("http status: {}", response.status().as_u16()));
    }
    let expected = response.headers().get(HASH).and_then(|h| h.to_str().ok()).map(str::to_owned);
    let length = response.headers().get("content-length").and_then(|h| h.to_str().ok()).and_then(|n| n.parse::<u64>().ok());
    let mut body = Vec::new();
    response.body_mut().as_reader().take(largest + 1).read_to_end(&mut body).map_err(|e| e.to_string())?;
    if body.len() as u64 > largest {
        return Err(format!("too long: more than {largest} bytes"));
    }
    if length.is_some_and(|n| n != body.len() as u64) {
        return Err(format!("truncated: {} of {} bytes came", body.len(), length.unwrap_or(0)));
    }
    match expected {
        Some(hash) if hash == hash_of(&body) => Ok(body),
        Some(_) => Err("corrupt: the content does not have its hash".into()),
        None => Err(format!("no header {HASH}: not a server of tiles")),
    }
}

fn agent(patience: Patience) -> Agent {
    // What stands elsewhere is not what the user has named.
    Agent::config_builder().timeout_global(Some(patience.request)).max_redirects(0).build().into()
}

/// Fetches the polygons of a server.
///
/// # Errors
/// A sentence, when all attempts have failed.
pub fn fetch_polygons(base: &str, patience: Patience) -> Result<Vec<u8>, String> {
    let url = format!("{}/polygons", base.trim_end_matches('/'));
    get(&agent(patience), &url, LARGEST_LIST, patience).map_err(|e| format!("{url}: {e}"))
}

/// What the threads share.
#[derive(Debug, Default)]
struct Shared {
    /// Tiles to fetch, in order.
    queue: VecDeque<String>,
    /// Those that are there, or have failed for good.
    done: BTreeMap<String, Result<Arc<[u8]>, String>>,
    closed: bool,
}

#[derive(Debug, Default)]
struct Exchange {
    shared: Mutex<Shared>,
    changed: Condvar,
}

impl Exchange {
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next tile to fetch; none when all is over.
    fn take(&self) -> Option<String> {
        let mut shared = self.lock();
        loop {
            if shared.closed {
                return None;
            }
            if let Some(tile) = shared.queue.pop_front() {
                return Some(tile);
            }
            shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits until a tile that was asked for is there.
    fn wait(&self, tile: &str) -> Result<Arc<[u8]>, String> {
        let mut shared = self.lock();
        loop {
            if let Some(done) = shared.done.remove(tile) {
                return done;
            }
            shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Tiles of a server, fetched as they are announced, several at a time.
#[derive(Debug)]
pub struct RemoteTiles {
    encoding: TileEncoding,
    quality: u8,
    textures: BTreeMap<u32, [u32; 2]>,
    /// Tiles announced that nobody has taken yet.
    announced: BTreeSet<String>,
    exchange: Arc<Exchange>,
    threads: Vec<JoinHandle<()>>,
}

impl RemoteTiles {
    /// Fetches from `base`, at most `in_flight` tiles at a time. A tile that comes is kept in `cache`, at once.
    pub fn new(
        base: &str,
        (encoding, quality): (TileEncoding, u8),
        in_flight: u32,
        patience: Patience,
        cache: Option<TileCache>,
    ) -> Self {
        let exchange = Arc::new(Exchange::default());
        let base = base.trim_end_matches('/').to_owned();
        let worker = |_| {
            let (exchange, base, cache) = (Arc::clone(&exchange), base.clone(), cache.clone());
            thread::spawn(move || work(&exchange, &base, patience, cache.as_ref()))
        };
        let threads = (0..in_flight.clamp(1, 32)).map(worker).collect();
        Self { encoding, quality, textures: BTreeMap::new(), announced: BTreeSet::new(), exchange, threads }
    }

    /// Address of a tile below the server's.
    fn address(&self, page: &Page, tile: u32) -> String {
        let encoding = match self.encoding {
            TileEncoding::Raw => "raw",
            TileEncoding::Png => "png",
            TileEncoding::Jpeg => "jpeg",
        };
        let [width, height] = page.cut.tile;
        format!("tile/{}/{width}x{height}/{encoding}/{}/{tile}", page.texture, self.quality)
    }
}

/// Fetches tiles until all is over.
fn work(exchange: &Exchange, base: &str, patience: Patience, cache: Option<&TileCache>) {
    let agent = agent(patience);
    while let Some(tile) = exchange.take() {
        let fetched = cache.and_then(|c| c.get(&tile)).map_or_else(|| fetch(&agent, base, &tile, patience, cache), Ok);
        exchange.lock().done.insert(tile, fetched.map(Arc::from));
        exchange.changed.notify_all();
    }
}

fn fetch(agent: &Agent, base: &str, tile: &str, patience: Patience, cache: Option<&TileCache>) -> Result<Vec<u8>, String> {
    let body = get(agent, &format!("{base}/{tile}"), LARGEST_TILE, patience).map_err(|e| format!("{base}/{tile}: {e}"))?;
    if let Some(cache) = cache {
        cache.put(tile, &body).map_err(|e| format!("--tile-cache: cannot be written: {e}"))?;
    }
    Ok(body)
}

impl TileSource for RemoteTiles {
    fn offer(&mut self, texture: &Arc<Texture>) {
        let size = texture.levels.first().map_or([1; 2], |image| [image.width, image.height]);
        self.textures.insert(texture.id, size);
    }

    fn announce(&mut self, tiles: &[(Arc<Page>, u32)]) {
        let addresses: Vec<String> = tiles.iter().map(|(page, tile)| self.address(page, *tile)).collect();
        self.announced.extend(addresses.iter().cloned());
        self.exchange.lock().queue.extend(addresses);
        self.exchange.changed.notify_all();
    }

    fn tile(&mut self, page: &Arc<Page>, tile: u32) -> Result<Arc<[u8]>, String> {
        let address = self.address(page, tile);
        if !self.announced.contains(&address) {
            self.announce(&[(Arc::clone(page), tile)]);
        }
        self.announced.remove(&address);
        self.exchange.wait(&address).map_err(|e| format!("{}: {e}", place_of(page, tile)))
    }

    /// As raw tiles: what they take otherwise, only the server knows.
    fn conventional_bytes(&self, cut: Cut) -> u64 {
        let finest = self.textures.values().map(|size| cut.finest(*size));
        finest.map(|[width, height]| 3 * u64::from(width) * u64::from(height)).sum()
    }
}

impl Drop for RemoteTiles {
    fn drop(&mut self) {
        self.exchange.lock().closed = true;
        self.exchange.changed.notify_all();
        for thread in self.threads.drain(..) {
            // A thread that has panicked has nothing to say any more.
            let _ = thread.join();
        }
    }
}
