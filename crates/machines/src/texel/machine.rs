//! The machine: its stages, and the one function that wires them.

use super::TexelMachineConfig;
use super::check::check;
use super::fifos::Fifos;
use super::memories::{ClientNumbers, build};
use crate::front::FrontEnd;
use crate::problem::ConfigProblem;
use crate::{Counts, Draws};
use basrelief_frame_buffer::{FinishedFrame, FrameBuffer, VideoOut};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::{Clients, Machine, MemorySystem, Stage, Visitor};
use basrelief_signals::PixelPacket;
use basrelief_texel_value_generator::signals::TexelPacket;
use basrelief_texel_value_generator::{
    ApproximateCalculator, Combiner, Divider, FrameLog, IlluminanceValueGenerator, MipMapSelector, MipMode, ScanConverter,
    StepCalculator, TextureLookUpTable,
};

/// Texture mapping system (300) with the texel value generator (310).
#[derive(Clone, Debug)]
pub struct TextureMappingSystem<F> {
    pub(super) front: F,
    fifos: Fifos,
    pub(super) scan_converter: Stage<ScanConverter>,
    pub(super) step_calculator: Stage<StepCalculator>,
    pub(super) divider: Stage<Divider>,
    pub(super) approximate_calculator: Stage<ApproximateCalculator>,
    pub(super) mip_map_selector: Stage<MipMapSelector>,
    pub(super) depth: Stage<DepthTest<TexelPacket>>,
    pub(super) look_up: Stage<TextureLookUpTable>,
    pub(super) illuminance: Stage<IlluminanceValueGenerator>,
    pub(super) combiner: Stage<Combiner>,
    pub(super) buffer: Stage<FrameBuffer<PixelPacket>>,
    pub(super) dacs: Stage<VideoOut>,
    memories: MemorySystem,
    clients: ClientNumbers,
    depth_test: bool,
}

impl<F: FrontEnd> TextureMappingSystem<F> {
    /// The machine at power-on.
    ///
    /// # Errors
    /// Where parameters, each in its range, do not fit together.
    pub fn new(front: F, config: &TexelMachineConfig) -> Result<Self, ConfigProblem> {
        let c = config.clone();
        let trilinear = c.mip.mode == MipMode::Trilinear;
        let look_up = TextureLookUpTable::new(c.look_up, trilinear, c.cache.texture.line_bytes);
        check(config, &look_up)?;
        let (memories, clients) = build(config);
        let gradients = (c.mip.mode != MipMode::Off).then_some(c.mip.per);
        let approximate_calculator = ApproximateCalculator::new(c.approximation, c.scan.z_bits, gradients);
        Ok(Self {
            front,
            fifos: Fifos::new(&c.fifo),
            depth: Stage::new("depth-test", DepthTest::new(c.depth, c.scan.z_bits)),
            scan_converter: Stage::new("scan-converter", ScanConverter::new(c.scan, c.texel.snap, c.texel.march)),
            step_calculator: Stage::new("step-calculator", StepCalculator::new(c.texel)),
            divider: Stage::new("divider", Divider::new(c.divider)),
            approximate_calculator: Stage::new("approximate-calculator", approximate_calculator),
            mip_map_selector: Stage::new("mip-map-selector", MipMapSelector::new(c.mip)),
            look_up: Stage::new("texture-look-up", look_up),
            illuminance: Stage::new("illuminance", IlluminanceValueGenerator::new(c.illuminance)),
            combiner: Stage::new("combiner", Combiner::new(c.combiner)),
            buffer: Stage::new("pixel-value-buffer", FrameBuffer::new(c.frame_buffer)),
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
        let (f, m, c) = (&mut self.fifos, &mut self.memories, &self.clients);
        self.front.wire(v, &mut f.draws, &mut f.polygons);
        let scanned = (&mut f.spans, &mut f.lit_spans);
        v.stage(&mut self.scan_converter, &mut f.polygons, scanned, Clients::none());
        let divided = (&mut f.segments, &mut f.points);
        v.stage(&mut self.step_calculator, &mut f.spans, divided, Clients::none());
        v.stage(&mut self.divider, &mut f.points, &mut f.quotients, Clients::none());
        let exact = (&mut f.segments, &mut f.quotients);
        v.stage(&mut self.approximate_calculator, exact, (&mut f.texels, &mut f.gradients), Clients::none());
        v.stage(&mut self.mip_map_selector, &mut f.gradients, &mut f.levels, Clients::none());
        let to_look_up = if self.depth_test {
            v.stage(&mut self.depth, &mut f.texels, &mut f.tested_texels, Clients::of(m, &c.depth));
            &mut f.tested_texels
        } else {
            &mut f.texels
        };
        v.stage(&mut self.look_up, (to_look_up, &mut f.levels), &mut f.texture_values, Clients::of(m, &c.look_up));
        v.stage(&mut self.illuminance, &mut f.lit_spans, &mut f.illuminances, Clients::none());
        let combined = (&mut f.texture_values, &mut f.illuminances);
        v.stage(&mut self.combiner, combined, &mut f.pixels, Clients::of(m, &c.combiner));
        v.stage(&mut self.buffer, &mut f.pixels, &mut f.finished_frames, Clients::of(m, &c.buffer));
        v.stage(&mut self.dacs, &mut f.finished_frames, (), Clients::of(m, &c.dacs));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
