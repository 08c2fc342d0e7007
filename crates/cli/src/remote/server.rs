//! `basrelief serve`: the server (110) as a program.

use super::{HASH, TEXTURES, hash_of};
use basrelief_deferred_renderer::{Cut, Page, ServedTexture, TileEncoding};
use basrelief_signals::{Texture, Wrap};
use oxhttp::model::header::CONNECTION;
use oxhttp::model::{Body, HeaderValue, Method, Request, Response, StatusCode};
use oxhttp::{ListeningServer, Server};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::net::{SocketAddr, TcpListener};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// What a server grants its clients.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Longest that a connection may neither send nor take anything.
    pub idle: Duration,
    /// Connections at a time; more wait until others are closed.
    pub connections: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { idle: Duration::from_secs(10), connections: 256 }
    }
}

/// A texture that is offered.
#[derive(Debug)]
pub(super) struct Offered {
    texture: Arc<Texture>,
    /// Its layers, kept once they are asked for. Tiles are not: there are as many as ways to cut and to encode them.
    pub(super) pyramid: Mutex<ServedTexture>,
}

/// What is offered.
#[derive(Debug)]
pub struct Served {
    polygons: Arc<[u8]>,
    hash_of_polygons: String,
    hash_of_textures: String,
    pub(super) textures: BTreeMap<u32, Offered>,
}

impl Served {
    /// Offers this list of polygons and these textures, which have this hash.
    pub fn new(polygons: Vec<u8>, textures: impl IntoIterator<Item = Arc<Texture>>, hash_of_textures: String) -> Self {
        let offered = |texture: Arc<Texture>| {
            let pyramid = Mutex::new(ServedTexture::new(Arc::clone(&texture)));
            (texture.id, Offered { texture, pyramid })
        };
        let textures = textures.into_iter().map(offered).collect();
        Self { hash_of_polygons: hash_of(&polygons), polygons: polygons.into(), hash_of_textures, textures }
    }

    /// The tile at an address, or why there is none, with its status. Encoded without a lock: several at a time.
    pub fn tile(&self, address: &str) -> Result<Vec<u8>, (u16, String)> {
        let asked = address.strip_prefix("/tile/").ok_or((404, "expected /polygons or /tile/...".to_owned()))?;
        let tile =
            AskedTile::parse(asked).ok_or((400, "expected /tile/TEXTURE/WIDTHxHEIGHT/ENCODING/QUALITY/NUMBER".to_owned()))?;
        let offered = self.textures.get(&tile.texture).ok_or((404, format!("there is no texture {}", tile.texture)))?;
        let cut = Cut { tile: tile.size, ..Cut::default() };
        let page = Page::new(0, &offered.texture, [Wrap::Clamp; 2], cut, 0);
        if tile.number >= page.tiles() {
            return Err((404, format!("texture {} has {} tiles", tile.texture, page.tiles())));
        }
        let texels = offered.pyramid.lock().unwrap_or_else(PoisonError::into_inner).tile(&page, tile.number);
        let (first, end) = page.texels_of(tile.number);
        let encoded = tile.encoding.encode(&texels, [end[0] - first[0], end[1] - first[1]], tile.quality);
        encoded.map_err(|e| (500, e))
    }

    fn respond(&self, request: &mut Request<Body>) -> Response<Body> {
        if request.body().len() != Some(0) {
            // It is not waited for; what comes of it all the same must not be taken for a request.
            *request.body_mut() = Body::empty();
            request.headers_mut().insert(CONNECTION, HeaderValue::from_static("close"));
            return self.response(Err((400, "expected a request without a body".into())));
        }
        if request.method() != Method::GET {
            return self.response(Err((405, "expected GET".into())));
        }
        if request.uri().path() == "/polygons" {
            let body = Body::from_read(Cursor::new(Arc::clone(&self.polygons)));
            return self.with_hashes(200, body, &self.hash_of_polygons);
        }
        self.response(self.tile(request.uri().path()))
    }

    fn response(&self, answer: Result<Vec<u8>, (u16, String)>) -> Response<Body> {
        let (status, body) = answer.map_or_else(|(status, why)| (status, why.into_bytes()), |body| (200, body));
        let hash = hash_of(&body);
        self.with_hashes(status, Body::from(body), &hash)
    }

    fn with_hashes(&self, status: u16, body: Body, hash: &str) -> Response<Body> {
        let mut response = Response::new(body);
        *response.status_mut() = StatusCode::from_u16(status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        for (name, hash) in [(HASH, hash), (TEXTURES, &self.hash_of_textures)] {
            if let Ok(value) = HeaderValue::from_str(hash) {
                response.headers_mut().insert(name, value);
            }
        }
        response
    }

    /// Answers at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
    ///
    /// # Errors
    /// A sentence, where the address cannot be listened at.
    pub fn listen(self, address: SocketAddr, limits: Limits) -> Result<(SocketAddr, ListeningServer), String> {
        let served = Arc::new(self);
        let open = || {
            // The library does not tell which port it was given.
            let address = if address.port() == 0 { TcpListener::bind(address)?.local_addr()? } else { address };
            let served = Arc::clone(&served);
            let server = Server::new(move |request| served.respond(request)).bind(address);
            let server = server.with_global_timeout(limits.idle).with_max_concurrent_connections(limits.connections);
            server.spawn().map(|listening| (address, listening))
        };
        // Another program may take a free port in between: then another one is found.
        let tries = if address.port() == 0 { 10 } else { 1 };
        let opened = (1..tries).map(|_| open()).find(Result::is_ok).unwrap_or_else(open);
        opened.map_err(|e| format!("{address}: cannot be listened at: {e}"))
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
