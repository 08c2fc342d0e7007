//! The unit and its steps: one to decide, one to shade, and one per dot of process 24.

use super::flatness::normals_of;
use super::state::{Decided, MicrocomputerState, Phase, Process};
use crate::dots::Dots;
use crate::{
    Figure, MicrocomputerConfig, NormalInterpolationConfig, NormalLoad, Power, Registers, Route, ScanConfig, Selection,
    ShadingConfig, ShortCutConfigs, Signal,
};
use basrelief_kernel::facts::{Facts, Part};
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_signals::{Control, Polygon};
use std::sync::Arc;

/// Microcomputer (10): decides how each polygon is drawn, shades its sample points, loads circuits (21) and (50), and draws
/// flat polygons itself.
///
/// The CPU (11) does one thing after the other. A polygon takes it through: 15 flat? If so, 92 on the plane of the one
/// before? If not, 17 specular negligible? Then 20 loads and starts circuit (50), which works while 22 shades the sample
/// points; then 23 loads circuit (21), or 24 takes the mean and puts it out for every dot.
///
/// Outputs: 0 circuit (21), and with it all control; 1 circuit (50); 2 selector (53), 3 selector (28): dots of process 24.
#[derive(Clone, Debug)]
pub struct Microcomputer {
    /// Parameters.
    pub config: MicrocomputerConfig,
    pub(super) shading: ShadingConfig,
    pub(super) short_cuts: ShortCutConfigs,
    pub(super) scan: ScanConfig,
    /// As circuit (50) has it: process 17 must know its rounding.
    pub(super) power: Power,
    /// Everything it remembers.
    pub state: MicrocomputerState,
}

/// One token per output.
type Outs = (Option<Signal>, Option<Arc<NormalLoad>>, Option<Signal>, Option<Signal>);
pub(super) type Out = Step<Outs>;

pub(super) fn nothing(cycles: u64) -> Out {
    Step::after(cycles, (None, None, None, None)).busy(cycles.max(1))
}

/// When the CPU is done, to circuit (21).
fn passed(cycles: u64, signal: Signal) -> Out {
    Step::after(cycles, (Some(signal), None, None, None)).busy(cycles.max(1))
}

impl Microcomputer {
    /// A microcomputer at power-on.
    pub fn new(
        config: MicrocomputerConfig,
        shading: ShadingConfig,
        short_cuts: ShortCutConfigs,
        scan: ScanConfig,
        circuit_50: &NormalInterpolationConfig,
    ) -> Self {
        let power = Power::new(circuit_50);
        Self { config, shading, short_cuts, scan, power, state: MicrocomputerState::default() }
    }

    /// A process runs; its cycles.
    pub(super) fn run(&mut self, process: Process, cycles: u64) -> u64 {
        let counters = &mut self.state.counters.processes[process as usize];
        counters.runs += 1;
        counters.cycles += cycles;
        cycles
    }

    fn take(&mut self, control: Control) -> Out {
        match control {
            Control::Frame(frame) => {
                let cycles = self.begin_frame(&frame);
                passed(cycles, Signal::Frame(frame))
            }
            Control::Object(object) => {
                self.begin_object(object);
                nothing(1)
            }
            Control::Polygon(polygon) => self.decide(polygon),
            Control::FrameEnd => passed(1, Signal::FrameEnd),
            Control::CodeBook(_) | Control::Criterion(_) => nothing(1),
        }
    }

    /// Processes 15, 92, 17 and 20.
    fn decide(&mut self, polygon: Arc<Polygon>) -> Out {
        let mut cycles = self.set(&polygon);
        let normals = normals_of(&polygon);
        let (flat, flat_cycles) = self.judge_flatness(&polygon, &normals);
        let (reused, plane_cycles) = if flat { self.judge_plane(&polygon, &normals) } else { (false, 0) };
        let (specular, specular_cycles) = if reused { (true, 0) } else { self.judge_specular(&normals) };
        cycles += flat_cycles + plane_cycles + specular_cycles;
        let registers = Registers { mode: self.shading.mode, flat, specular };
        let (load, start_cycles) = self.start(&polygon, normals, registers);
        cycles += start_cycles;
        self.state.phase = Phase::Shade(Decided { polygon, registers, reused });
        Step::after(cycles, (None, load, None, None)).busy(cycles.max(1))
    }

    /// Processes 22 and 23 or 24, up to the first dot.
    fn shade(&mut self, decided: Decided) -> Out {
        let Decided { polygon, registers, reused } = decided;
        let (mut brightness, mut cycles) = if reused { (Vec::new(), 0) } else { self.sample_points(&polygon, registers) };
        let mean = (registers.selection() == Selection::Mean).then(|| {
            let (mean, mean_cycles) = self.mean(&polygon, &brightness, reused);
            cycles += mean_cycles;
            brightness.clear();
            mean
        });
        if mean.is_none() {
            cycles += self.transfer(&brightness);
        }
        let route = Route::of(registers, reused);
        let raster = self.state.raster;
        let figure = Arc::new(Figure { polygon, raster, registers, route, brightness });
        if let Some(brightness) = mean {
            self.state.dots = Dots::new(&figure.polygon, raster);
            self.state.phase = Phase::Output { figure: Arc::clone(&figure), brightness };
        }
        passed(cycles, Signal::Figure(figure))
    }
}

impl Unit for Microcomputer {
    basrelief_kernel::role!("decides, shades sample points, draws flat polygons");
    type In = Option<Control>;
    type Out = Outs;

    #[inline]
    fn demand(&self) -> Demand {
        if self.is_empty() { Demand::All } else { Demand::Nothing }
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut Traffic) -> Out {
        if let Some(control) = input {
            return self.take(control);
        }
        // Looked at before it is taken: process 24 comes this way for every dot.
        if !matches!(self.state.phase, Phase::Shade(_)) {
            return self.put_out();
        }
        match std::mem::take(&mut self.state.phase) {
            Phase::Shade(decided) => self.shade(decided),
            Phase::Idle | Phase::Output { .. } => nothing(1),
        }
    }

    fn is_empty(&self) -> bool {
        matches!(self.state.phase, Phase::Idle)
    }

    fn tell(&self, facts: &mut Facts) {
        let dot = self.config.dot_cycles;
        // Process 24 draws dots: flat polygons to selector (53), polygons of polyhedron mode to selector (28).
        facts.rate(2, dot, dot);
        facts.rate(3, dot, dot);
        let c = &self.state.counters;
        facts.figure(
            "short_cut_specular_negligible",
            c.specular_negligible,
            "polygons",
            "Polygons whose specular term was negligible",
        );
        facts.figure("short_cut_flat", c.flat, "polygons", "Polygons found flat");
        facts.figure("short_cut_same_plane", c.reused, "points", "Sample points whose brightness was reused");
        for (process, name) in Process::ALL {
            let process = c.processes[process as usize];
            let mut part = |what: &str, count, unit, about| {
                facts.figure(&format!("{name}_{what}"), count, unit, about).part(Part::Process(name.into()))
            };
            part("runs", process.runs, "runs", "Runs of the process");
            part("cycles", process.cycles, "cycles", "Cycles that all runs took");
        }
    }
}
