//! `basrelief serve`: the server (110) as a program.

use super::http::Answer;
use super::listen::{Answers, Limits, ListeningServer, listen};
use super::{LATER, TEXTURES, hash_of};
use basrelief_deferred_renderer::{Cut, Page, ServedTexture, TileEncoding};
use basrelief_signals::Texture;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A texture that is offered.
#[derive(Debug)]
pub(super) struct OfferedTexture {
    texture: Arc<Texture>,
    /// Its layers, kept once they are asked for. Tiles are not: there are as many as ways to cut and to encode them.
    pub(super) pyramid: Mutex<ServedTexture>,
}

/// The list of polygons, from when it is made on: the server answers before. Clones are the same list.
#[derive(Clone, Debug, Default)]
pub struct PolygonList(Arc<OnceLock<(Arc<[u8]>, String)>>);

impl PolygonList {
    /// From now on this is the list; the first that is offered stays.
    pub fn offer(&self, polygons: Vec<u8>) {
        self.0.get_or_init(|| {
            let hash = hash_of(&polygons);
            (polygons.into(), hash)
        });
    }

    fn answer(&self) -> Answer {
        match self.0.get() {
            Some((polygons, hash)) => Answer::found(Arc::clone(polygons), hash.clone()),
            None => Answer::refused(LATER, "the list of polygons is being made: ask again\n".into()),
        }
    }
}

/// What is offered.
#[derive(Debug)]
pub struct TileService {
    polygons: PolygonList,
    /// With the hash of all textures.
    headers: String,
    pub(super) textures: BTreeMap<u32, OfferedTexture>,
}

impl TileService {
    /// Offers this list of polygons and these textures, which have this hash.
    pub fn new(polygons: PolygonList, textures: impl IntoIterator<Item = Arc<Texture>>, hash_of_textures: &str) -> Self {
        let offered = |texture: Arc<Texture>| {
            let pyramid = Mutex::new(ServedTexture::new(Arc::clone(&texture)));
            (texture.id, OfferedTexture { texture, pyramid })
        };
        let textures = textures.into_iter().map(offered).collect();
        Self { polygons, headers: format!("{TEXTURES}: {hash_of_textures}\r\n"), textures }
    }

    /// The tile at an address, or why there is none, with its status. Encoded without a lock: several at a time.
    pub fn tile(&self, address: &str) -> Result<Vec<u8>, (u16, String)> {
        let asked = address.strip_prefix("/tile/").ok_or((404, "expected /polygons or /tile/...".to_owned()))?;
        let tile =
            AskedTile::parse(asked).ok_or((400, "expected /tile/TEXTURE/WIDTHxHEIGHT/ENCODING/QUALITY/NUMBER".to_owned()))?;
        let offered = self.textures.get(&tile.texture).ok_or((404, format!("there is no texture {}", tile.texture)))?;
        let cut = Cut { tile: tile.size, ..Cut::default() };
        let page = Page::new(0, &offered.texture, cut, 0);
        if tile.number >= page.tiles() {
            return Err((404, format!("texture {} has {} tiles", tile.texture, page.tiles())));
        }
        let texels = offered.pyramid.lock().unwrap_or_else(PoisonError::into_inner).tile(&page, tile.number);
        let (first, end) = page.texels_of(tile.number);
        let encoded = tile.encoding.encode(&texels, [end[0] - first[0], end[1] - first[1]], tile.quality);
        encoded.map_err(|e| (500, e))
    }

    /// Answers at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
    ///
    /// # Errors
    /// A sentence, where the address cannot be listened at.
    pub fn listen(self, address: SocketAddr, limits: Limits) -> Result<(SocketAddr, ListeningServer), String> {
        listen(self, address, limits).map_err(|e| format!("{address}: cannot be listened at: {e}"))
    }
}

impl Answers for TileService {
    fn answer(&self, path: &str) -> Answer {
        if path == "/polygons" {
            return self.polygons.answer();
        }
        match self.tile(path) {
            Ok(tile) => Answer::found(tile.as_slice().into(), hash_of(&tile)),
            Err((status, why)) => Answer::refused(status, why),
        }
    }

    fn headers(&self) -> &str {
        &self.headers
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
