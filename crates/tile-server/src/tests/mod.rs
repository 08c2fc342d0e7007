//! Faults of the network path: slow, cut, truncated, corrupt, refused, gone. No tile is ever lost.

mod crowd;
mod faults;
mod hashes;
mod keeping;
mod serving;
mod several;
mod turning;

use crate::client::{Fetcher, NoProgress, RemoteTiles, RetryPolicy, TileCache, TileStore};
use crate::protocol::{GroupHashes, group_of, hash_of, hash_of_list, hash_of_picture, hash_of_tile, hex, tiles_in_group};
use crate::server::SceneService;
use basrelief_deferred_renderer::{PyramidCut, ServedTexture, TextureMemory, TexturePage, TileEncoding, TileFormat, TileSource};
use basrelief_input::MemoryPool;
use basrelief_signals::{Image, Sampler, Texture};
use basrelief_sim::TileFetch;
use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

/// Listens at an address of its own. Clients of other tests take ports of 127.0.0.1, and other servers ports of a shared address, so a port
/// could be taken before a server listens there again. (Computers without further loopback addresses use 127.0.0.1.)
fn listener_of_its_own() -> TcpListener {
    static LISTENERS: AtomicU8 = AtomicU8::new(1);
    let number = LISTENERS.fetch_add(1, Ordering::Relaxed);
    TcpListener::bind(SocketAddr::from(([127, 0, 1, number], 0))).or_else(|_| TcpListener::bind("127.0.0.1:0")).unwrap()
}

/// Faults that another attempt does not meet.
const PASSING: [ResponseFault; 9] = [
    ResponseFault::Status(500),
    ResponseFault::Corrupt,
    ResponseFault::Truncated,
    ResponseFault::Cut,
    ResponseFault::Silent,
    ResponseFault::Stalled,
    ResponseFault::Dripping,
    ResponseFault::Undecodable,
    ResponseFault::OtherSize,
];

/// Fault of a response.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ResponseFault {
    None,
    Status(u16),
    Corrupt,
    Truncated,
    /// The connection closes without a response.
    Cut,
    /// No data arrives before the timeout.
    Silent,
    /// No fault, but late.
    Late,
    /// Half of it arrives, then nothing.
    Stalled,
    /// One byte at a time, slowly.
    Dripping,
    /// The head one byte at a time, slowly.
    DrippingHead,
    /// Informational responses without end, slowly.
    Informing,
    /// Much more than a tile, with a valid hash.
    Endless,
    /// No tile, with a valid hash.
    Undecodable,
    /// A tile of another size, with a valid hash.
    OtherSize,
}

const LATE: Duration = Duration::from_millis(60);

/// A policy that never gives up without a fault, even on a busy computer, so that requests can be counted.
const PATIENT: RetryPolicy = RetryPolicy {
    stall: Duration::from_secs(20),
    slowest: 1000,
    attempts: 3,
    pause: Duration::from_millis(5),
    whole: Duration::from_secs(20),
    starting: Duration::from_millis(300),
};

/// A policy with a short timeout.
const HASTY: RetryPolicy = RetryPolicy { stall: Duration::from_secs(1), ..PATIENT };

/// Makes a client with a memory limit of its own.
fn new_fetcher(url: &str, policy: RetryPolicy) -> Fetcher {
    Fetcher::new(url, policy, &MemoryPool::default())
}

/// Returns the retry policy for a fault: a short timeout if only a timeout detects the fault.
fn retry_policy(fault: ResponseFault) -> RetryPolicy {
    if matches!(
        fault,
        ResponseFault::Silent
            | ResponseFault::Stalled
            | ResponseFault::Dripping
            | ResponseFault::DrippingHead
            | ResponseFault::Informing
    ) {
        HASTY
    } else {
        PATIENT
    }
}

fn texture() -> Arc<Texture> {
    let texels = (0..200 * 90).map(|i: u32| [i as u8, (i / 7) as u8, (i / 200) as u8, 255]).collect();
    let levels = vec![Image { width: 200, height: 90, texels }];
    Arc::new(Texture { id: 4, name: "plane".into(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

/// Returns the texture as it is in a client: without texels.
fn texture_without_texels() -> Arc<Texture> {
    let levels = vec![Image { width: 200, height: 90, texels: vec![] }];
    Arc::new(Texture { levels, elsewhere: Some(hash_of_picture(&texture())), ..Texture::clone(&texture()) })
}

/// Returns a service; only the arrival of its scene matters here.
fn served() -> SceneService {
    serving_scene(b"scene".to_vec())
}

fn serving_scene(scene: Vec<u8>) -> SceneService {
    SceneService::new(scene, "<p>page".into(), [texture()])
}

/// Returns the address of one or several tiles of the texture.
fn address(numbers: impl std::fmt::Display) -> String {
    format!("/tile/{}/64x64/png/{numbers}", hex(&hash_of_picture(&texture())))
}

fn page() -> Arc<TexturePage> {
    Arc::new(TexturePage::new(0, &texture(), PyramidCut::default(), 0))
}

/// Answers a request with a fault.
fn respond(served: &SceneService, mut stream: TcpStream, fault: ResponseFault) {
    let mut lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
    let Some(first) = lines.next() else { return };
    while lines.next().is_some_and(|line| !line.is_empty()) {}
    let mut body = match first.split(' ').nth(1).unwrap_or("/") {
        "/scene" => b"scene".to_vec(),
        tile => served.tiles(tile.trim_start_matches("/tile/")).unwrap_or_default().0,
    };
    match fault {
        ResponseFault::Endless => body.resize(8 << 20, 0),
        ResponseFault::Undecodable => body.reverse(),
        ResponseFault::OtherSize => body = TileEncoding::Png.encode(&[[1; 4]; 6], [3, 2], 85).unwrap(),
        _ => {}
    }
    let (hash, length) = (hash_of(&body), body.len());
    let status = if let ResponseFault::Status(status) = fault { status } else { 200 };
    match fault {
        ResponseFault::Cut => return,
        ResponseFault::Silent => thread::sleep(3 * HASTY.stall),
        ResponseFault::Late => thread::sleep(LATE),
        ResponseFault::Corrupt => body[0] ^= 1,
        ResponseFault::Truncated | ResponseFault::Stalled => body.truncate(length / 2),
        _ => {}
    }
    let head = format!("HTTP/1.1 {status} x\r\nContent-Length: {length}\r\nETag: \"{hash}\"\r\nConnection: close\r\n\r\n");
    let parts = body.chunks(if fault == ResponseFault::Dripping { 1 } else { body.len().max(1) });
    // The client may have given up and closed the connection.
    let mut sent = match fault {
        ResponseFault::DrippingHead => drip(&stream, head.as_bytes().chunks(1)),
        ResponseFault::Informing => drip(&stream, std::iter::repeat_n(&b"HTTP/1.1 103 Early Hints\r\n\r\n"[..], 1000)),
        _ => stream.write_all(head.as_bytes()),
    };
    for part in parts {
        sent = sent.and_then(|()| stream.write_all(part));
        if fault == ResponseFault::Dripping && sent.is_ok() {
            thread::sleep(Duration::from_millis(10));
        }
    }
    if fault == ResponseFault::Stalled {
        thread::sleep(3 * HASTY.stall);
    }
}

/// Sends parts slowly: each before a stall, all of them much later.
fn drip<'a>(mut stream: &TcpStream, parts: impl Iterator<Item = &'a [u8]>) -> std::io::Result<()> {
    for part in parts {
        stream.write_all(part)?;
        thread::sleep(HASTY.stall / 10);
    }
    Ok(())
}

/// Returns a listener, its address and its request counter.
fn listening() -> (TcpListener, String, Arc<AtomicU32>) {
    let listener = listener_of_its_own();
    let url = format!("http://{}/", listener.local_addr().unwrap());
    (listener, url, Arc::default())
}

/// Starts a server whose response number n has this fault. Returns its address and its request counter. It stops listening after `answers`
/// responses.
fn faulty(answers: u32, fault: impl Fn(u32) -> ResponseFault + Send + 'static) -> (String, Arc<AtomicU32>) {
    let (listener, url, count) = listening();
    let counted = Arc::clone(&count);
    thread::spawn(move || {
        let served = Arc::new(served());
        for stream in listener.incoming().take(answers as usize).flatten() {
            let fault = fault(counted.fetch_add(1, Ordering::SeqCst));
            let served = Arc::clone(&served);
            thread::spawn(move || respond(&served, stream, fault));
        }
    });
    (url, count)
}

fn store_in(cache: TileCache) -> TileStore {
    TileStore { cache, failed: Arc::default() }
}

/// Returns the lists of the groups of a texture.
fn lists(texture: &Arc<Texture>, fetch: &TileFetch) -> Vec<Vec<u8>> {
    let page = TexturePage::new(0, texture, PyramidCut { tile: fetch.format.size, ..PyramidCut::default() }, 0);
    let mut served = ServedTexture::new(Arc::clone(texture));
    let mut hash = |tile| {
        let size = page.texels_of(tile).size();
        hash_of_tile(fetch.format, &served.tile(&page, tile), size).unwrap()
    };
    let groups = 0..=group_of(page.tiles() - 1);
    groups.map(|group| tiles_in_group(group, page.tiles()).flat_map(&mut hash).collect()).collect()
}

/// Makes a tile source that knows the lists of hashes, so that it requests tiles alone.
fn source(fetcher: Fetcher, fetch: TileFetch, kept: Option<TileStore>) -> RemoteTiles {
    let (picture, mut hashes, lists) = (hash_of_picture(&texture()), GroupHashes::default(), lists(&texture(), &fetch));
    hashes.insert(picture, lists.iter().map(|list| hash_of_list(list)).collect());
    let source = RemoteTiles::new(fetcher, fetch, hashes, kept, Arc::new(NoProgress));
    (0..).zip(lists).for_each(|(group, list)| source.insert_list(&hex(&picture), group, list));
    source
}

fn tiles(url: &str, in_flight: u32, kept: Option<TileStore>) -> RemoteTiles {
    source(new_fetcher(url, PATIENT), fetch(in_flight, 1), kept)
}

/// Makes a tile source without a cache.
fn source_without_cache(fetcher: Fetcher, fetch: TileFetch) -> RemoteTiles {
    source(fetcher, fetch, None)
}

/// Format of tiles.
const PNG: TileFormat = TileFormat { size: [64, 64], encoding: TileEncoding::Png, quality: 85 };

/// Returns options for PNG tiles.
fn fetch(requests: u32, tiles_per_request: u32) -> TileFetch {
    TileFetch { format: PNG, requests, tiles_per_request, left_at_ms: vec![] }
}

fn announce_all(source: &mut dyn TileSource) {
    let page = page();
    source.offer(&texture_without_texels());
    source.announce(&(0..page.tiles()).map(|tile| (Arc::clone(&page), tile)).collect::<Vec<_>>());
}

/// Fetches all tiles of the texture in order. An error has the number of the first missing tile.
fn all(source: &mut dyn TileSource) -> Result<Vec<Arc<[u8]>>, (u32, String)> {
    announce_all(source);
    let page = page();
    (0..page.tiles()).map(|tile| source.tile(&page, tile).map_err(|e| (tile, e))).collect()
}

/// Returns the same tiles from a server in memory.
fn expected() -> Vec<Arc<[u8]>> {
    let mut source = TextureMemory::new(TileEncoding::Png, 85);
    source.offer(&texture());
    let page = page();
    (0..page.tiles()).map(|tile| source.tile(&page, tile).unwrap()).collect()
}
