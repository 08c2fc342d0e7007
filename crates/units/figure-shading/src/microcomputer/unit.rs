//! The unit and its steps: one to decide, one to shade, and one per dot of process 24.

use super::normals::normals_of;
use super::outputs::{CpuOutputs, Out, nothing};
use super::state::{CpuPhase, CpuProcess, DecidedPolygon, MicrocomputerState};
use crate::cpu::CpuOperations;
use crate::dots::DotScan;
use crate::local_memory::{self, LocalPort, PolygonBuffer};
use crate::{
    BrightnessSelection, CpuConfig, FigureFlow, HostConfig, NormalInterpolationConfig, PolygonFigure, PolygonRoute,
    PowerFunction, RegisterOrder, RegisterWrite, ScanConfig, ShadingConfig, ShadingRegisters, ShortCutConfigs,
};
use basrelief_kernel::stats::{FigureGroup, UnitStats};
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Operators, Step, Unit};
use basrelief_signals::{Control, Polygon};
use std::sync::Arc;

/// Microcomputer (10): decides the drawing method of each polygon, shades its sample points, loads circuits (21) and (50), and
/// draws flat polygons itself.
///
/// The CPU (11) works sequentially. For each polygon, process 15 tests flatness. If it is flat, step 92 compares its plane with
/// the previous one. If not, process 17 tests the specular term. Registers (16) and (18) are written. Then process 20 loads and
/// starts circuit (50), which works while 22 shades the sample points. Finally 23 loads circuit (21), or 24 computes the mean and
/// emits it for every dot.
///
/// The processes read the data that the host interface wrote to memory (12). The CPU waits for each read.
///
/// Outputs: 0 to registers and circuit (21), with all control; 1 to circuit (50); 2 to selector (53) and 3 to selector (28), dots
/// of process 24.
#[derive(Clone, Debug)]
pub struct Microcomputer {
    /// Cycles of the CPU's (11) operations.
    pub config: CpuConfig,
    pub(super) shading: ShadingConfig,
    pub(super) short_cuts: ShortCutConfigs,
    pub(super) scan: ScanConfig,
    /// Power as in circuit (50), because process 17 needs its rounding.
    pub(super) power: PowerFunction,
    /// Port of memory (12).
    pub(super) port: LocalPort,
    buffers: u32,
    /// Cycles of a dot of process 24.
    pub(super) dot_cycles: u64,
    /// State between steps.
    pub state: MicrocomputerState,
}

/// Returns a step that sends an order to the registers when the CPU is done.
fn ordered(cycles: u64, order: RegisterOrder) -> Out {
    Step::after(cycles, (Some(order), None, None, None)).busy(cycles.max(1))
}

/// Returns a step that sends a token through the registers to circuit (21) when the CPU is done.
fn passed(cycles: u64, signal: FigureFlow) -> Out {
    ordered(cycles, RegisterOrder::Pass(signal))
}

/// A register write: a store.
const REGISTER: CpuOperations = CpuOperations { store: 1, ..CpuOperations::NONE };
/// A dot: a step of three edges, of the address and of the depth, and a branch. Address and depth are stored.
const DOT: CpuOperations = CpuOperations { integer: 3 + 1 + 1 + 1, store: 2, ..CpuOperations::NONE };
/// Maximum number of requests of a step to memory (12): a read, or the writes of light vectors and limits.
const MOST_REQUESTS: u32 = 2;

impl Microcomputer {
    /// Creates a microcomputer in its power-on state.
    pub fn new(
        config: CpuConfig,
        host: &HostConfig,
        shading: ShadingConfig,
        short_cuts: ShortCutConfigs,
        scan: ScanConfig,
        circuit_50: &NormalInterpolationConfig,
        operators: &Operators,
    ) -> Self {
        let power = PowerFunction::new(circuit_50, operators);
        let (port, buffers) = (LocalPort { number_bytes: host.number_bytes }, host.buffers);
        let dot_cycles = config.cycles(DOT).max(1);
        Self { config, shading, short_cuts, scan, power, port, buffers, dot_cycles, state: MicrocomputerState::default() }
    }

    /// Returns the buffer of the polygon of this number in memory (12).
    pub(super) fn buffer(&self, number: u64) -> PolygonBuffer {
        PolygonBuffer::of(number, self.buffers)
    }

    /// Counts a run of a process. Returns the cycles of its operations.
    pub(super) fn run(&mut self, process: CpuProcess, operations: CpuOperations) -> u64 {
        self.state.counters.processes[process as usize].runs += 1;
        self.spend(process, operations)
    }

    /// Continues a process. Returns the cycles of its operations.
    pub(super) fn spend(&mut self, process: CpuProcess, operations: CpuOperations) -> u64 {
        let cycles = self.config.cycles(operations);
        self.count_loads(operations);
        self.state.counters.processes[process as usize].cycles += cycles;
        cycles
    }

    /// Returns a step in which a process writes a register.
    fn write(&mut self, process: CpuProcess, write: RegisterWrite) -> Out {
        let cycles = self.spend(process, REGISTER).max(1);
        ordered(cycles, RegisterOrder::Write(write))
    }

    fn take(&mut self, control: Control) -> Out {
        match control {
            Control::Frame(frame) => {
                let cycles = self.begin_frame(&frame);
                self.state.phase = CpuPhase::WriteMode;
                passed(cycles, FigureFlow::Frame(frame))
            }
            Control::Object(object) => {
                let (cycles, other_mode) = self.begin_object(object);
                if other_mode {
                    self.state.phase = CpuPhase::WriteMode;
                }
                nothing(cycles)
            }
            Control::Polygon(polygon) => self.decide(polygon),
            Control::FrameEnd => passed(1, FigureFlow::FrameEnd),
            Control::CodeBook(_) | Control::Criterion(_) => nothing(1),
        }
    }

    /// Runs processes 15, 92 and 17.
    fn decide(&mut self, polygon: Arc<Polygon>) -> Out {
        let number = self.state.polygons;
        self.state.polygons += 1;
        let buffer = self.buffer(number);
        let mut cycles = self.set(&polygon);
        let normals = normals_of(&polygon);
        let (flat, flat_cycles) = self.judge_flatness(&polygon, &normals, buffer);
        let (reused, plane_cycles) = if flat { self.judge_plane(&polygon, &normals, buffer) } else { (false, 0) };
        let (specular, specular_cycles) = if reused { (true, 0) } else { self.judge_specular(&normals, buffer) };
        cycles += flat_cycles + plane_cycles + specular_cycles;
        let registers = ShadingRegisters { mode: self.state.settings.mode, flat, specular };
        self.state.phase = CpuPhase::WriteFlat(DecidedPolygon { polygon, number, registers, reused });
        nothing(cycles)
    }

    /// Runs process 20.
    fn start_50(&mut self, decided: DecidedPolygon) -> Out {
        let (load, cycles) = self.start(&decided);
        self.state.phase = CpuPhase::Shade(decided);
        Step::after(cycles, (None, load, None, None)).busy(cycles.max(1))
    }

    /// Continues with the next phase, if no dot is emitted.
    fn go_on(&mut self, phase: CpuPhase) -> Out {
        match phase {
            CpuPhase::WriteMode => self.write(CpuProcess::Mode, RegisterWrite::Mode(self.state.settings.mode)),
            CpuPhase::WriteFlat(decided) => {
                let flat = decided.registers.flat;
                self.state.phase = CpuPhase::WriteSpecular(decided);
                self.write(CpuProcess::Flatness, RegisterWrite::Flat(flat))
            }
            CpuPhase::WriteSpecular(decided) => {
                let specular = decided.registers.specular;
                self.state.phase = CpuPhase::Start(decided);
                self.write(CpuProcess::Specular, RegisterWrite::Specular(specular))
            }
            CpuPhase::Start(decided) => self.start_50(decided),
            CpuPhase::Shade(decided) => self.shade(decided),
            CpuPhase::Idle | CpuPhase::Output { .. } => nothing(1),
        }
    }

    /// Runs processes 22 and 23 or 24, up to the first dot.
    fn shade(&mut self, decided: DecidedPolygon) -> Out {
        let (registers, reused, buffer) = (decided.registers, decided.reused, self.buffer(decided.number));
        let (mut brightness, mut cycles) =
            if reused { (Vec::new(), 0) } else { self.sample_points(&decided.polygon, registers, buffer) };
        let mean = (registers.selection() == BrightnessSelection::Mean).then(|| {
            let (mean, mean_cycles) = self.mean(&decided, &brightness);
            cycles += mean_cycles + self.set_up_output(&decided);
            brightness.clear();
            mean
        });
        if mean.is_none() {
            cycles += self.transfer(&brightness, buffer);
        }
        let polygon = decided.polygon;
        let route = PolygonRoute::of(registers, reused);
        let raster = self.state.raster;
        let figure = Arc::new(PolygonFigure { polygon, raster, registers, route, brightness });
        if let Some(brightness) = mean {
            self.state.dots = DotScan::new(&figure.polygon, raster);
            self.state.phase = CpuPhase::Output { figure: Arc::clone(&figure), brightness };
        }
        passed(cycles, FigureFlow::Figure(figure))
    }
}

impl Microcomputer {
    fn tell_hardware(&self, stats: &mut UnitStats) {
        for (kind, about) in [
            (HardwareKind::Multiplier, "floating-point unit of the CPU (11)"),
            (HardwareKind::Adder, "the same; comparisons"),
            (HardwareKind::Divider, "the same"),
        ] {
            stats.hardware(kind, about, 1_u64, OperandWidth::SINGLE);
        }
        // Each operation selects its operands here.
        stats.ported_table("registers of the floating-point unit", self.config.registers, 32, 3);
        let numbers = local_memory::numbers(self.buffers);
        stats.hardware(
            HardwareKind::Table,
            "memory (12): settings, lights, plane, polygons",
            numbers,
            8 * self.port.number_bytes,
        );
    }
}

impl Unit for Microcomputer {
    basrelief_kernel::unit_info!("decides, shades sample points, draws flat polygons");
    type In = Option<Control>;
    type Out = CpuOutputs;

    #[inline]
    fn demand(&self) -> Demand {
        if self.is_empty() { Demand::All } else { Demand::Nothing }
    }

    #[inline]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Out {
        if let Some(control) = input {
            let step = self.take(control);
            return self.after_operands(step, traffic);
        }
        if !self.state.operands.is_empty() {
            return self.fetch_next(traffic);
        }
        // Tested before the phase is moved out, because process 24 comes here for every dot.
        if matches!(self.state.phase, CpuPhase::Output { .. }) {
            return self.put_out();
        }
        let phase = std::mem::take(&mut self.state.phase);
        let step = self.go_on(phase);
        self.after_operands(step, traffic)
    }

    fn largest_step(&self, client: usize) -> u32 {
        if client == LocalPort::CLIENT as usize { MOST_REQUESTS } else { 0 }
    }

    fn is_empty(&self) -> bool {
        matches!(self.state.phase, CpuPhase::Idle) && self.state.operands.is_empty()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let dot = self.dot_cycles;
        // Process 24 draws dots: flat polygons to selector (53), polygons of polyhedron mode to selector (28).
        stats.rate(2, dot, dot);
        stats.rate(3, dot, dot);
        self.tell_hardware(stats);
        let c = &self.state.counters;
        stats.figure(
            "short_cut_specular_negligible",
            c.specular_negligible,
            "polygons",
            "Polygons whose specular term was negligible",
        );
        stats.figure("short_cut_flat", c.flat, "polygons", "Polygons found flat");
        stats.figure("short_cut_same_plane", c.reused, "points", "Sample points whose brightness was reused");
        for (process, name) in CpuProcess::ALL {
            let process = c.processes[process as usize];
            let mut part = |what: &str, count, unit, about| {
                stats.figure(&format!("{name}_{what}"), count, unit, about).part(FigureGroup::Process(name.into()))
            };
            part("runs", process.runs, "runs", "Runs of the process");
            part("cycles", process.cycles, "cycles", "Cycles that all runs took");
        }
    }
}
