//! The machine: its stages, and the one function that wires them.

use super::ShadeConfig;
use super::check::check;
use crate::front::FrontEnd;
use crate::problem::{ConfigProblem, wired};
use crate::{Counts, Draws, fifo};
use basrelief_figure_shading::{
    Adder, BrightnessInterpolation, Finished, Gate, Highlights, HostInterface, Microcomputer, NormalInterpolation, NormalLoad,
    Selector28, Selector53, Signal,
};
use basrelief_frame_buffer::{FinishedFrame, FrameBuffer, FrameDone, VideoOut};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::{Fifo, Machine, MemorySystem, Stage, Visitor};
use basrelief_signals::{Control, Flow, Pixel, Stamp};
use std::sync::Arc;

/// Figure shading device (200) between host computer (100) and frame memory (300).
#[derive(Clone, Debug)]
pub struct FigureShadingDevice<F> {
    pub(super) front: F,
    polygons: Fifo<Control>,
    pub(super) host: Stage<HostInterface>,
    transfers: Fifo<Control>,
    pub(super) microcomputer: Stage<Microcomputer>,
    figures: Fifo<Signal>,
    normals: Fifo<Arc<NormalLoad>>,
    flat_dots: Fifo<Signal>,
    constant_dots: Fifo<Signal>,
    pub(super) interpolation: Stage<BrightnessInterpolation>,
    interpolated: Fifo<Signal>,
    brightness_dots: Fifo<Signal>,
    pub(super) normal_interpolation: Stage<NormalInterpolation>,
    highlights: Fifo<Highlights>,
    pub(super) gate: Stage<Gate>,
    gated: Fifo<Highlights>,
    pub(super) adder: Stage<Adder>,
    sums: Fifo<Signal>,
    selector_53: Stage<Selector53>,
    selected: Fifo<Signal>,
    pub(super) selector_28: Stage<Selector28>,
    pixels: Fifo<Flow<Stamp<Pixel>>>,
    finished: Fifo<Finished>,
    pub(super) depth: Stage<DepthTest<Stamp<Pixel>>>,
    tested_pixels: Fifo<Flow<Stamp<Pixel>>>,
    pub(super) frame_memory: Stage<FrameBuffer>,
    finished_frames: Fifo<FrameDone>,
    pub(super) video_out: Stage<VideoOut>,
    memories: MemorySystem,
    clients: ClientNumbers,
    depth_test: bool,
}

/// Numbers of the memory clients, by unit. What drains the machine comes first, as in the bump-mapping processor.
#[derive(Clone, Debug)]
struct ClientNumbers {
    frame_memory: [usize; 1],
    depth: [usize; 2],
    video_out: [usize; 1],
}

/// Builds the frame memory (300) with its ports and its cache.
fn build(config: &ShadeConfig) -> (MemorySystem, ClientNumbers) {
    let mut m = MemorySystem::default();
    let frame = m.add_memory("frame", &config.memory.frame);
    let outstanding = config.memory.frame.outstanding;
    let clients = ClientNumbers {
        frame_memory: [m.add_client("pixel_write", frame, outstanding)],
        depth: [
            m.add_cached_client("z_read", frame, outstanding, "depth", &config.cache.depth),
            m.add_client("z_write", frame, outstanding),
        ],
        video_out: [m.add_client("video_out", frame, outstanding)],
    };
    (m, clients)
}

impl<F: FrontEnd> FigureShadingDevice<F> {
    /// The machine at power-on.
    ///
    /// # Errors
    /// Where parameters, each in its range, do not fit together.
    pub fn new(front: F, config: &ShadeConfig) -> Result<Self, ConfigProblem> {
        check(config)?;
        let c = config.clone();
        let f = &config.fifo;
        let (memories, clients) = build(config);
        let normal_interpolation = NormalInterpolation::new(c.normal_interpolation.clone(), c.shade.renormalise);
        let microcomputer = Microcomputer::new(c.microcomputer, c.shade, c.shortcut, c.scan.clone(), &c.normal_interpolation);
        wired(Self {
            front,
            polygons: fifo("polygons", &f.polygons),
            host: Stage::new("host-interface", HostInterface::new(c.host)),
            transfers: fifo("transfers", &f.transfers),
            microcomputer: Stage::new("microcomputer", microcomputer),
            figures: fifo("figures", &f.figures),
            normals: fifo("normals", &f.normals),
            flat_dots: fifo("flat_dots", &f.flat_dots),
            constant_dots: fifo("constant_dots", &f.constant_dots),
            interpolation: Stage::new("interpolation", BrightnessInterpolation::new(c.interpolation)),
            interpolated: fifo("interpolated", &f.interpolated),
            brightness_dots: fifo("brightness_dots", &f.brightness_dots),
            normal_interpolation: Stage::new("normal-interpolation", normal_interpolation),
            highlights: fifo("highlights", &f.highlights),
            gate: Stage::new("gate", Gate::new(c.gate)),
            gated: fifo("gated", &f.gated),
            adder: Stage::new("adder", Adder::new(c.adder)),
            sums: fifo("sums", &f.sums),
            selector_53: Stage::new("selector-53", Selector53::new(c.selector_53)),
            selected: fifo("selected", &f.selected),
            selector_28: Stage::new("selector-28", Selector28::new(c.selector_28)),
            pixels: fifo("pixels", &f.pixels),
            finished: fifo("finished", &f.finished),
            depth: Stage::new("depth-test", DepthTest::new(c.depth, c.scan.z_bits)),
            tested_pixels: fifo("tested_pixels", &f.tested_pixels),
            frame_memory: Stage::new("frame-memory", FrameBuffer::new(c.frame_buffer)),
            finished_frames: fifo("finished_frames", &f.finished_frames),
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
        let (m, c) = (&mut self.memories, &self.clients);
        self.front.wire(v, &mut self.polygons);
        v.stage(self.host.between((&mut self.polygons, &mut self.finished), &mut self.transfers));
        let decided = (&mut self.figures, &mut self.normals, &mut self.flat_dots, &mut self.constant_dots);
        v.stage(self.microcomputer.between(&mut self.transfers, decided));
        let linear = (&mut self.interpolated, &mut self.brightness_dots);
        v.stage(self.interpolation.between(&mut self.figures, linear));
        v.stage(self.normal_interpolation.between(&mut self.normals, &mut self.highlights));
        v.stage(self.gate.between(&mut self.highlights, &mut self.gated));
        v.stage(self.adder.between((&mut self.interpolated, &mut self.gated), &mut self.sums));
        v.stage(self.selector_53.between((&mut self.sums, &mut self.flat_dots), &mut self.selected));
        let ways = (&mut self.selected, &mut self.brightness_dots, &mut self.constant_dots);
        v.stage(self.selector_28.between(ways, (&mut self.pixels, &mut self.finished)));
        let to_write = if self.depth_test {
            v.stage(self.depth.between(&mut self.pixels, &mut self.tested_pixels).using(m, &c.depth));
            &mut self.tested_pixels
        } else {
            &mut self.pixels
        };
        v.stage(self.frame_memory.between(to_write, &mut self.finished_frames).using(m, &c.frame_memory));
        v.stage(self.video_out.between(&mut self.finished_frames, ()).using(m, &c.video_out));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
