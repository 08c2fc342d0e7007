//! The machine: its stages and their wiring.

use super::config::Fifos;
use super::memories::{ClientNumbers, build};
use super::{BumpProcessorConfig, ConfigProblem, check};
use crate::PictureMachine;
use crate::engines::compile_engines;
use crate::front::FrontEnd;
use crate::problem::wired;
use basrelief_brightness::{BrightnessFetch, Components};
use basrelief_frame_buffer::{FinishedFrame, FrameBuffer};
use basrelief_graphics_processor::{DepthTest, GraphicsProcessor};
use basrelief_kernel::{Machine, MemorySystem, Stage, Visitor};
use basrelief_normal_mapping::NormalMapping;
use basrelief_rasterizer::{Distributor, Rasterizer, RasterizerConfig};
use basrelief_replacement::Replacement;
use basrelief_signals::{Fragment, Pixel, Stamp};

/// Bump-mapping processor (106) between geometry processor (102) and graphics processor (104), with its memories.
#[derive(Debug)]
pub struct BumpProcessor {
    front: FrontEnd,
    fifos: Fifos,
    rasterizer: Stage<Rasterizer>,
    early_depth: Stage<DepthTest<Stamp<Fragment>>>,
    distributor: Stage<Distributor>,
    mapping: Stage<NormalMapping>,
    replacement: Stage<Replacement>,
    brightness: Stage<BrightnessFetch>,
    graphics: Stage<GraphicsProcessor>,
    late_depth: Stage<DepthTest<Stamp<Pixel>>>,
    frame_buffer: Stage<FrameBuffer>,
    memories: MemorySystem,
    clients: ClientNumbers,
    early_z: bool,
}

impl BumpProcessor {
    /// Creates the machine at power-on.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn new(front: FrontEnd, config: &BumpProcessorConfig) -> Result<Self, ConfigProblem> {
        check::check(config)?;
        let c = config.clone();
        let samples = c.normal_mapping.samples(c.brightness.levels);
        let replacement =
            Replacement::new(c.replacement.clone(), c.normal_mapping.normal_bits, &c.operators).map_err(check::no_table)?;
        let (memories, clients) = build(config);
        let tables = c.replacement.table_set();
        let separate = c.brightness.components == Components::Separate;
        let (z_bits, stamp) = (c.rasterizer.z_bits, check::stamp(config));
        let (levels, layout) = (c.brightness.levels, c.texture.layout());
        wired(
            Self {
                front,
                fifos: Fifos::new(&c.fifo, &check::widths(config, stamp)),
                early_z: c.rasterizer.early_z,
                rasterizer: Stage::new(
                    "rasterizer",
                    Rasterizer::new(RasterizerConfig { stamp, ..c.rasterizer }, c.operators.clone()),
                ),
                early_depth: Stage::new(
                    "depth-test",
                    DepthTest::new(c.depth.clone(), &c.operators, z_bits, c.cache.depth.line_bytes),
                ),
                distributor: Stage::new("distributor", Distributor::default()),
                mapping: Stage::new(
                    "normal-mapping",
                    NormalMapping::new(c.normal_mapping.clone(), &c.operators, levels, stamp, c.cache.normal_map.line_bytes)
                        .with_layout(layout),
                ),
                replacement: Stage::new("replacement", replacement),
                brightness: Stage::new("brightness", BrightnessFetch::new(c.brightness, tables, stamp * samples, &c.operators)),
                graphics: Stage::new(
                    "graphics",
                    GraphicsProcessor::new(
                        c.graphics,
                        c.operators.clone(),
                        separate,
                        [stamp, c.cache.color_texture.line_bytes, check::entry_bits(config)],
                    )
                    .with_layout(layout),
                ),
                late_depth: Stage::new("depth-test", DepthTest::new(c.depth, &c.operators, z_bits, c.cache.depth.line_bytes)),
                frame_buffer: Stage::new("frame-buffer", FrameBuffer::new(c.frame_buffer, &c.display)),
                memories,
                clients,
            },
            &config.ideal.units,
        )
    }
}

impl PictureMachine for BumpProcessor {
    fn finished(&mut self) -> &mut Vec<FinishedFrame> {
        &mut self.frame_buffer.unit.state.finished
    }
}

compile_engines!(BumpProcessor);

impl Machine for BumpProcessor {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (f, m, c) = (&mut self.fifos, &mut self.memories, &self.clients);
        self.front.wire(v, &mut f.draws, &mut f.polygons);
        v.stage(self.rasterizer.between(&mut f.polygons, &mut f.fragments));
        let to_distribute = if self.early_z {
            v.stage(self.early_depth.between(&mut f.fragments, &mut f.tested_fragments).using(m, &c.depth));
            &mut f.tested_fragments
        } else {
            &mut f.fragments
        };
        v.stage(self.distributor.between(to_distribute, (&mut f.bump_fragments, &mut f.plain_fragments)));
        v.stage(self.mapping.between(&mut f.bump_fragments, &mut f.pseudo_normals).using(m, &c.mapping));
        v.stage(self.replacement.between(&mut f.pseudo_normals, &mut f.indexes).using(m, &c.replacement));
        v.stage(self.brightness.between(&mut f.indexes, &mut f.shaded).using(m, &c.brightness));
        let shaded_and_plain = (&mut f.shaded, &mut f.plain_fragments);
        v.stage(self.graphics.between(shaded_and_plain, &mut f.pixels).using(m, &c.graphics));
        let to_write = if self.early_z {
            &mut f.pixels
        } else {
            v.stage(self.late_depth.between(&mut f.pixels, &mut f.tested_pixels).using(m, &c.depth));
            &mut f.tested_pixels
        };
        v.stage(self.frame_buffer.between(to_write, ()).using(m, &c.frame_buffer));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
