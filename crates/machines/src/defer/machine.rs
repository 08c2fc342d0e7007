//! The machine: its stages and their wiring.

use super::DeferConfig;
use super::check::check;
use super::config::Fifos;
use super::memories::{ClientNumbers, build};
use crate::PictureMachine;
use crate::engines::compile_engines;
use crate::fifos::{fifo, slots};
use crate::front::FrontEnd;
use crate::problem::{ConfigProblem, wired};
use crate::spec::MachineSpec;
use basrelief_deferred_renderer::tokens::EncodedTile;
use basrelief_deferred_renderer::{
    CellFormat, Cells, DepthPixel, Expander, FilledBuffer, Identification, Path, PicturePreview, PyramidCut, Rasterization,
    ReferenceBuffer, Server, TableSizes, TextureMemory, TexturePage, TileList, TileLists, TileRecord, TileSource, ViewpointEnds,
    brightness_range,
};
use basrelief_frame_buffer::{FinishedFrame, PixelBuffer};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Fifo, Machine, MemorySystem, Stage, Visitor};
use basrelief_rasterizer::Rasterizer;
use basrelief_signals::{Fragment, SignalWidths, Stamp};
use std::sync::Arc;

/// Rendering device (100) at the end of a path (104, 106, 108) from a server (110).
#[derive(Debug)]
pub struct DeferredRenderer {
    front: FrontEnd,
    config: DeferConfig,
    fifos: Fifos,
    /// Path to expander. Its depth is the number of tiles in flight, so it has no parameter.
    tiles: Fifo<EncodedTile>,
    server: Stage<Server>,
    path: Stage<Path>,
    expander: Stage<Expander>,
    rasterizer: Stage<Rasterizer>,
    depth: Stage<DepthTest<Stamp<Fragment>>>,
    cell_maker: Stage<Cells>,
    reference_buffer: Stage<ReferenceBuffer>,
    identification: Stage<Identification>,
    tile_lists: Stage<TileLists>,
    rasterization: Stage<Rasterization>,
    pixel_buffer: Stage<PixelBuffer>,
    memories: MemorySystem,
    clients: ClientNumbers,
}

impl DeferConfig {
    /// Returns the colouring of partial pictures.
    pub fn preview(&self) -> PicturePreview {
        PicturePreview::new(cell_format(self), self.tile.encoding)
    }
}

impl DeferredRenderer {
    /// Creates the machine at power-on, with a server that has all textures of the polygons.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn new(front: FrontEnd, config: &DeferConfig) -> Result<Self, ConfigProblem> {
        let source = TextureMemory::new(config.tile.encoding, config.tile.jpeg_quality);
        Self::with_source(front, config, Box::new(source))
    }

    /// Creates the machine at power-on, with tiles from another source.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn with_source(front: FrontEnd, config: &DeferConfig, source: Box<dyn TileSource>) -> Result<Self, ConfigProblem> {
        check(config)?;
        let c = config.clone();
        let (memories, clients) = build(config);
        let (mode, engine) = (c.defer.mode, c.engine.clone());
        let cut = cut(config);
        let format = cell_format(config);
        let (leaving, onlooker) = (ViewpointEnds::new(&c.defer, source.user()), source.onlooker());
        let shared = c.defer.depth_pixel == DepthPixel::Shared;
        let sizes = TableSizes::new(&c.cell, cut, &engine);
        let cells = Cells::new(engine.clone(), c.operators.clone(), &c.cell, &c.defer, cut);
        let depth = DepthTest::new(c.depth, &c.operators, c.rasterizer.z_bits, c.cache.depth.line_bytes);
        let tile_bytes = 3 * c.tile.width * c.tile.height;
        let (stamp, polygon) = (c.rasterizer.stamp, config.front().taken.triangle_bits());
        let widths = SignalWidths { depth: c.rasterizer.z_bits, stamp, polygon, ..SignalWidths::default() };
        wired(
            Self {
                front,
                fifos: Fifos::new(&c.fifo, &widths),
                tiles: fifo("tiles", &slots(c.path.requests * c.path.tiles_per_request), &widths),
                server: Stage::new("server", Server::new(c.path.clone(), c.defer.lighting, source)),
                path: Stage::new("path", Path::new(&c.path, c.clock.hz, tile_bytes)),
                expander: Stage::new("expander", Expander::new(c.tile.clone(), engine.latency, c.fifo.expanded.depth)),
                depth: Stage::new("z-test", depth.in_memory_of_display(shared)),
                rasterizer: Stage::new("rasterizer", Rasterizer::new(c.rasterizer, c.operators)),
                cell_maker: Stage::new("cells", cells),
                reference_buffer: Stage::new(
                    "reference-buffer",
                    ReferenceBuffer::new(engine.clone(), mode, format.bytes, sizes).shown_to(onlooker),
                ),
                identification: Stage::new("identification", Identification::new(engine.clone(), mode, sizes)),
                tile_lists: Stage::new("tile-lists", TileLists::new(engine.clone(), mode, c.tile.order, sizes, leaving.clone())),
                rasterization: Stage::new("final-rasterization", Rasterization::new(engine, mode, leaving, format, sizes)),
                pixel_buffer: Stage::new("pixel-buffer", PixelBuffer::new(c.frame_buffer, &c.display, shared)),
                memories,
                clients,
                config: config.clone(),
            },
            &config.ideal.units,
        )
    }

    /// Returns the division of textures into tiles.
    pub fn cut(&self) -> PyramidCut {
        cut(&self.config)
    }

    /// Enables the logs of [`DeferredRenderer::drain_filled`] and [`DeferredRenderer::drain_records`]. Must be called before the run.
    pub fn keep(&mut self) {
        self.reference_buffer.unit.keep = true;
        self.rasterization.unit.keep = true;
    }

    /// Returns the progressive pictures since the last call that a better picture follows, in order.
    pub fn drain_rounds(&mut self) -> Vec<FinishedFrame> {
        std::mem::take(&mut self.pixel_buffer.unit.state.rounds)
    }

    /// Returns the reference buffers (126) filled since the last call, in order. Empty if the log is disabled.
    pub fn drain_filled(&mut self) -> Vec<FilledBuffer> {
        self.reference_buffer.unit.drain_filled()
    }

    /// Returns the tiles of the frames finished since the last call, with the number of the frame, from 0. Empty if the log is disabled.
    pub fn drain_records(&mut self) -> Vec<(u32, Vec<TileRecord>)> {
        self.rasterization.unit.drain_records()
    }

    /// Returns the error of the server (110) if a tile could not be fetched. Such a run ends in a deadlock.
    pub fn lost(&self) -> Option<&str> {
        self.server.unit.state.lost.as_deref()
    }

    /// Returns all pages (132) with their tile load lists (136).
    pub fn lists(&self) -> impl Iterator<Item = (&Arc<TexturePage>, &TileList)> {
        self.tile_lists.unit.lists()
    }
}

fn cell_format(config: &DeferConfig) -> CellFormat {
    CellFormat::new(&config.cell, brightness_range(config.defer.lighting))
}

fn cut(config: &DeferConfig) -> PyramidCut {
    PyramidCut { tile: config.tile.format().size, centre: config.defer.texel_centre, most_depth: config.defer.dmax }
}

impl PictureMachine for DeferredRenderer {
    fn finished(&mut self) -> &mut Vec<FinishedFrame> {
        &mut self.pixel_buffer.unit.state.finished
    }

    /// Adds the size of a cell, and the bytes and time of a renderer that loads whole textures.
    fn derive(&self, facts: &mut UnitStats) {
        // Raw bytes are compared with raw bytes, encoded bytes with encoded bytes.
        let conventional = self.server.unit.conventional(self.cut());
        let (conventional, tile_bytes) = match conventional.encoded_bytes {
            Some(encoded) => (encoded, facts.count("path_tile_bytes")),
            None => (conventional.raw_bytes, facts.count("path_tile_raw_bytes")),
        };
        let share = if conventional == 0 { 0.0 } else { tile_bytes as f64 / conventional as f64 };
        facts.figure("cell_bits", u64::from(self.config.cell.bits()), "bits", "A cell of the reference buffer");
        facts.figure(
            "conventional_tile_bytes",
            conventional,
            "bytes",
            "All tiles of all pictures at full resolution, each once; raw where only the server knows their encoding",
        );
        let share = (share * 1e6).round() / 1e6;
        facts.figure(
            "tile_bytes_of_conventional",
            share,
            "",
            "Loaded tiles, encoded or raw alike, as a share of `conventional_tile_bytes`",
        );
    }
}

compile_engines!(DeferredRenderer);

impl Machine for DeferredRenderer {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (f, m, c) = (&mut self.fifos, &mut self.memories, &self.clients);
        self.front.wire(v, &mut f.draws, &mut f.polygons);
        let asked = (&mut f.polygons, &mut f.requests, &mut f.shown);
        v.stage(self.server.between(asked, &mut f.parcels));
        v.stage(self.path.between(&mut f.parcels, (&mut f.mesh, &mut self.tiles)));
        v.stage(self.expander.between(&mut self.tiles, &mut f.expanded));
        v.stage(self.rasterizer.between(&mut f.mesh, &mut f.fragments));
        v.stage(self.depth.between(&mut f.fragments, &mut f.tested_fragments).using(m, &c.depth));
        v.stage(self.cell_maker.between(&mut f.tested_fragments, &mut f.cells));
        let passes = (&mut f.marking, &mut f.colouring);
        let cells = (&mut f.cells, &mut f.rounds);
        v.stage(self.reference_buffer.between(cells, passes).using(m, &c.reference_buffer));
        v.stage(self.identification.between(&mut f.marking, &mut f.marks));
        let marks = (&mut f.marks, &mut f.improvements);
        let decided = (&mut f.requests, &mut f.orders, &mut f.rounds);
        v.stage(self.tile_lists.between(marks, decided));
        let coloured = (&mut f.colouring, &mut f.orders, &mut f.expanded);
        let pictures = (&mut f.improvements, &mut f.pixels);
        v.stage(self.rasterization.between(coloured, pictures).using(m, &c.rasterization));
        v.stage(self.pixel_buffer.between(&mut f.pixels, &mut f.shown).using(m, &c.pixel_buffer));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }

    /// One picture, because with a real server the machine would wait for it before the next picture.
    fn has_news(&self) -> bool {
        let pictures = &self.pixel_buffer.unit.state;
        !pictures.rounds.is_empty() || !pictures.finished.is_empty()
    }
}
