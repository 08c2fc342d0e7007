//! All parameters of the figure shading device, in the order of its block diagram, and its FIFOs.

use crate::config::{ClockConfig, IdealConfig};
use crate::display::SwapChain;
use crate::fifos::fifos;
use crate::front::front_of;
use crate::memories::{complete, explain, memories, memories_of};
use basrelief_figure_shading::{
    CircuitConfig, CpuConfig, FigureFlow, FinishedPolygon, HostConfig, InterpolationConfig, NormalInterpolationConfig,
    NormalLoad, RegisterOrder, ScanConfig, ShadingConfig, ShortCutConfigs, SpecularFlow,
};
use basrelief_frame_buffer::{DisplayConfig, FrameBufferConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::DepthConfig;
use basrelief_kernel::{AreaConfig, CacheConfig, MemoryConfig, MemoryPart, OperatorConfig, Operators};
use basrelief_parameters::{parameter_groups, parameters};
use basrelief_signals::{Control, Draw, Flow, LightingStage, Pixel, Stamp, VertexAttributes};
use std::sync::Arc;

parameters! {
    /// Frame memory (300).
    pub struct FrameMemoryConfig {
        /// True if dots are tested for depth. Otherwise, later dots replace earlier ones.
        depth_test: bool = true, unit: "", Assumed("the patent has none; polygons would have to come sorted");
    }
}

/// Default clock \[Hz\].
const HZ: u64 = 25_000_000;

memories! {
    /// Memories.
    pub struct MemoryConfigs at HZ {
        /// Frame memory (300), with the depth values.
        frame = MemoryConfig {
            part: MemoryPart::Fpm80,
            cap: 4,
            outstanding: 16,
            ..MemoryConfig::default()
        } => [
            part: Assumed("1989: 1-Mbit page mode DRAM, 80 ns its fastest common grade"),
            channels: Assumed("frame memories were wide (20 banks side by side in the IRIS GTX, Akeley and Jermoluk 1988); 128 bits move 12.8 bytes per cycle, a dot with depth takes 12"),
            cap: Assumed("one turn of the four ports"),
            outstanding: Assumed("more than a page miss of 80 ns DRAM takes at one request per cycle"),
        ],
        /// Memory (12) of the microcomputer (10): data from the host, and the data of Figure 7.
        local = MemoryConfig { cl: 1, cwl: 0, rcd: 0, rp: 0, ras: 0, rtp: 0, wr: 0, wtr: 0, rrd: 0, refi: 0, rfc: 0, burst_bytes: 4, burst_cycles: 1, banks: 1, window: 4, cap: 4, outstanding: 16, ..MemoryConfig::default() } => [
            cl: Assumed("static RAM of 25 to 35 ns, of the class of a 64-Kbit CMOS part of 1989 (Cypress CY7C164): data in the cycle after the address"),
            cwl: Assumed("the same: data come with the address"),
            rcd: Assumed("static RAM has no rows"),
            rp: Assumed("the same"),
            ras: Assumed("the same"),
            rtp: Assumed("the same"),
            wr: Assumed("the same"),
            wtr: Assumed("the same"),
            rrd: Assumed("the same"),
            refi: Assumed("the same: no refresh"),
            rfc: Assumed("the same"),
            burst_bytes: Assumed("a word of 32 bits, as the bus of the host"),
            burst_cycles: Assumed("an access per cycle of 40 ns"),
            banks: Assumed("one"),
            window: Assumed("an arbiter that considers the first request of both ports"),
            cap: Assumed("one turn of the ports"),
            outstanding: Assumed("more than the maximum number of requests of a step, 4"),
        ],
    }
}

parameter_groups! {
    /// Caches.
    pub struct CacheConfigs {
        /// Depth values, for the depth test.
        depth: CacheConfig = CacheConfig { sets: 32, lookups_per_cycle: 1, ..CacheConfig::default() },
    }
}

fifos! {
    /// FIFOs of the figure shading device, by name. Default depths sustain full throughput (law 2): latency of the producer + FIFO
    /// latency + 1, plus the loaded memory latency after a unit that waits for memory.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to host interface: the display list.
        polygons: Control = 32,
        /// Host interface to microcomputer (10): transferred commands.
        transfers: Control = 4,
        /// Microcomputer (10) to registers (14), (16), (18): register values, brightness at the sample points, and all control tokens.
        figures: RegisterOrder = 4,
        /// Registers to circuit (21): brightness at the sample points, register values, and all control tokens.
        selections: FigureFlow = 4,
        /// Microcomputer (10) to circuit (50): normals at the sample points.
        normals: Arc<NormalLoad> = 4,
        /// Process 24 to selector (53): dots of flat polygons.
        flat_dots: FigureFlow = 16,
        /// Process 24 to selector (28): dots in polyhedron mode.
        constant_dots: FigureFlow = 16,
        /// Circuit (21) to adder (52): dots in normal-interpolation mode, and all control tokens.
        interpolated: FigureFlow = 16,
        /// Circuit (21) to selector (28): dots in brightness-interpolation mode.
        brightness_dots: FigureFlow = 16,
        /// Circuit (50) to gate (51): specular brightness of dots.
        highlights: SpecularFlow = 64,
        /// Gate (51) to adder (52): specular brightness.
        gated: SpecularFlow = 16,
        /// Adder (52) to selector (53): dots.
        sums: FigureFlow = 16,
        /// Selector (53) to selector (28): dots.
        selected: FigureFlow = 16,
        /// Selector (28) to the depth test, or to the frame memory (300) without a depth test: pixels.
        pixels: Flow<Stamp<Pixel>> = 64,
        /// Depth test to frame memory (300): pixels.
        tested_pixels: Flow<Stamp<Pixel>> = 64,
        /// Selector (28) to host interface: finished polygons.
        finished: FinishedPolygon = 2,
    }
}

parameter_groups! {
    /// All parameters of the figure shading device.
    pub struct ShadeConfig completed(complete) explained(explain) renamed(crate::config::RENAMED) {
        /// Clock.
        clock: ClockConfig = ClockConfig { hz: HZ } => [
            hz: Assumed("1989: clock of workstations and their gate arrays (MIPS R3000, 68030: 25 MHz)"),
        ],
        /// Latency and initiation interval of arithmetic operators, the same in every unit.
        operators: Operators = Operators {
            multiply: OperatorConfig::new(2, 1),
            add: OperatorConfig::new(2, 1),
            divide: OperatorConfig::new(8, 8),
            square_root: OperatorConfig::new(11, 11),
            power: OperatorConfig::new(1, 1),
            ..Operators::default()
        } => [
            multiply.latency: Assumed("floating-point chips of 1988 (the class of TI SN74ACT8847, AMD Am29C327): two stages of about 40 ns"),
            multiply.interval: Assumed("the same, pipelined"),
            add.latency: Assumed("the same chips"),
            add.interval: Assumed("the same chips"),
            divide.latency: Assumed("the same class: 8 cycles in single precision"),
            divide.interval: Assumed("the same, not pipelined"),
            square_root.latency: Assumed("the same class: 11 cycles in single precision"),
            square_root.interval: Assumed("the same, not pipelined"),
            power.latency: Assumed("a table in ROM of 35 ns: one cycle"),
            power.interval: Assumed("the same"),
            integer_multiply.latency: Assumed("a product of 16 bits takes 69 FO4 delays (synthesized for a generic library); a cycle has about 100"),
            integer_multiply.interval: Assumed("the same"),
            integer_add.latency: Assumed("a comparison of 34 bits takes 23 FO4 delays (synthesized as above); a cycle has about 100"),
            integer_add.interval: Assumed("the same"),
        ],
        /// Arrival of the commands of a trace.
        display_list: DisplayListConfig = DisplayListConfig::default(),
        /// Marking of bump targets in a recorded trace. Only machine `bump` uses the marks.
        bump: BumpConfig = BumpConfig::default(),
        /// Geometry processor, part of the host computer (100).
        geometry: GeometryConfig = GeometryConfig { fetch_bytes_per_cycle: 4, link_bytes: 8, ..GeometryConfig::default() } => [
            fetch_bytes_per_cycle: Assumed("the host's own memory, 32 bits wide, as workstations of 1989 had at this clock"),
            link_bytes: Assumed("within the host, a bus of 64 bits between its boards"),
        ],
        /// Shading.
        shade: ShadingConfig = ShadingConfig::default(),
        /// The three shortcuts.
        shortcut: ShortCutConfigs = ShortCutConfigs::default(),
        /// Transfers from the host computer (100).
        host: HostConfig = HostConfig::default(),
        /// CPU (11) of the microcomputer (10): cycles of the operations of its processes.
        cpu: CpuConfig = CpuConfig::default(),
        /// Scan conversion of polygons.
        scan: ScanConfig = ScanConfig::default(),
        /// Brightness interpolation circuit (21).
        interpolation: InterpolationConfig = InterpolationConfig::default(),
        /// Normal-interpolation brightness circuit (50).
        normal_interpolation: NormalInterpolationConfig = NormalInterpolationConfig::default(),
        /// Gate (51).
        gate: CircuitConfig = CircuitConfig::default(),
        /// Adder (52).
        adder: CircuitConfig = CircuitConfig::default(),
        /// Selector (53).
        selector_53: CircuitConfig = CircuitConfig::default(),
        /// Selector (28).
        selector_28: CircuitConfig = CircuitConfig::default(),
        /// Frame memory (300).
        frame_memory: FrameMemoryConfig = FrameMemoryConfig::default(),
        /// Depth test.
        depth: DepthConfig = DepthConfig::default(),
        /// Write port of the frame memory (300).
        frame_buffer: FrameBufferConfig = FrameBufferConfig::default(),
        /// Video output to the colour CRT (400).
        display: DisplayConfig = DisplayConfig::default(),
        /// FIFOs.
        fifo: FifoConfigs = FifoConfigs::default(),
        /// Memories.
        memory: MemoryConfigs = MemoryConfigs::default(),
        /// Caches.
        cache: CacheConfigs = CacheConfigs::default(),
        /// Idealized units, for bottleneck analysis.
        ideal: IdealConfig = IdealConfig::default(),
        /// Coefficients of the area of the hardware.
        area: AreaConfig = AreaConfig { gate_length: 1.0, ..AreaConfig::default() } => [
            gate_length: Assumed("1989: 1 um CMOS gate arrays"),
        ],
    }
}

front_of!(ShadeConfig, |c| VertexAttributes { lit: LightingStage::InMachine, normal_maps: false, textures: false });
memories_of!(ShadeConfig);

impl ShadeConfig {
    /// Returns the swap chain of the display.
    pub(super) fn swap_chain(&self) -> SwapChain<'_> {
        SwapChain { display: &self.display, pixel_bytes: self.frame_buffer.pixel_bytes, hz: self.clock.hz, shared: false }
    }
}
