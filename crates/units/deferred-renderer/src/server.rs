//! Server (110): polygon memory (112) and texture memory (114).

use crate::config::{LightingMode, PathConfig};
use crate::encoding::TileEncoding;
use crate::polygon_memory::PolygonMemory;
use crate::pyramid::{ServedTexture, is_same_picture};
use crate::tokens::{EncodedTile, ResponseContent, TileRequest, TileResponse};
use crate::{PreviewObserver, TexturePage, ViewUser, page::PyramidCut};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Cached, Demand, MemoryPorts, Step, Unit};
use basrelief_signals::{Control, Texture};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::Arc;

/// Source of tiles. The model's server holds the textures itself, and a real server is remote.
pub trait TileSource: Debug {
    /// Announces a texture of the scene: a frame declares it, or a polygon uses it.
    fn offer(&mut self, texture: &Arc<Texture>);
    /// Announces the tiles that will be requested next, in this order.
    fn announce(&mut self, tiles: &[(Arc<TexturePage>, u32)]) {
        let _ = tiles;
    }
    /// Returns an encoded tile.
    ///
    /// # Errors
    /// Returns a sentence that names texture, layer and tile if the tile is not available.
    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String>;
    /// Returns the user who looks at the pictures in real time. The model has none.
    fn user(&self) -> Option<Arc<dyn ViewUser>> {
        None
    }
    /// Returns the observer of filled reference buffers (126), called before the first tile request. The model has none.
    fn onlooker(&self) -> Option<Arc<dyn PreviewObserver>> {
        None
    }
    /// Returns the encoded bytes of all tiles of the finest layer of a texture. Returns `None` if only a remote server knows.
    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64>;
}

/// Texture memory (114): textures by number. Their pyramids are built at first use.
#[derive(Clone, Debug, Default)]
pub struct TextureMemory {
    encoding: TileEncoding,
    quality: u8,
    textures: BTreeMap<u32, ServedTexture>,
}

impl TextureMemory {
    /// Creates an empty memory that encodes tiles in this way.
    pub fn new(encoding: TileEncoding, quality: u8) -> Self {
        Self { encoding, quality, textures: BTreeMap::new() }
    }

    fn encode(&self, texels: &[[u8; 4]], page: &TexturePage, tile: u32) -> Result<Vec<u8>, String> {
        let encoded = self.encoding.encode(texels, page.texels_of(tile).size(), self.quality);
        encoded.map_err(|e| format!("{}: {e}", place_of(page, tile)))
    }
}

/// Returns a position for messages, for example `texture 3 (name), layer 2, tile 17`.
pub fn place_of(page: &TexturePage, tile: u32) -> String {
    format!("texture {} ({}), layer {}, tile {tile}", page.texture, page.name, page.layer_of(tile))
}

impl TileSource for TextureMemory {
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.textures.entry(texture.id).or_insert_with(|| ServedTexture::new(Arc::clone(texture)));
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        let Some(texture) = self.textures.get_mut(&page.texture) else {
            return Err(format!("{}: the server has no such texture", place_of(page, tile)));
        };
        let texels = texture.tile(page, tile);
        self.encode(&texels, page, tile).map(Arc::from)
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        let page = TexturePage::new(0, texture, cut, 0);
        if self.encoding == TileEncoding::Raw {
            return Some(cut.raw_bytes(page.texture_size));
        }
        let finest = page.layers[usize::from(page.dmax())];
        // Not the offered texture: its layers are built at first use. Without a cap, no layer is left out.
        let mut texture = ServedTexture::new(Arc::clone(texture));
        let encoded = |tile| self.encode(&texture.tile(&page, tile), &page, tile).map_or(0, |bytes| bytes.len() as u64);
        Some((finest.base..page.tiles()).map(encoded).sum())
    }
}

/// Load of a conventional renderer, which takes all pictures at their finest layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConventionalLoad {
    /// Size as raw texels \[bytes\].
    pub raw_bytes: u64,
    /// Size as encoded tiles \[bytes\]. `None` if only a remote server knows.
    pub encoded_bytes: Option<u64>,
}

/// Phase of the server within a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum ServerPhase {
    /// Sends polygons and sizes of textures (451, 452), up to the end of the frame.
    #[default]
    Polygons,
    /// Answers requests for tiles.
    Tiles,
    /// Waits until the picture is complete, because depth values of the next frame replace it in a shared memory (124).
    Shown,
}

/// Counters of the server.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ServerCounters {
    /// Bytes of sizes of textures.
    pub size_bytes: u64,
    /// Bytes of tiles.
    pub tile_bytes: u64,
    /// Bytes of the tiles as raw texels.
    pub raw_tile_bytes: u64,
    /// Tiles sent.
    pub tiles: u64,
    /// Answers that carried the tiles.
    pub answers: u64,
}

/// State of the server between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ServerState {
    phase: ServerPhase,
    /// Frames sent.
    pub frames: u64,
    /// Polygon memory (112).
    pub polygons: PolygonMemory,
    /// Textures offered to the source of tiles, by number.
    pub known: BTreeMap<u32, Arc<Texture>>,
    /// Set once the source was offered the known textures. A restored state brings its own textures.
    #[serde(skip)]
    offered: Cached<()>,
    /// Current answer: number of the texture of its tiles, and the number of tiles so far.
    answer: Option<(u32, u32)>,
    /// Reason for a stopped server: the first tile that is not available, in a sentence.
    pub lost: Option<String>,
    /// Counters.
    pub counters: ServerCounters,
}

/// Server (110). Inputs: polygons, requests for tiles, and the news that a picture is shown.
///
/// Meshes cost their bytes on the path once. In later frames the device already has them (482 does not repeat 451), and only the
/// commands of frames and objects travel.
///
/// After an unavailable tile the server sends nothing. The device finishes its received work, and then stops.
#[derive(Debug)]
pub struct Server {
    /// Parameters.
    pub config: PathConfig,
    lighting: LightingMode,
    source: Box<dyn TileSource>,
    /// State between steps.
    pub state: ServerState,
}

impl Server {
    /// Creates a server that takes its tiles from `source`. Normals travel only if the device lights surfaces.
    pub fn new(config: PathConfig, lighting: LightingMode, source: Box<dyn TileSource>) -> Self {
        Self { config, lighting, source, state: ServerState::default() }
    }

    /// Returns the load of all offered pictures, each counted once.
    pub fn conventional(&self, cut: PyramidCut) -> ConventionalLoad {
        let mut sum = ConventionalLoad { raw_bytes: 0, encoded_bytes: Some(0) };
        let known: Vec<&Arc<Texture>> = self.state.known.values().collect();
        let pictures = known.iter().enumerate().filter(|(i, texture)| !known[..*i].iter().any(|t| is_same_picture(t, texture)));
        for (_, texture) in pictures {
            sum.raw_bytes += cut.raw_bytes(texture.levels.first().map_or([1; 2], |image| [image.width, image.height]));
            let bytes = self.source.finest_bytes(texture, cut);
            sum.encoded_bytes = sum.encoded_bytes.zip(bytes).map(|(a, b)| a + b);
        }
        sum
    }

    /// Offers a new texture to the source. Returns the bytes of a new picture's size on the path (452).
    fn size_of(&mut self, texture: &Arc<Texture>) -> u64 {
        if self.state.known.contains_key(&texture.id) {
            return 0;
        }
        let is_new = !self.state.known.values().any(|known| is_same_picture(known, texture));
        self.state.known.insert(texture.id, Arc::clone(texture));
        self.source.offer(texture);
        let bytes = if is_new { u64::from(self.config.texture_size_bytes) } else { 0 };
        self.state.counters.size_bytes += bytes;
        bytes
    }

    fn mesh(&mut self, control: Control) -> TileResponse {
        let mut bytes = 0;
        match &control {
            Control::Polygon(polygon) => {
                bytes = self.state.polygons.polygon(polygon, &self.config, self.lighting);
                bytes += polygon.material.color_texture.as_ref().map_or(0, |texture| self.size_of(texture));
            }
            Control::Frame(frame) => {
                bytes = self.state.polygons.frame(frame, &self.config);
                bytes += frame.textures.iter().map(|texture| self.size_of(texture)).sum::<u64>();
                if self.state.frames == 0 {
                    return TileResponse { bytes, content: ResponseContent::Asked(control) };
                }
            }
            Control::FrameEnd => {
                self.state.frames += 1;
                self.state.phase = ServerPhase::Tiles;
            }
            Control::Object(object) => bytes = self.state.polygons.object(object, &self.config, self.lighting),
            Control::CodeBook(_) | Control::Criterion(_) => {}
        }
        TileResponse { bytes, content: ResponseContent::Mesh(control) }
    }

    /// Returns the bytes of the head of an answer, before the first of its tiles. The tiles of an answer are of one picture, and
    /// from one acquisition.
    fn head(&mut self, page: &TexturePage) -> u64 {
        let most = self.config.tiles_per_request;
        let under_way = self.state.answer.filter(|(texture, tiles)| *texture == page.texture && *tiles < most);
        self.state.answer = Some((page.texture, under_way.map_or(0, |(_, tiles)| tiles) + 1));
        self.state.counters.answers += u64::from(under_way.is_none());
        if under_way.is_some() { 0 } else { self.config.head_bytes.into() }
    }

    fn answer(&mut self, request: &TileRequest) -> Option<TileResponse> {
        match request {
            TileRequest::Announce(tiles) => {
                self.state.answer = None;
                self.source.announce(tiles);
                None
            }
            TileRequest::End => {
                self.state.phase = ServerPhase::Shown;
                None
            }
            TileRequest::Tile(page, tile) => match self.source.tile(page, *tile) {
                Ok(bytes) => {
                    self.state.counters.tile_bytes += bytes.len() as u64;
                    self.state.counters.raw_tile_bytes += 3 * page.texels_in(*tile);
                    self.state.counters.tiles += 1;
                    let encoded = EncodedTile { page: Arc::clone(page), tile: *tile, bytes };
                    Some(TileResponse {
                        bytes: self.head(page) + encoded.bytes.len() as u64,
                        content: ResponseContent::Tile(encoded),
                    })
                }
                Err(error) => {
                    self.state.lost = Some(error);
                    None
                }
            },
        }
    }
}

impl Unit for Server {
    basrelief_kernel::unit_info!("has polygons (112) and textures (114); sends tiles on request");
    type In = (Option<Control>, Option<TileRequest>, Option<()>);
    type Out = Option<TileResponse>;

    fn demand(&self) -> Demand {
        if self.state.lost.is_some() { Demand::Finished } else { Demand::Only(self.state.phase as usize) }
    }

    fn step(&mut self, (control, request, shown): Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        if self.state.offered.is_none() {
            self.state.known.values().for_each(|texture| self.source.offer(texture));
            *self.state.offered = Some(());
        }
        if shown.is_some() {
            self.state.phase = ServerPhase::Polygons;
        }
        let parcel = control.map(|c| self.mesh(c)).or_else(|| self.answer(&request?));
        Step::after(0, parcel)
    }

    fn is_empty(&self) -> bool {
        self.state.phase == ServerPhase::Polygons
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let (c, polygons) = (&self.state.counters, &self.state.polygons.counters);
        stats.figure("path_polygon_bytes", polygons.mesh_bytes, "bytes", "Meshes and surfaces sent over the path");
        stats.figure("path_command_bytes", polygons.command_bytes, "bytes", "Commands of frames and objects sent over the path");
        stats.figure("path_texture_size_bytes", c.size_bytes, "bytes", "Sizes of textures sent over the path");
        stats.figure("path_tile_bytes", c.tile_bytes, "bytes", "Tiles sent over the path");
        stats.figure("path_tile_raw_bytes", c.raw_tile_bytes, "bytes", "The same tiles as raw texels");
        let heads = c.answers * u64::from(self.config.head_bytes);
        stats.figure("path_head_bytes", heads, "bytes", "Heads of the answers with tiles");
        stats.figure("path_tiles", c.tiles, "tiles", "Tiles sent over the path");
    }
}
