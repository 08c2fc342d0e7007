//! `basrelief serve`: the server (110) as a program.

use super::{HASH, hash_of};
use basrelief_deferred_renderer::{Cut, Page, TextureMemory, TileEncoding, TileSource};
use basrelief_signals::{Texture, Wrap};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use tiny_http::{Header, Request, Response, Server};

/// Tiles of one size and encoding, as they are asked for.
type Offered = BTreeMap<(TileEncoding, u8), TextureMemory>;

/// Longest body of a request that is read over; none is expected \[bytes\].
const LONGEST_BODY: usize = 1 << 20;

/// What is offered.
#[derive(Debug)]
pub struct Served {
    polygons: Vec<u8>,
    textures: BTreeMap<u32, Arc<Texture>>,
    memories: Mutex<Offered>,
}

impl Served {
    /// Offers this list of polygons and these textures.
    pub fn new(polygons: Vec<u8>, textures: impl IntoIterator<Item = Arc<Texture>>) -> Self {
        let textures = textures.into_iter().map(|t| (t.id, t)).collect();
        Self { polygons, textures, memories: Mutex::new(BTreeMap::new()) }
    }

    /// The body for an address, or why there is none, with its status.
    pub fn answer(&self, address: &str) -> Result<Vec<u8>, (u16, String)> {
        if address == "/polygons" {
            return Ok(self.polygons.clone());
        }
        let asked = address.strip_prefix("/tile/").ok_or((404, "expected /polygons or /tile/...".to_owned()))?;
        let tile =
            AskedTile::parse(asked).ok_or((400, "expected /tile/TEXTURE/WIDTHxHEIGHT/ENCODING/QUALITY/NUMBER".to_owned()))?;
        let texture = self.textures.get(&tile.texture).ok_or((404, format!("there is no texture {}", tile.texture)))?;
        let cut = Cut { tile: tile.size, ..Cut::default() };
        let page = Arc::new(Page::new(0, texture, [Wrap::Clamp; 2], cut, 0));
        if tile.number >= page.tiles() {
            return Err((404, format!("texture {} has {} tiles", tile.texture, page.tiles())));
        }
        let mut memories = self.memories.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (tile.encoding, tile.quality);
        let memory = memories.entry(key).or_insert_with(|| TextureMemory::new(tile.encoding, tile.quality));
        memory.offer(texture);
        memory.tile(&page, tile.number).map(|bytes| bytes.to_vec()).map_err(|e| (500, e))
    }
}

/// A tile as it is asked for.
struct AskedTile {
    texture: u32,
    size: [u32; 2],
    encoding: TileEncoding,
    quality: u8,
    number: u32,
}

impl AskedTile {
    fn parse(asked: &str) -> Option<Self> {
        let parts: Vec<&str> = asked.split('/').collect();
        let [texture, size, encoding, quality, number] = parts.try_into().ok()?;
        let (width, height) = size.split_once('x')?;
        let side = |s: &str| s.parse::<u32>().ok().filter(|n| n.is_power_of_two() && (4..=512).contains(n));
        let encoding = match encoding {
            "raw" => TileEncoding::Raw,
            "png" => TileEncoding::Png,
            "jpeg" => TileEncoding::Jpeg,
            _ => return None,
        };
        let quality = quality.parse().ok().filter(|q| (1..=100).contains(q))?;
        let size = [side(width)?, side(height)?];
        Some(Self { texture: texture.parse().ok()?, size, encoding, quality, number: number.parse().ok()? })
    }
}

/// Opens a server at an address; port 0 takes any that is free.
pub fn listen(address: SocketAddr) -> Result<Server, String> {
    Server::http(address).map_err(|e| format!("{address}: cannot be listened at: {e}"))
}

impl Served {
    /// Answers until the server is unblocked.
    pub fn run(&self, server: &Server) {
        for request in server.incoming_requests() {
            self.respond(request);
        }
    }

    fn respond(&self, request: Request) {
        if request.body_length().is_some_and(|length| length > LONGEST_BODY) {
            // The library, dropping it, would make room for all that it says is to come, and end the process where there
            // is none. The connection is lost to whoever did this.
            std::mem::forget(request);
            return;
        }
        let (status, body) = match self.answer(request.url()) {
            Ok(body) => (200, body),
            Err((status, why)) => (status, why.into_bytes()),
        };
        let mut response = Response::new(status.into(), vec![], Cursor::new(body.clone()), Some(body.len()), None);
        if let Ok(header) = Header::from_bytes(HASH, hash_of(&body)) {
            response.add_header(header);
        }
        // A client that has gone away has no use for it.
        let _ = request.respond(response);
    }
}
