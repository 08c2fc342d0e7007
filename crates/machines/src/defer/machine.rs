//! The machine: its stages, and the one function that wires them.

use super::DeferConfig;
use super::check::check;
use crate::front::FrontEnd;
use crate::problem::{ConfigProblem, wired};
use crate::{Counts, Draws, fifo};
use basrelief_deferred_renderer::tokens::{
    CellFlow, EncodedTile, ExpandedTile, MarkFlow, Order, Parcel, PassFlow, Request, Round,
};
use basrelief_deferred_renderer::{
    CellFormat, Cells, Cut, DepthPixel, Expander, FilledBuffer, Identification, Page, Path, Rasterization, ReferenceBuffer,
    Server, TextureMemory, TileList, TileLists, TileRecord, TileSource, brightness_range,
};
use basrelief_frame_buffer::{FinishedFrame, FrameDone, PixelBuffer, ShownPicture, VideoOut};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::{Fifo, FifoConfig, Machine, MemorySystem, Stage, Visitor};
use basrelief_rasterizer::Rasterizer;
use basrelief_signals::{Control, Flow, Fragment, PictureFlow, Stamp};
use std::sync::Arc;

/// Rendering device (100) at the end of a path (104, 106, 108) from a server (110).
#[derive(Debug)]
pub struct DeferredRenderer<F> {
    pub(super) front: F,
    pub(super) config: DeferConfig,
    polygons: Fifo<Control>,
    pub(super) server: Stage<Server>,
    parcels: Fifo<Parcel>,
    pub(super) path: Stage<Path>,
    mesh: Fifo<Control>,
    tiles: Fifo<EncodedTile>,
    expander: Stage<Expander>,
    expanded: Fifo<ExpandedTile>,
    pub(super) rasterizer: Stage<Rasterizer>,
    fragments: Fifo<Flow<Stamp<Fragment>>>,
    pub(super) depth: Stage<DepthTest<Stamp<Fragment>>>,
    tested_fragments: Fifo<Flow<Stamp<Fragment>>>,
    pub(super) cell_maker: Stage<Cells>,
    cells: Fifo<CellFlow>,
    pub(super) reference_buffer: Stage<ReferenceBuffer>,
    marking: Fifo<PassFlow>,
    colouring: Fifo<PassFlow>,
    pub(super) identification: Stage<Identification>,
    marks: Fifo<MarkFlow>,
    improvements: Fifo<MarkFlow>,
    pub(super) tile_lists: Stage<TileLists>,
    requests: Fifo<Request>,
    orders: Fifo<Order>,
    rounds: Fifo<Round>,
    pub(super) rasterization: Stage<Rasterization>,
    pixels: Fifo<PictureFlow>,
    pub(super) pixel_buffer: Stage<PixelBuffer>,
    shown: Fifo<()>,
    finished_frames: Fifo<FrameDone>,
    pub(super) video_out: Stage<VideoOut>,
    memories: MemorySystem,
    clients: ClientNumbers,
}

/// Numbers of the memory clients, by unit. What drains the machine comes first, as in the bump-mapping processor.
#[derive(Clone, Debug)]
struct ClientNumbers {
    pixel_buffer: [usize; 1],
    depth: [usize; 2],
    video_out: [usize; 1],
    reference_buffer: [usize; 2],
    rasterization: [usize; 3],
}

/// Builds the memories with their ports and caches.
fn build(config: &DeferConfig) -> (MemorySystem, ClientNumbers) {
    let mut m = MemorySystem::default();
    let memory = &config.memory;
    let pixel_depth = m.add_memory("pixel_depth", &memory.pixel_depth);
    let reference = m.add_memory("reference", &memory.reference);
    let texture = m.add_memory("texture", &memory.texture);
    let of_pixels = memory.pixel_depth.outstanding;
    let of_cells = memory.reference.outstanding;
    let of_texels = memory.texture.outstanding;
    let clients = ClientNumbers {
        pixel_buffer: [m.add_client("pixel_write", pixel_depth, of_pixels)],
        depth: [
            m.add_cached_client("z_read", pixel_depth, of_pixels, "depth", &config.cache.depth),
            m.add_client("z_write", pixel_depth, of_pixels),
        ],
        video_out: [m.add_client("video_out", pixel_depth, of_pixels)],
        reference_buffer: [m.add_client("cell_read", reference, of_cells), m.add_client("cell_write", reference, of_cells)],
        rasterization: [
            m.add_cached_client("texel_read", texture, of_texels, "texel", &config.cache.texel),
            m.add_client("tile_write", texture, of_texels),
            m.add_client("tile_read", texture, of_texels),
        ],
    };
    (m, clients)
}

impl<F: FrontEnd> DeferredRenderer<F> {
    /// The machine at power-on, with a server that has the textures that polygons name.
    ///
    /// # Errors
    /// Where parameters, each in its range, do not fit together.
    pub fn new(front: F, config: &DeferConfig) -> Result<Self, ConfigProblem> {
        let source = TextureMemory::new(config.tile.encoding, config.tile.jpeg_quality);
        Self::with_source(front, config, Box::new(source))
    }

    /// The machine at power-on, with tiles from elsewhere.
    ///
    /// # Errors
    /// Where parameters, each in its range, do not fit together.
    pub fn with_source(front: F, config: &DeferConfig, source: Box<dyn TileSource>) -> Result<Self, ConfigProblem> {
        check(config)?;
        let c = config.clone();
        let f = &config.fifo;
        let (memories, clients) = build(config);
        let (mode, engine) = (c.defer.mode, c.engine.clone());
        let cut = cut(config);
        let format = CellFormat::new(&c.cell, brightness_range(c.defer.lighting));
        let shown = c.defer.pictures_per_view;
        let in_flight = FifoConfig { depth: c.path.requests, ..FifoConfig::default() };
        let shared = c.defer.depth_pixel == DepthPixel::Shared;
        let cells = Cells::new(engine.clone(), &c.cell, (c.defer.lighting, c.defer.wrap), cut);
        wired(Self {
            front,
            polygons: fifo("polygons", &f.polygons),
            server: Stage::new("server", Server::new(c.path.clone(), source)),
            parcels: fifo("parcels", &f.parcels),
            path: Stage::new("path", Path::new(&c.path, c.clock.hz)),
            mesh: fifo("mesh", &f.mesh),
            tiles: fifo("tiles", &in_flight),
            expander: Stage::new("expander", Expander::new(c.tile.clone(), engine.latency)),
            expanded: fifo("expanded", &f.expanded),
            depth: Stage::new("z-test", DepthTest::new(c.depth, c.rasterizer.z_bits)),
            rasterizer: Stage::new("rasterizer", Rasterizer::new(c.rasterizer)),
            fragments: fifo("fragments", &f.fragments),
            tested_fragments: fifo("tested_fragments", &f.tested_fragments),
            cell_maker: Stage::new("cells", cells),
            cells: fifo("cells", &f.cells),
            reference_buffer: Stage::new("reference-buffer", ReferenceBuffer::new(engine.clone(), mode, format.bytes)),
            marking: fifo("marking", &f.marking),
            colouring: fifo("colouring", &f.colouring),
            identification: Stage::new("identification", Identification::new(engine.clone())),
            marks: fifo("marks", &f.marks),
            improvements: fifo("improvements", &f.improvements),
            tile_lists: Stage::new("tile-lists", TileLists::new(engine.clone(), mode, c.tile.order, shown)),
            requests: fifo("requests", &f.requests),
            orders: fifo("orders", &f.orders),
            rounds: fifo("rounds", &f.rounds),
            rasterization: Stage::new("final-rasterization", Rasterization::new(engine, mode, shown, format)),
            pixels: fifo("pixels", &f.pixels),
            pixel_buffer: Stage::new("pixel-buffer", PixelBuffer::new(c.frame_buffer, shared)),
            shown: fifo("shown", &f.shown),
            finished_frames: fifo("finished_frames", &f.finished_frames),
            video_out: Stage::new("video-out", VideoOut::new(c.video_out)),
            memories,
            clients,
            config: config.clone(),
        })
    }

    /// How textures are cut into tiles.
    pub fn cut(&self) -> Cut {
        cut(&self.config)
    }

    /// Keeps filled reference buffers and what becomes of tiles, for [`DeferredRenderer::drain_filled`] and
    /// [`DeferredRenderer::drain_records`]; to be called before the run.
    pub fn keep(&mut self) {
        self.reference_buffer.unit.keep = true;
        self.rasterization.unit.keep = true;
    }

    /// Progressive pictures shown since the last call that a better one follows, in order.
    pub fn drain_rounds(&mut self) -> Vec<ShownPicture> {
        self.pixel_buffer.unit.drain_rounds()
    }

    /// Last pictures of frames shown since the last call, in order.
    pub fn drain_shown(&mut self) -> Vec<ShownPicture> {
        self.pixel_buffer.unit.drain_finished()
    }

    /// Reference buffers (126) filled since the last call, in order, where they are kept.
    pub fn drain_filled(&mut self) -> Vec<FilledBuffer> {
        self.reference_buffer.unit.drain_filled()
    }

    /// What became of tiles in the frames finished since the last call, where that is kept: number of the frame, from 0, and its
    /// tiles.
    pub fn drain_records(&mut self) -> Vec<(u32, Vec<TileRecord>)> {
        self.rasterization.unit.drain_records()
    }

    /// Why the server (110) sends nothing any more, where a tile could not be had. Such a run ends in standstill.
    pub fn lost(&self) -> Option<&str> {
        self.server.unit.lost.as_deref()
    }

    /// Pages (132) and their tile load lists (136).
    pub fn lists(&self) -> impl Iterator<Item = (&Arc<Page>, &TileList)> {
        self.tile_lists.unit.lists()
    }
}

fn cut(config: &DeferConfig) -> Cut {
    Cut { tile: [config.tile.width, config.tile.height], centre: config.defer.texel_centre, most_depth: config.defer.dmax }
}

impl<F: FrontEnd> Draws for DeferredRenderer<F> {
    fn counts(&self) -> Counts {
        self.count()
    }

    fn drain_finished(&mut self) -> Vec<FinishedFrame> {
        self.drain_shown().into_iter().map(|shown| shown.picture).collect()
    }

    fn has_finished(&self) -> bool {
        self.pixel_buffer.unit.has_finished()
    }
}

impl<F: FrontEnd> Machine for DeferredRenderer<F> {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (m, c) = (&mut self.memories, &self.clients);
        self.front.wire(v, &mut self.polygons);
        let asked = (&mut self.polygons, &mut self.requests, &mut self.shown);
        v.stage(self.server.between(asked, &mut self.parcels));
        v.stage(self.path.between(&mut self.parcels, (&mut self.mesh, &mut self.tiles)));
        v.stage(self.expander.between(&mut self.tiles, &mut self.expanded));
        v.stage(self.rasterizer.between(&mut self.mesh, &mut self.fragments));
        v.stage(self.depth.between(&mut self.fragments, &mut self.tested_fragments).using(m, &c.depth));
        v.stage(self.cell_maker.between(&mut self.tested_fragments, &mut self.cells));
        let passes = (&mut self.marking, &mut self.colouring);
        let cells = (&mut self.cells, &mut self.rounds);
        v.stage(self.reference_buffer.between(cells, passes).using(m, &c.reference_buffer));
        v.stage(self.identification.between(&mut self.marking, &mut self.marks));
        let marks = (&mut self.marks, &mut self.improvements);
        let decided = (&mut self.requests, &mut self.orders, &mut self.rounds);
        v.stage(self.tile_lists.between(marks, decided));
        let coloured = (&mut self.colouring, &mut self.orders, &mut self.expanded);
        let pictures = (&mut self.improvements, &mut self.pixels);
        v.stage(self.rasterization.between(coloured, pictures).using(m, &c.rasterization));
        let finished = (&mut self.finished_frames, &mut self.shown);
        v.stage(self.pixel_buffer.between(&mut self.pixels, finished).using(m, &c.pixel_buffer));
        v.stage(self.video_out.between(&mut self.finished_frames, ()).using(m, &c.video_out));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
