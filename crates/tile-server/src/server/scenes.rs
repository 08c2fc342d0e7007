//! `basrelief serve`: the server (110) of the patent as a program.

use super::StaticFiles;
use super::http::{CachePolicy, Response};
use super::listen::{ListeningServer, RequestHandler, ServerLimits, listen};
use super::semaphore::Semaphore;
use crate::protocol::{MAX_TILES_PER_REQUEST, etag_of, hash_of_picture, hex, join, parse_format};
use basrelief_deferred_renderer::{PyramidCut, ServedTexture, TexturePage, TileEncoding, TileFormat};
use basrelief_signals::Texture;
use basrelief_threads as threads;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};

/// Maximum number of texels in the tiles of one request, equal to the largest tile. A response takes at most 0.8 MB.
const MOST_TEXELS: u64 = 1 << 18;
/// Maximum number of layer sizes cached per picture.
const MOST_SUMS: usize = 1 << 10;
/// Size of a body from which it counts against the limit for bodies \[bytes\]. The buffer of a connection takes smaller ones at once.
const SMALL_BODY: u64 = 1 << 16;
pub(super) const BYTES: &str = "application/octet-stream";

/// Format of tiles, and layer.
type LayerKey = (TileFormat, usize);

/// A served picture.
#[derive(Debug)]
pub(crate) struct ServedPicture {
    pub(super) texture: Arc<Texture>,
    /// Its layers, computed on first use. Encoded tiles are not cached, because there is one for each size and encoding.
    pub(crate) pyramid: Mutex<ServedTexture>,
    /// Sizes of layers in bytes. All clients request the same ones, and each requires encoding a whole layer.
    sums: Mutex<BTreeMap<LayerKey, u64>>,
}

/// A scene service.
#[derive(Debug)]
pub struct SceneService {
    /// The compressed scene; the hashes of its tiles follow it in a response.
    pub(super) scene: Arc<[u8]>,
    pub(super) hashes: CachedHashes,
    index: FixedBody,
    /// The viewer, empty if it is not built.
    viewer: StaticFiles,
    /// Pictures by the hexadecimal hash of their texels.
    pub(crate) pictures: BTreeMap<String, ServedPicture>,
    /// Limits the encoders, so that their memory does not grow with the number of clients.
    pub(super) encoders: Semaphore,
    /// Headers that let pages of another origin read the responses, or nothing.
    cors: String,
    host_names: Vec<String>,
}

/// Hashes of all pictures with their ETag, by tile size and encoding.
pub(super) type CachedHashes = Mutex<BTreeMap<String, (Arc<[u8]>, String)>>;

/// A body that never changes, with its ETag.
type FixedBody = (Arc<[u8]>, String);

fn fixed(body: Vec<u8>) -> FixedBody {
    let tag = etag_of(&body);
    (body.into(), tag)
}

/// Body and media type, or status and reason of the error.
pub(crate) type BodyResult = Result<(Vec<u8>, &'static str), (u16, String)>;

impl SceneService {
    /// Serves this compressed scene, this page for people, and the pictures of these textures.
    pub fn new(scene: Vec<u8>, index: String, textures: impl IntoIterator<Item = Arc<Texture>>) -> Self {
        let offered = |texture: Arc<Texture>| {
            let pyramid = Mutex::new(ServedTexture::new(Arc::clone(&texture)));
            (hex(&hash_of_picture(&texture)), ServedPicture { texture, pyramid, sums: Mutex::default() })
        };
        let pictures = textures.into_iter().map(offered).collect();
        let encoders = Semaphore::new(threads::workers());
        Self {
            scene: scene.into(),
            hashes: CachedHashes::default(),
            index: fixed(index.into_bytes()),
            viewer: StaticFiles::default(),
            pictures,
            encoders,
            cors: String::new(),
            host_names: vec![],
        }
    }

    /// Also serves the files of the viewer; its first page replaces the page at `/`.
    pub fn with_viewer(self, viewer: StaticFiles) -> Self {
        Self { viewer, ..self }
    }

    /// Lets pages of this origin read the responses; `*` means every page.
    pub fn with_allowed_origin(self, origin: &str) -> Self {
        let cors = format!("access-control-allow-origin: {origin}\r\naccess-control-expose-headers: etag\r\n");
        Self { cors, ..self }
    }

    /// Answers requests whose header Host holds one of these names, besides those to the address of the server.
    pub fn with_host_names(self, host_names: Vec<String>) -> Self {
        Self { host_names, ..self }
    }

    /// Returns the tile or tiles at an address.
    pub fn tiles(&self, asked: &str) -> BodyResult {
        let what = "PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER, or several numbers with commas between";
        let wrong = || (400, format!("expected /tile/{what}\n"));
        let (cut, numbers) = asked.rsplit_once('/').ok_or_else(wrong)?;
        let cut = self.parse_picture(cut)?.ok_or_else(wrong)?;
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

    /// Returns the size of all tiles of a layer.
    pub(crate) fn bytes(&self, asked: &str) -> BodyResult {
        let wrong = || (400, "expected /bytes/PICTURE/WIDTHxHEIGHT/ENCODING/LAYER\n".to_owned());
        let (cut, layer) = asked.rsplit_once('/').ok_or_else(wrong)?;
        let cut = self.parse_picture(cut)?.ok_or_else(wrong)?;
        let layer = layer.parse::<usize>().map_err(|_| wrong())?;
        let bytes = self.total_bytes(&cut, layer)?;
        Ok((bytes.to_string().into_bytes(), "text/plain; charset=utf-8"))
    }

    /// Returns the size as a number. Concurrent requests for the same layer wait for one computation.
    fn total_bytes(&self, cut: &TiledPicture<'_>, layer: usize) -> Result<u64, (u16, String)> {
        let layers = &cut.page.layers;
        let found = layers.get(layer).ok_or_else(|| (404, format!("this picture has {} layers\n", layers.len())))?;
        let mut sums = cut.offered.sums.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (cut.format, layer);
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

    /// Parses picture, tile size and encoding; `None` if the address has another form.
    pub(super) fn parse_picture(&self, asked: &str) -> Result<Option<TiledPicture<'_>>, (u16, String)> {
        let Some((picture, format)) = asked.split_once('/') else { return Ok(None) };
        let Some(format) = parse_format(format) else { return Ok(None) };
        let Some(offered) = self.pictures.get(picture) else {
            return Err((404, "there is no such picture: the server may have another scene by now\n".into()));
        };
        let page = TexturePage::new(0, &offered.texture, PyramidCut { tile: format.size, ..PyramidCut::default() }, 0);
        Ok(Some(TiledPicture { offered, page, format }))
    }

    /// Returns the response to a path that is no file of the viewer.
    pub(crate) fn respond_to(&self, path: &str) -> Result<Response, (u16, String)> {
        let found = |(body, tag): FixedBody, kind, keep| Response::found(body, tag, kind, keep);
        let immutable = |(body, kind)| found(fixed(body), kind, CachePolicy::Immutable);
        match path.split_once('/').and_then(|(_, path)| path.split_once('/')) {
            Some(("tile", asked)) => self.tiles(asked).map(immutable),
            Some(("bytes", asked)) => self.bytes(asked).map(immutable),
            Some(("hashes", asked)) => self.hash_list(asked).map(immutable),
            Some(("scene", format)) => self.scene(Some(format)),
            _ => match path {
                "/" | "/served" => Ok(found(self.index.clone(), "text/html; charset=utf-8", CachePolicy::Revalidate)),
                "/scene" => self.scene(None),
                _ => Err((404, "expected /, /served, /scene/..., /tile/..., /hashes/... or /bytes/...\n".into())),
            },
        }
    }

    /// Starts to listen at an address; port 0 selects a free port. Returns the address and the running server.
    ///
    /// # Errors
    /// The address cannot be used.
    pub fn listen(self, address: SocketAddr, limits: ServerLimits) -> Result<(SocketAddr, ListeningServer), String> {
        listen(self, address, limits)
    }
}

impl RequestHandler for SceneService {
    fn answer(&self, path: &str) -> Response {
        if let Some(file) = self.viewer.file(path) {
            return file;
        }
        // Held until the end, because the body is also hashed.
        let _permit = path.starts_with("/tile/").then(|| self.encoders.acquire());
        self.respond_to(path).unwrap_or_else(|(status, why)| Response::refused(status, why))
    }

    fn body_bytes(&self, path: &str) -> u64 {
        let tiles = path.strip_prefix("/tile/").and_then(|asked| asked.rsplit_once('/'));
        let texels = tiles.and_then(|(cut, numbers)| {
            let [width, height] = parse_format(cut.split_once('/')?.1)?.size;
            Some(u64::from(width * height) * numbers.split(',').count() as u64)
        });
        // An encoded tile is hardly larger than its raw texels, and has a length before it.
        let bytes = 4 * texels.unwrap_or_default().min(MOST_TEXELS);
        if bytes < SMALL_BODY { 0 } else { bytes }
    }

    fn headers(&self) -> &str {
        &self.cors
    }

    fn host_names(&self) -> &[String] {
        &self.host_names
    }
}

/// A picture cut into tiles.
pub(super) struct TiledPicture<'a> {
    offered: &'a ServedPicture,
    pub(super) page: TexturePage,
    pub(super) format: TileFormat,
}

impl TiledPicture<'_> {
    pub(super) fn tile(&self, number: u32) -> Result<Vec<u8>, (u16, String)> {
        let Self { page, format, .. } = self;
        if number >= page.tiles() {
            return Err((404, format!("this picture has {} tiles\n", page.tiles())));
        }
        let (texels, size) = self.texels(number);
        // Encoded without the lock, so that several threads can encode.
        format.encoding.encode(&texels, size, format.quality).map_err(|e| (500, e))
    }

    /// Returns the texels of a tile, and its size.
    pub(super) fn texels(&self, number: u32) -> (Vec<[u8; 4]>, [u32; 2]) {
        let texels = self.offered.pyramid.lock().unwrap_or_else(PoisonError::into_inner).tile(&self.page, number);
        (texels, self.page.texels_of(number).size())
    }

    /// Returns the media type.
    fn kind(&self) -> &'static str {
        match self.format.encoding {
            TileEncoding::Raw => BYTES,
            TileEncoding::Png => "image/png",
            TileEncoding::Jpeg => "image/jpeg",
        }
    }
}
