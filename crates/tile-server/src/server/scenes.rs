//! `basrelief serve`: the server (110) as a program.

use super::StaticFiles;
use super::http::{CachePolicy, Response};
use super::listen::{Limits, ListeningServer, RequestHandler, listen};
use super::semaphore::Semaphore;
use crate::protocol::{MAX_TILES_PER_REQUEST, etag_of, hash_of_picture, hex, join, parse_encoding};
use basrelief_deferred_renderer::{PyramidCut, ServedTexture, TexturePage, TileEncoding};
use basrelief_signals::Texture;
use basrelief_threads as threads;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};

/// Most texels that the tiles of one request have together: those of the largest tile. So an answer takes 0.8 MB at most, however slowly
/// it is taken.
const MOST_TEXELS: u64 = 1 << 18;
/// Most sums that are kept of a picture.
const MOST_SUMS: usize = 1 << 10;
/// What any page may read, with which header.
const HEADERS: &str = "access-control-allow-origin: *\r\naccess-control-expose-headers: etag\r\n";
const BYTES: &str = "application/octet-stream";

/// A layer of a picture that is cut and encoded so.
type LayerKey = ([u32; 2], (TileEncoding, u8), usize);

/// A picture that is offered.
#[derive(Debug)]
pub(crate) struct ServedPicture {
    texture: Arc<Texture>,
    /// Its layers, kept once they are asked for. Tiles are not: there are as many as ways to cut and to encode them.
    pub(crate) pyramid: Mutex<ServedTexture>,
    /// Bytes of layers: all clients ask for the same, and each takes the encoding of a whole layer.
    sums: Mutex<BTreeMap<LayerKey, u64>>,
}

/// What is offered.
#[derive(Debug)]
pub struct SceneService {
    scene: Fixed,
    index: Fixed,
    /// The viewer; nothing, where there is none.
    viewer: StaticFiles,
    /// By the hash of their texels, in hexadecimal.
    pub(crate) pictures: BTreeMap<String, ServedPicture>,
    /// Where tiles are made: what that takes does not grow with the clients.
    encoders: Semaphore,
}

/// What does not change as long as the server runs, with its tag.
type Fixed = (Arc<[u8]>, String);

fn fixed(body: Vec<u8>) -> Fixed {
    let tag = etag_of(&body);
    (body.into(), tag)
}

/// What there is at an address, or why there is nothing, with its status.
type Found = Result<(Vec<u8>, &'static str), (u16, String)>;

impl SceneService {
    /// Offers this scene, as it travels, this page for people, and the pictures of these textures.
    pub fn new(scene: Vec<u8>, index: String, textures: impl IntoIterator<Item = Arc<Texture>>) -> Self {
        let offered = |texture: Arc<Texture>| {
            let pyramid = Mutex::new(ServedTexture::new(Arc::clone(&texture)));
            (hex(&hash_of_picture(&texture)), ServedPicture { texture, pyramid, sums: Mutex::default() })
        };
        let pictures = textures.into_iter().map(offered).collect();
        let encoders = Semaphore::new(threads::workers());
        Self { scene: fixed(scene), index: fixed(index.into_bytes()), viewer: StaticFiles::default(), pictures, encoders }
    }

    /// With these files beside it; what lies at `/` among them is what browsers are shown.
    pub fn with_viewer(self, viewer: StaticFiles) -> Self {
        Self { viewer, ..self }
    }

    /// The tile at an address, or several.
    pub fn tiles(&self, asked: &str) -> Found {
        let what = "PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER, or several numbers with commas between";
        let wrong = || (400, format!("expected /tile/{what}\n"));
        let (cut, numbers) = asked.rsplit_once('/').ok_or_else(wrong)?;
        let cut = self.cut(cut)?.ok_or_else(wrong)?;
        let numbers: Vec<u32> = numbers.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
        if let [number] = numbers[..] {
            return cut.tile(number).map(|tile| (tile, cut.kind()));
        }
        let [width, height] = cut.page.cut.tile;
        let most = MAX_TILES_PER_REQUEST.min((MOST_TEXELS / u64::from(width * height)) as usize);
        if numbers.len() > most {
            return Err((400, format!("expected at most {most} tiles of {width} x {height} texels\n")));
        }
        let mut body = Vec::new();
        for number in numbers {
            join(&cut.tile(number)?, &mut body);
        }
        Ok((body, BYTES))
    }

    /// Bytes of all tiles of a layer.
    pub(crate) fn bytes(&self, asked: &str) -> Found {
        let wrong = || (400, "expected /bytes/PICTURE/WIDTHxHEIGHT/ENCODING/LAYER\n".to_owned());
        let (cut, layer) = asked.rsplit_once('/').ok_or_else(wrong)?;
        let cut = self.cut(cut)?.ok_or_else(wrong)?;
        let layer = layer.parse::<usize>().map_err(|_| wrong())?;
        let bytes = self.sum(&cut, layer)?;
        Ok((bytes.to_string().into_bytes(), "text/plain; charset=utf-8"))
    }

    /// The same as a number. Who asks while it is summed waits for the same sum.
    fn sum(&self, cut: &TiledPicture<'_>, layer: usize) -> Result<u64, (u16, String)> {
        let layers = &cut.page.layers;
        let found = layers.get(layer).ok_or_else(|| (404, format!("this picture has {} layers\n", layers.len())))?;
        let mut sums = cut.offered.sums.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (cut.page.cut.tile, cut.encoding, layer);
        if let Some(&bytes) = sums.get(&key) {
            return Ok(bytes);
        }
        let bytes_of = |number| {
            let _permit = self.encoders.acquire();
            cut.tile(number).map(|tile| tile.len() as u64)
        };
        let bytes = (found.base..found.base + found.pitch * found.rows).map(bytes_of).sum::<Result<_, _>>()?;
        if sums.len() < MOST_SUMS {
            sums.insert(key, bytes);
        }
        Ok(bytes)
    }

    /// A picture, how it is cut, and how its tiles are encoded; none where that is not what is asked for.
    fn cut(&self, asked: &str) -> Result<Option<TiledPicture<'_>>, (u16, String)> {
        let parts: Vec<&str> = asked.split('/').collect();
        let [picture, size, encoding] = parts[..] else { return Ok(None) };
        let side = |s: &str| s.parse::<u32>().ok().filter(|n| n.is_power_of_two() && (4..=512).contains(n));
        let size = size.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
        let (Some(tile), Some(encoding)) = (size, parse_encoding(encoding)) else { return Ok(None) };
        let Some(offered) = self.pictures.get(picture) else {
            return Err((404, "there is no such picture: the server may have another scene by now\n".into()));
        };
        let page = TexturePage::new(0, &offered.texture, PyramidCut { tile, ..PyramidCut::default() }, 0);
        Ok(Some(TiledPicture { offered, page, encoding }))
    }

    /// RequestHandler at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
    ///
    /// # Errors
    /// A sentence, where the address cannot be listened at.
    pub fn listen(self, address: SocketAddr, limits: Limits) -> Result<(SocketAddr, ListeningServer), String> {
        listen(self, address, limits).map_err(|e| format!("{address}: cannot be listened at: {e}"))
    }
}

impl RequestHandler for SceneService {
    fn answer(&self, path: &str) -> Response {
        if let Some(file) = self.viewer.file(path) {
            return file;
        }
        // Up to the end: what is made is hashed, too.
        let _permit = path.starts_with("/tile/").then(|| self.encoders.acquire());
        let found = match path {
            "/" | "/served" => return Response::found(self.index.clone(), "text/html; charset=utf-8", CachePolicy::Revalidate),
            "/scene" => return Response::found(self.scene.clone(), BYTES, CachePolicy::Revalidate),
            _ => match (path.strip_prefix("/tile/"), path.strip_prefix("/bytes/")) {
                (Some(asked), _) => self.tiles(asked),
                (_, Some(asked)) => self.bytes(asked),
                _ => Err((404, "expected /, /served, /scene, /tile/... or /bytes/...\n".into())),
            },
        };
        match found {
            Ok((body, kind)) => Response::found(fixed(body), kind, CachePolicy::Immutable),
            Err((status, why)) => Response::refused(status, why),
        }
    }

    fn headers(&self) -> &str {
        HEADERS
    }
}

/// A picture as it is asked for.
struct TiledPicture<'a> {
    offered: &'a ServedPicture,
    page: TexturePage,
    /// With its quality.
    encoding: (TileEncoding, u8),
}

impl TiledPicture<'_> {
    fn tile(&self, number: u32) -> Result<Vec<u8>, (u16, String)> {
        let Self { page, encoding: (encoding, quality), .. } = self;
        if number >= page.tiles() {
            return Err((404, format!("this picture has {} tiles\n", page.tiles())));
        }
        let texels = self.offered.pyramid.lock().unwrap_or_else(PoisonError::into_inner).tile(page, number);
        let (first, end) = page.texels_of(number);
        // Without a lock: several at a time.
        let encoded = encoding.encode(&texels, [end[0] - first[0], end[1] - first[1]], *quality);
        encoded.map_err(|e| (500, e))
    }

    /// As browsers name kinds of files.
    fn kind(&self) -> &'static str {
        match self.encoding.0 {
            TileEncoding::Raw => BYTES,
            TileEncoding::Png => "image/png",
            TileEncoding::Jpeg => "image/jpeg",
        }
    }
}
