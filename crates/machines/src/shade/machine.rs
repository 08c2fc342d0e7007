//! The machine: its stages and their wiring.

use super::ShadeConfig;
use super::check::check;
use super::config::Fifos;
use super::memories::{ClientNumbers, build};
use crate::PictureMachine;
use crate::engines::compile_engines;
use crate::front::FrontEnd;
use crate::problem::{ConfigProblem, wired};
use crate::spec::MachineSpec;
use basrelief_figure_shading::{
    Adder, BrightnessInterpolation, Gate, HostInterface, Microcomputer, NormalInterpolation, RegisterBank, Selector28, Selector53,
};
use basrelief_frame_buffer::{FinishedFrame, FrameBuffer};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::{Machine, MemorySystem, Stage, Visitor};
use basrelief_signals::{Pixel, SignalWidths, Stamp};

/// Figure shading device (200) between host computer (100) and frame memory (300).
#[derive(Debug)]
pub struct FigureShadingDevice {
    front: FrontEnd,
    fifos: Fifos,
    host: Stage<HostInterface>,
    microcomputer: Stage<Microcomputer>,
    registers: Stage<RegisterBank>,
    interpolation: Stage<BrightnessInterpolation>,
    normal_interpolation: Stage<NormalInterpolation>,
    gate: Stage<Gate>,
    adder: Stage<Adder>,
    selector_53: Stage<Selector53>,
    selector_28: Stage<Selector28>,
    depth: Stage<DepthTest<Stamp<Pixel>>>,
    frame_memory: Stage<FrameBuffer>,
    memories: MemorySystem,
    clients: ClientNumbers,
    depth_test: bool,
}

impl FigureShadingDevice {
    /// Creates the machine at power-on.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn new(front: FrontEnd, config: &ShadeConfig) -> Result<Self, ConfigProblem> {
        check(config)?;
        let c = config.clone();
        let (memories, clients) = build(config);
        let o = &c.operators;
        let normal_interpolation = NormalInterpolation::new(c.normal_interpolation.clone(), c.shade.renormalise, o.clone());
        let scan = c.scan.clone();
        let microcomputer = Microcomputer::new(c.cpu, &c.host, c.shade, c.shortcut, scan, &c.normal_interpolation, o);
        let polygon = config.front().taken.triangle_bits();
        let widths = SignalWidths { depth: c.scan.z_bits, stamp: 1, polygon, ..SignalWidths::default() };
        wired(
            Self {
                front,
                fifos: Fifos::new(&c.fifo, &widths),
                host: Stage::new("host-interface", HostInterface::new(c.host)),
                microcomputer: Stage::new("microcomputer", microcomputer),
                registers: Stage::new("registers", RegisterBank::default()),
                interpolation: Stage::new("interpolation", BrightnessInterpolation::new(c.interpolation, o.clone())),
                normal_interpolation: Stage::new("normal-interpolation", normal_interpolation),
                gate: Stage::new("gate", Gate::new(c.gate)),
                adder: Stage::new("adder", Adder::new(c.adder, o.clone())),
                selector_53: Stage::new("selector-53", Selector53::new(c.selector_53)),
                selector_28: Stage::new("selector-28", Selector28::new(c.selector_28)),
                depth: Stage::new("depth-test", DepthTest::new(c.depth, &c.operators, c.scan.z_bits, c.cache.depth.line_bytes)),
                frame_memory: Stage::new("frame-memory", FrameBuffer::new(c.frame_buffer, &c.display)),
                memories,
                clients,
                depth_test: c.frame_memory.depth_test,
            },
            &config.ideal.units,
        )
    }
}

impl PictureMachine for FigureShadingDevice {
    fn finished(&mut self) -> &mut Vec<FinishedFrame> {
        &mut self.frame_memory.unit.state.finished
    }
}

compile_engines!(FigureShadingDevice);

impl Machine for FigureShadingDevice {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (f, m, c) = (&mut self.fifos, &mut self.memories, &self.clients);
        self.front.wire(v, &mut f.draws, &mut f.polygons);
        v.stage(self.host.between((&mut f.polygons, &mut f.finished), &mut f.transfers).using(m, &c.host));
        let decided = (&mut f.figures, &mut f.normals, &mut f.flat_dots, &mut f.constant_dots);
        v.stage(self.microcomputer.between(&mut f.transfers, decided).using(m, &c.microcomputer));
        v.stage(self.registers.between(&mut f.figures, &mut f.selections));
        let linear = (&mut f.interpolated, &mut f.brightness_dots);
        v.stage(self.interpolation.between(&mut f.selections, linear));
        v.stage(self.normal_interpolation.between(&mut f.normals, &mut f.highlights));
        v.stage(self.gate.between(&mut f.highlights, &mut f.gated));
        v.stage(self.adder.between((&mut f.interpolated, &mut f.gated), &mut f.sums));
        v.stage(self.selector_53.between((&mut f.sums, &mut f.flat_dots), &mut f.selected));
        let ways = (&mut f.selected, &mut f.brightness_dots, &mut f.constant_dots);
        v.stage(self.selector_28.between(ways, (&mut f.pixels, &mut f.finished)));
        let to_write = if self.depth_test {
            v.stage(self.depth.between(&mut f.pixels, &mut f.tested_pixels).using(m, &c.depth));
            &mut f.tested_pixels
        } else {
            &mut f.pixels
        };
        v.stage(self.frame_memory.between(to_write, ()).using(m, &c.frame_memory));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
