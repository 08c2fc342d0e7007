//! The machine: its stages, and the one function that wires them.

use super::ShadeConfig;
use super::check::check;
use super::fifos::Fifos;
use super::memories::{ClientNumbers, build};
use crate::front::FrontEnd;
use crate::problem::ConfigProblem;
use crate::{Counts, Draws};
use basrelief_figure_shading::{
    Adder, BrightnessInterpolation, Gate, HostInterface, Microcomputer, NormalInterpolation, Selector28, Selector53,
};
use basrelief_frame_buffer::{FinishedFrame, FrameBuffer, VideoOut};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::{Clients, Machine, MemorySystem, Stage, Visitor};
use basrelief_signals::{Pixel, Stamp};

/// Figure shading device (200) between host computer (100) and frame memory (300).
#[derive(Clone, Debug)]
pub struct FigureShadingDevice<F> {
    pub(super) front: F,
    fifos: Fifos,
    pub(super) host: Stage<HostInterface>,
    pub(super) microcomputer: Stage<Microcomputer>,
    pub(super) interpolation: Stage<BrightnessInterpolation>,
    pub(super) normal_interpolation: Stage<NormalInterpolation>,
    pub(super) gate: Stage<Gate>,
    pub(super) adder: Stage<Adder>,
    selector_53: Stage<Selector53>,
    pub(super) selector_28: Stage<Selector28>,
    pub(super) depth: Stage<DepthTest<Stamp<Pixel>>>,
    pub(super) frame_memory: Stage<FrameBuffer>,
    pub(super) video_out: Stage<VideoOut>,
    memories: MemorySystem,
    clients: ClientNumbers,
    depth_test: bool,
}

impl<F: FrontEnd> FigureShadingDevice<F> {
    /// The machine at power-on.
    ///
    /// # Errors
    /// Where parameters, each in its range, do not fit together.
    pub fn new(front: F, config: &ShadeConfig) -> Result<Self, ConfigProblem> {
        check(config)?;
        let c = config.clone();
        let (memories, clients) = build(config);
        let normal_interpolation = NormalInterpolation::new(c.normal_interpolation.clone(), c.shade.renormalise);
        let microcomputer = Microcomputer::new(c.microcomputer, c.shade, c.shortcut, c.scan.clone(), &c.normal_interpolation);
        Ok(Self {
            front,
            fifos: Fifos::new(&c.fifo),
            host: Stage::new("host-interface", HostInterface::new(c.host)),
            microcomputer: Stage::new("microcomputer", microcomputer),
            interpolation: Stage::new("interpolation", BrightnessInterpolation::new(c.interpolation)),
            normal_interpolation: Stage::new("normal-interpolation", normal_interpolation),
            gate: Stage::new("gate", Gate::new(c.gate)),
            adder: Stage::new("adder", Adder::new(c.adder)),
            selector_53: Stage::new("selector-53", Selector53::new(c.selector_53)),
            selector_28: Stage::new("selector-28", Selector28::new(c.selector_28)),
            depth: Stage::new("depth-test", DepthTest::new(c.depth, c.scan.z_bits)),
            frame_memory: Stage::new("frame-memory", FrameBuffer::new(c.frame_buffer)),
            video_out: Stage::new("video-out", VideoOut::new(c.video_out)),
            memories,
            clients,
            depth_test: c.frame_memory.depth_test,
        })
    }
}

impl<F: FrontEnd> Draws for FigureShadingDevice<F> {
    fn counts(&self) -> Counts {
        self.count()
    }

    fn drain_finished(&mut self) -> Vec<FinishedFrame> {
        self.frame_memory.unit.drain_finished()
    }

    fn has_finished(&self) -> bool {
        !self.frame_memory.unit.state.finished.is_empty()
    }
}

impl<F: FrontEnd> Machine for FigureShadingDevice<F> {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (f, m, c) = (&mut self.fifos, &mut self.memories, &self.clients);
        self.front.wire(v, &mut f.draws, &mut f.polygons);
        v.stage(&mut self.host, (&mut f.polygons, &mut f.finished), &mut f.transfers, Clients::none());
        let decided = (&mut f.figures, &mut f.normals, &mut f.flat_dots, &mut f.constant_dots);
        v.stage(&mut self.microcomputer, &mut f.transfers, decided, Clients::none());
        let linear = (&mut f.interpolated, &mut f.brightness_dots);
        v.stage(&mut self.interpolation, &mut f.figures, linear, Clients::none());
        v.stage(&mut self.normal_interpolation, &mut f.normals, &mut f.highlights, Clients::none());
        v.stage(&mut self.gate, &mut f.highlights, &mut f.gated, Clients::none());
        v.stage(&mut self.adder, (&mut f.interpolated, &mut f.gated), &mut f.sums, Clients::none());
        v.stage(&mut self.selector_53, (&mut f.sums, &mut f.flat_dots), &mut f.selected, Clients::none());
        let ways = (&mut f.selected, &mut f.brightness_dots, &mut f.constant_dots);
        v.stage(&mut self.selector_28, ways, (&mut f.pixels, &mut f.finished), Clients::none());
        let to_write = if self.depth_test {
            v.stage(&mut self.depth, &mut f.pixels, &mut f.tested_pixels, Clients::of(m, &c.depth));
            &mut f.tested_pixels
        } else {
            &mut f.pixels
        };
        v.stage(&mut self.frame_memory, to_write, &mut f.finished_frames, Clients::of(m, &c.frame_memory));
        v.stage(&mut self.video_out, &mut f.finished_frames, (), Clients::of(m, &c.video_out));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
