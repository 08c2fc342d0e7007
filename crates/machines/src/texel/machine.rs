//! The machine: its stages, and the one function that wires them.

use super::TexelMachineConfig;
use super::check::check;
use crate::front::FrontEnd;
use crate::problem::{ConfigProblem, wired};
use crate::{Counts, Draws, fifo};
use basrelief_frame_buffer::{FinishedFrame, FrameBuffer, FrameDone, VideoOut};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::{Fifo, Machine, MemorySystem, Stage, Visitor};
use basrelief_signals::{Control, Flow, PixelPacket};
use basrelief_texel_value_generator::signals::{
    GradientPacket, IlluminancePacket, LevelPacket, LitSpan, Points, Quotients, Segment, Span, TexelPacket, TexturePacket,
};
use basrelief_texel_value_generator::{
    ApproximateCalculator, Combiner, Divider, FrameLog, IlluminanceValueGenerator, MipMapSelector, MipMode, ScanConverter,
    StepCalculator, TextureLookUpTable,
};

/// Texture mapping system (300) with the texel value generator (310).
#[derive(Clone, Debug)]
pub struct TextureMappingSystem<F> {
    pub(super) front: F,
    polygons: Fifo<Control>,
    pub(super) scan_converter: Stage<ScanConverter>,
    spans: Fifo<Flow<Span>>,
    lit_spans: Fifo<Flow<LitSpan>>,
    pub(super) step_calculator: Stage<StepCalculator>,
    segments: Fifo<Flow<Segment>>,
    points: Fifo<Flow<Points>>,
    pub(super) divider: Stage<Divider>,
    quotients: Fifo<Flow<Quotients>>,
    pub(super) approximate_calculator: Stage<ApproximateCalculator>,
    texels: Fifo<Flow<TexelPacket>>,
    gradients: Fifo<Flow<GradientPacket>>,
    pub(super) mip_map_selector: Stage<MipMapSelector>,
    levels: Fifo<Flow<LevelPacket>>,
    pub(super) depth: Stage<DepthTest<TexelPacket>>,
    tested_texels: Fifo<Flow<TexelPacket>>,
    pub(super) look_up: Stage<TextureLookUpTable>,
    texture_values: Fifo<Flow<TexturePacket>>,
    pub(super) illuminance: Stage<IlluminanceValueGenerator>,
    illuminances: Fifo<Flow<IlluminancePacket>>,
    pub(super) combiner: Stage<Combiner>,
    pixels: Fifo<Flow<PixelPacket>>,
    pub(super) buffer: Stage<FrameBuffer<PixelPacket>>,
    finished_frames: Fifo<FrameDone>,
    pub(super) dacs: Stage<VideoOut>,
    memories: MemorySystem,
    clients: ClientNumbers,
    depth_test: bool,
}

/// Numbers of the memory clients, by unit. What drains the machine comes first, as in the bump-mapping processor.
#[derive(Clone, Debug)]
struct ClientNumbers {
    buffer: [usize; 1],
    combiner: [usize; 1],
    depth: [usize; 2],
    dacs: [usize; 1],
    look_up: [usize; 1],
}

/// Builds the memories of (330), of the depth test and of (360) with their ports and caches.
fn build(config: &TexelMachineConfig) -> (MemorySystem, ClientNumbers) {
    let mut m = MemorySystem::default();
    let texture = m.add_memory("texture", &config.memory.texture);
    let depth = m.add_memory("depth", &config.memory.depth);
    let pixel = m.add_memory("pixel", &config.memory.pixel);
    let (of_texture, of_pixel) = (config.memory.texture.outstanding, config.memory.pixel.outstanding);
    let of_depth = config.memory.depth.outstanding;
    let clients = ClientNumbers {
        buffer: [m.add_client("pixel_write", pixel, of_pixel)],
        combiner: [m.add_client("pixel_read", pixel, of_pixel)],
        depth: [
            m.add_cached_client("z_read", depth, of_depth, "depth", &config.cache.depth),
            m.add_client("z_write", depth, of_depth),
        ],
        dacs: [m.add_client("video_out", pixel, of_pixel)],
        look_up: [m.add_cached_client("texel_read", texture, of_texture, "texture", &config.cache.texture)],
    };
    (m, clients)
}

impl<F: FrontEnd> TextureMappingSystem<F> {
    /// The machine at power-on.
    ///
    /// # Errors
    /// Where parameters, each in its range, do not fit together.
    pub fn new(front: F, config: &TexelMachineConfig) -> Result<Self, ConfigProblem> {
        let c = config.clone();
        let f = &config.fifo;
        let trilinear = c.mip.mode == MipMode::Trilinear;
        let look_up = TextureLookUpTable::new(c.look_up, trilinear, c.cache.texture.line_bytes);
        check(config)?;
        let (memories, clients) = build(config);
        let gradients = (c.mip.mode != MipMode::Off).then_some(c.mip.per);
        let approximate_calculator = ApproximateCalculator::new(c.approximation, c.scan.z_bits, gradients);
        wired(Self {
            front,
            polygons: fifo("polygons", &f.polygons),
            depth: Stage::new("depth-test", DepthTest::new(c.depth, c.scan.z_bits)),
            scan_converter: Stage::new("scan-converter", ScanConverter::new(c.scan, c.texel.snap, c.texel.march)),
            spans: fifo("spans", &f.spans),
            lit_spans: fifo("lit_spans", &f.lit_spans),
            step_calculator: Stage::new("step-calculator", StepCalculator::new(c.texel)),
            segments: fifo("segments", &f.segments),
            points: fifo("points", &f.points),
            divider: Stage::new("divider", Divider::new(c.divider)),
            quotients: fifo("quotients", &f.quotients),
            approximate_calculator: Stage::new("approximate-calculator", approximate_calculator),
            texels: fifo("texels", &f.texels),
            gradients: fifo("gradients", &f.gradients),
            mip_map_selector: Stage::new("mip-map-selector", MipMapSelector::new(c.mip)),
            levels: fifo("levels", &f.levels),
            tested_texels: fifo("tested_texels", &f.tested_texels),
            look_up: Stage::new("texture-look-up", look_up),
            texture_values: fifo("texture_values", &f.texture_values),
            illuminance: Stage::new("illuminance", IlluminanceValueGenerator::new(c.illuminance)),
            illuminances: fifo("illuminances", &f.illuminances),
            combiner: Stage::new("combiner", Combiner::new(c.combiner)),
            pixels: fifo("pixels", &f.pixels),
            buffer: Stage::new("pixel-value-buffer", FrameBuffer::new(c.frame_buffer)),
            finished_frames: fifo("finished_frames", &f.finished_frames),
            dacs: Stage::new("dacs", VideoOut::new(c.video_out)),
            memories,
            clients,
            depth_test: c.pixel_value_buffer.depth_test,
        })
    }

    /// Keeps a log of spans and displacements from now on. To be called before the first step.
    pub fn keep_log(&mut self) {
        self.step_calculator.unit.keep_log();
        self.approximate_calculator.unit.log = true;
        self.combiner.unit.keep_log();
    }

    /// Logs of the pictures finished since the last call, in order; none where none is kept. To be called with
    /// [`TextureMappingSystem::drain_finished`]: what the units have finished of later pictures stays.
    pub fn drain_logs(&mut self, pictures: usize) -> Vec<FrameLog> {
        let spans = &mut self.step_calculator.unit.state.finished;
        let maps = &mut self.combiner.unit.state.finished;
        let ready = pictures.min(spans.len()).min(maps.len());
        spans.drain(..ready).zip(maps.drain(..ready)).map(|(spans, map)| FrameLog { spans, map }).collect()
    }
}

impl<F: FrontEnd> Draws for TextureMappingSystem<F> {
    fn counts(&self) -> Counts {
        self.count()
    }

    fn drain_finished(&mut self) -> Vec<FinishedFrame> {
        self.buffer.unit.drain_finished()
    }

    fn has_finished(&self) -> bool {
        !self.buffer.unit.state.finished.is_empty()
    }
}

impl<F: FrontEnd> Machine for TextureMappingSystem<F> {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (m, c) = (&mut self.memories, &self.clients);
        self.front.wire(v, &mut self.polygons);
        let scanned = (&mut self.spans, &mut self.lit_spans);
        v.stage(self.scan_converter.between(&mut self.polygons, scanned));
        let divided = (&mut self.segments, &mut self.points);
        v.stage(self.step_calculator.between(&mut self.spans, divided));
        v.stage(self.divider.between(&mut self.points, &mut self.quotients));
        let exact = (&mut self.segments, &mut self.quotients);
        v.stage(self.approximate_calculator.between(exact, (&mut self.texels, &mut self.gradients)));
        v.stage(self.mip_map_selector.between(&mut self.gradients, &mut self.levels));
        let to_look_up = if self.depth_test {
            v.stage(self.depth.between(&mut self.texels, &mut self.tested_texels).using(m, &c.depth));
            &mut self.tested_texels
        } else {
            &mut self.texels
        };
        v.stage(self.look_up.between((to_look_up, &mut self.levels), &mut self.texture_values).using(m, &c.look_up));
        v.stage(self.illuminance.between(&mut self.lit_spans, &mut self.illuminances));
        let combined = (&mut self.texture_values, &mut self.illuminances);
        v.stage(self.combiner.between(combined, &mut self.pixels).using(m, &c.combiner));
        v.stage(self.buffer.between(&mut self.pixels, &mut self.finished_frames).using(m, &c.buffer));
        v.stage(self.dacs.between(&mut self.finished_frames, ()).using(m, &c.dacs));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
