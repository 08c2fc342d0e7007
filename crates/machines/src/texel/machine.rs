//! The machine: its stages and their wiring.

use super::TexelMachineConfig;
use super::check::check;
use super::config::Fifos;
use super::memories::{ClientNumbers, build};
use crate::PictureMachine;
use crate::engines::compile_engines;
use crate::front::FrontEnd;
use crate::problem::{ConfigProblem, wired};
use crate::spec::MachineSpec;
use basrelief_frame_buffer::{FinishedFrame, FrameBuffer};
use basrelief_graphics_processor::DepthTest;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Machine, MemorySystem, Stage, Visitor};
use basrelief_signals::{PixelPacket, SignalWidths};
use basrelief_texel_value_generator::signals::TexelPacket;
use basrelief_texel_value_generator::{
    ApproximateCalculator, Combiner, Divider, FrameLog, IlluminanceValueGenerator, Method, MipMapSelector, MipMode,
    PixelValueBuffer, ScanConverter, StepCalculator, TextureLookUpTable,
};

/// Texture mapping system (300) with the texel value generator (310).
#[derive(Debug)]
pub struct TextureMappingSystem {
    front: FrontEnd,
    fifos: Fifos,
    scan_converter: Stage<ScanConverter>,
    step_calculator: Stage<StepCalculator>,
    divider: Stage<Divider>,
    approximate_calculator: Stage<ApproximateCalculator>,
    mip_map_selector: Stage<MipMapSelector>,
    depth: Stage<DepthTest<TexelPacket>>,
    look_up: Stage<TextureLookUpTable>,
    illuminance: Stage<IlluminanceValueGenerator>,
    combiner: Stage<Combiner>,
    buffer: Stage<FrameBuffer<PixelPacket>>,
    memories: MemorySystem,
    clients: ClientNumbers,
    depth_test: bool,
}

impl TextureMappingSystem {
    /// Creates the machine at power-on.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn new(front: FrontEnd, config: &TexelMachineConfig) -> Result<Self, ConfigProblem> {
        let c = config.clone();
        let trilinear = c.mip.mode == MipMode::Trilinear;
        let look_up = TextureLookUpTable::new(c.look_up, trilinear, c.cache.texture.line_bytes).with_layout(c.texture.layout());
        check(config)?;
        let (memories, clients) = build(config);
        let gradients = (c.mip.mode != MipMode::Off).then_some(c.mip.per);
        let (bits, radix, operators) = (c.texel.coordinate_bits, c.divider.bits_per_cycle, c.operators.clone());
        let own = operators.clone();
        let approximate_calculator =
            ApproximateCalculator::new(c.approximation, &c.texel, [radix, c.scan.z_bits], gradients, operators.clone());
        let in_flight = lines_in_flight(config);
        let buffer = PixelValueBuffer {
            buffers: c.display.buffers,
            pixel_bytes: c.frame_buffer.pixel_bytes,
            flags: if c.frame_buffer.clear_flags { c.frame_buffer.flags } else { 0 },
            per_cycle: c.frame_buffer.flags_per_cycle,
        };
        let polygon = config.front().taken.triangle_bits();
        let widths = SignalWidths { depth: c.scan.z_bits, texture: bits, polygon, ..SignalWidths::default() };
        wired(
            Self {
                front,
                fifos: Fifos::new(&c.fifo, &widths),
                depth: Stage::new("depth-test", DepthTest::new(c.depth, &c.operators, c.scan.z_bits, c.cache.depth.line_bytes)),
                scan_converter: Stage::new(
                    "scan-converter",
                    ScanConverter::new(c.scan, c.texel.snap, c.texel.march, operators.clone()),
                ),
                step_calculator: Stage::new("step-calculator", StepCalculator::new(c.texel, radix, operators.clone())),
                divider: Stage::new("divider", Divider::new(c.divider, bits, operators)),
                approximate_calculator: Stage::new("approximate-calculator", approximate_calculator),
                mip_map_selector: Stage::new("mip-map-selector", MipMapSelector::new(c.mip)),
                look_up: Stage::new("texture-look-up", look_up),
                illuminance: Stage::new("illuminance", IlluminanceValueGenerator::new(c.illuminance, own)),
                combiner: Stage::new("combiner", Combiner::new(c.combiner, in_flight, buffer, c.operators)),
                buffer: Stage::new("pixel-value-buffer", FrameBuffer::new(c.frame_buffer, &c.display)),
                memories,
                clients,
                depth_test: c.pixel_value_buffer.depth_test,
            },
            &config.ideal.units,
        )
    }

    /// Enables the log of spans and displacements. Must be called before the first step.
    pub fn keep_log(&mut self) {
        self.step_calculator.unit.keep_log();
        self.approximate_calculator.unit.log = true;
        self.combiner.unit.keep_log();
    }

    /// Removes and returns the logs of `pictures` finished pictures, in order. Must be called together with
    /// [`TextureMappingSystem::drain_finished`]: logs of later pictures stay. Empty if the log is disabled.
    pub fn drain_logs(&mut self, pictures: usize) -> Vec<FrameLog> {
        let spans = &mut self.step_calculator.unit.state.finished;
        let maps = &mut self.combiner.unit.state.finished;
        let ready = pictures.min(spans.len()).min(maps.len());
        spans.drain(..ready).zip(maps.drain(..ready)).map(|(spans, map)| FrameLog { spans, map }).collect()
    }
}

/// Returns the maximum number of pixel lines between the combiner (350) and the memory of (360): packets in the combiner and its output
/// FIFO, lines that are being gathered, and posted writes. A write is posted only with a credit, so the number of posted writes is at most
/// the number of credits.
fn lines_in_flight(config: &TexelMachineConfig) -> u32 {
    1 + config.fifo.pixels.depth + config.frame_buffer.write_lines + config.memory.pixel.outstanding
}

impl PictureMachine for TextureMappingSystem {
    fn finished(&mut self) -> &mut Vec<FinishedFrame> {
        &mut self.buffer.unit.state.finished
    }

    /// Adds the number of divisions per pixel, by unit.
    fn derive(&self, facts: &mut UnitStats) {
        let pixels = facts.count("textured_fragments").max(1) as f64;
        let (points, inner) = (facts.count("points_divided"), facts.count("division_points"));
        let of_points = facts.count("divisions") + facts.count("reciprocals");
        // Every point takes the same number of divisions, one or two.
        let of = |some: u64| some * of_points.checked_div(points).unwrap_or(0);
        let exact = self.step_calculator.unit.config.method == Method::Exact;
        let split = [
            ("divisions_of_span_ends", of(points.saturating_sub(inner)), "Divisions per pixel: u, v at the ends of spans"),
            ("divisions_of_points", if exact { 0 } else { of(inner) }, "The same: u, v at division points between them"),
            ("divisions_of_exact_pixels", if exact { of(inner) } else { 0 }, "The same: u, v at every pixel between them"),
            ("divisions_of_steps", facts.count("step_divisions"), "The same: e / |dw| of steps"),
            ("divisions_of_gradients", facts.count("gradient_reciprocals"), "The same: 1 / W for du, dv of a pixel"),
            ("divisions_of_setup", facts.count("setup_divisions"), "The same: set-up of triangles"),
        ];
        let all: u64 = split.iter().map(|(_, count, _)| count).sum();
        for (name, count, about) in split {
            facts.figure(name, count as f64 / pixels, "", about);
        }
        let about = "Divisions and reciprocals per pixel with a texture, all of those above";
        facts.figure("divisions_per_pixel", all as f64 / pixels, "", about);
        facts.figure("points_per_pixel", points as f64 / pixels, "", "Points divided per pixel with a texture");
    }
}

compile_engines!(TextureMappingSystem);

impl Machine for TextureMappingSystem {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (f, m, c) = (&mut self.fifos, &mut self.memories, &self.clients);
        self.front.wire(v, &mut f.draws, &mut f.polygons);
        let scanned = (&mut f.spans, &mut f.lit_spans);
        v.stage(self.scan_converter.between(&mut f.polygons, scanned));
        let divided = (&mut f.segments, &mut f.points);
        v.stage(self.step_calculator.between(&mut f.spans, divided));
        v.stage(self.divider.between(&mut f.points, &mut f.quotients));
        let exact = (&mut f.segments, &mut f.quotients);
        v.stage(self.approximate_calculator.between(exact, (&mut f.texels, &mut f.gradients)));
        v.stage(self.mip_map_selector.between(&mut f.gradients, &mut f.levels));
        let to_look_up = if self.depth_test {
            v.stage(self.depth.between(&mut f.texels, &mut f.tested_texels).using(m, &c.depth));
            &mut f.tested_texels
        } else {
            &mut f.texels
        };
        v.stage(self.look_up.between((to_look_up, &mut f.levels), &mut f.texture_values).using(m, &c.look_up));
        v.stage(self.illuminance.between(&mut f.lit_spans, &mut f.illuminances));
        let combined = (&mut f.texture_values, &mut f.illuminances);
        v.stage(self.combiner.between(combined, &mut f.pixels).using(m, &c.combiner));
        v.stage(self.buffer.between(&mut f.pixels, ()).using(m, &c.buffer));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
