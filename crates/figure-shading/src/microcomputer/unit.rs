//! The unit and its steps: one to decide, one to shade, and one per dot of process 24.

use super::flatness::{is_flat, normals_of};
use super::mean::{Plane, mean};
use super::sample_points::brightness;
use super::specular::is_negligible;
use super::state::{Decided, MicrocomputerState, Phase, Process};
use crate::dots::Dots;
use crate::{
    Dot, Figure, MicrocomputerConfig, Mode, NormalInterpolationConfig, NormalLoad, Path, Power, Registers, ScanConfig, Selection,
    Setting, ShadingConfig, ShortCutConfigs, Signal, SpecularSkip,
};
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_shading::{Raster, light_vectors};
use basrelief_signals::{Control, Fragment, Polygon};
use glam::Vec3;
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
    config: MicrocomputerConfig,
    shading: ShadingConfig,
    short_cuts: ShortCutConfigs,
    scan: ScanConfig,
    /// As circuit (50) has it: process 17 must know its rounding.
    power: Power,
    state: MicrocomputerState,
}

/// One token per output.
type Outs = (Option<Signal>, Option<Arc<NormalLoad>>, Option<Signal>, Option<Signal>);
type Out = Step<Outs>;

fn nothing(cycles: u64) -> Out {
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

    /// State; for checkpoints.
    pub fn state(&self) -> &MicrocomputerState {
        &self.state
    }

    /// Puts a state back; the default resets.
    pub fn set_state(&mut self, state: MicrocomputerState) {
        self.state = state;
    }

    /// Runs and cycles of a process.
    pub fn process(&self, process: Process) -> super::ProcessCounters {
        self.state.processes[process as usize]
    }

    /// What was counted beside the processes.
    pub fn counters(&self) -> super::Counters {
        self.state.counters
    }

    /// A process runs; its cycles.
    fn run(&mut self, process: Process, cycles: u64) -> u64 {
        let counters = &mut self.state.processes[process as usize];
        counters.runs += 1;
        counters.cycles += cycles;
        cycles
    }

    fn take(&mut self, control: Control) -> Out {
        match control {
            Control::Frame(frame) => {
                let cycles = self.run(Process::Mode, u64::from(self.config.mode_cycles));
                let ScanConfig { subpixel_bits, block, z_bits } = self.scan;
                self.state.raster = Raster::new([frame.width, frame.height], subpixel_bits, z_bits, block);
                self.state.frame = Some(Arc::clone(&frame));
                self.state.object = None;
                self.state.lights_changed = true;
                passed(cycles, Signal::Frame(frame))
            }
            Control::Object(object) => {
                self.state.object = Some(object);
                self.state.lights_changed = true;
                nothing(1)
            }
            Control::Polygon(polygon) => self.decide(polygon),
            Control::FrameEnd => passed(1, Signal::FrameEnd),
            Control::CodeBook(_) => nothing(1),
        }
    }

    /// Brings the setting up to date for this polygon; the cycles that it takes.
    fn set(&mut self, polygon: &Polygon) -> u64 {
        let material = &polygon.material;
        let [r, g, b, _] = material.base_color;
        let old = &self.state.setting;
        if !self.state.lights_changed && old.lighting == material.lighting && old.color == [r, g, b] {
            return 0;
        }
        self.state.lights_changed = false;
        let centre = self.state.object.as_ref().map_or([0.0; 3], |o| o.centre);
        let mut lights = self.state.frame.as_ref().map_or_else(Vec::new, |frame| light_vectors(frame, centre));
        lights.iter_mut().for_each(|light| light.intensity *= self.shading.is);
        let cycles = u64::from(self.config.setting_cycles_per_light) * lights.len() as u64;
        let (mode, ambient) = (self.shading.mode, self.shading.ia);
        let new = Setting { mode, lighting: material.lighting, color: [r, g, b], ambient, lights };
        if **old != new {
            self.state.plane = None;
            self.state.setting = Arc::new(new);
        }
        self.run(Process::Mode, cycles)
    }

    /// Processes 15, 92, 17 and 20.
    fn decide(&mut self, polygon: Arc<Polygon>) -> Out {
        let mut cycles = self.set(&polygon);
        let normals = normals_of(&polygon);
        let (flat, flat_cycles) = self.judge_flatness(&normals);
        let (reused, plane_cycles) = if flat { self.judge_plane(&polygon, &normals) } else { (false, 0) };
        let (specular, specular_cycles) = if reused { (true, 0) } else { self.judge_specular(&normals) };
        cycles += flat_cycles + plane_cycles + specular_cycles;
        let registers = Registers { mode: self.shading.mode, flat, specular };
        let closed_but_started = self.shading.specular_skip == SpecularSkip::Gate
            && registers.mode == Mode::Normal
            && registers.selection() == Selection::Linear;
        let starts = closed_but_started || registers.selection() == Selection::LinearAndSpecular;
        let load = starts.then(|| {
            let load = u64::from(self.config.load_cycles_per_point) * normals.len() as u64;
            cycles += self.run(Process::Start, u64::from(self.config.start_cycles) + load);
            self.state.counters.starts += 1;
            let (raster, setting) = (self.state.raster, Arc::clone(&self.state.setting));
            Arc::new(NormalLoad { polygon: Arc::clone(&polygon), raster, normals, setting, open: specular })
        });
        self.state.phase = Phase::Shade(Decided { polygon, registers, reused });
        Step::after(cycles, (None, load, None, None)).busy(cycles.max(1))
    }

    /// Process 15; in polyhedron mode there is nothing to decide.
    fn judge_flatness(&mut self, normals: &[Vec3]) -> (bool, u64) {
        let matters = match self.shading.mode {
            Mode::Normal => true,
            Mode::Brightness => self.shading.flat_in_brightness_mode,
            Mode::Polyhedron => false,
        };
        if !matters || !self.short_cuts.flatness.enabled {
            return (false, 0);
        }
        let flat = is_flat(normals, self.short_cuts.flatness.tolerance);
        self.state.counters.flat += u64::from(flat);
        (flat, self.run(Process::Flatness, u64::from(self.config.flatness_cycles_per_point) * normals.len() as u64))
    }

    /// Figure 7, step 92, and 95 if the brightness is reused.
    fn judge_plane(&mut self, polygon: &Polygon, normals: &[Vec3]) -> (bool, u64) {
        if !self.short_cuts.same_plane.enabled {
            return (false, 0);
        }
        let reused = self.state.plane.is_some_and(|p| p.holds(polygon, normals, &self.short_cuts.same_plane));
        self.state.counters.reused += u64::from(reused);
        let read = if reused { u64::from(self.config.memory_cycles) } else { 0 };
        let compare = u64::from(self.config.same_plane_cycles_per_point) * normals.len() as u64;
        (reused, self.run(Process::SamePlane, compare + read))
    }

    /// Process 17.
    fn judge_specular(&mut self, normals: &[Vec3]) -> (bool, u64) {
        let config = &self.short_cuts.specular_negligible;
        if !config.enabled {
            return (true, 0);
        }
        let negligible = is_negligible(normals, &self.state.setting, self.shading.renormalise, config.threshold, &self.power);
        self.state.counters.specular_negligible += u64::from(negligible);
        let per_light = u64::from(self.config.specular_cycles_per_point) * normals.len() as u64
            + u64::from(self.config.specular_power_cycles);
        (!negligible, self.run(Process::Specular, per_light * self.state.setting.lights.len() as u64))
    }

    /// Processes 22 and 23 or 24, up to the first dot.
    fn shade(&mut self, decided: Decided) -> Out {
        let Decided { polygon, registers, reused } = decided;
        let (points, mut cycles) = (polygon.vertices.len() as u64, 0);
        let mut brightness = Vec::new();
        if !reused {
            brightness = self.sample_points(&polygon, registers, &mut cycles);
        }
        let raster = self.state.raster;
        let mean = (registers.selection() == Selection::Mean).then(|| self.mean(&polygon, &brightness, reused, &mut cycles));
        if mean.is_some() {
            brightness.clear();
        } else {
            cycles += self.run(Process::Transfer, u64::from(self.config.transfer_cycles_per_point) * points);
        }
        let path = Path::of(registers, reused);
        let figure = Arc::new(Figure { polygon, raster, registers, path, brightness });
        if let Some(brightness) = mean {
            self.state.dots = Dots::new(&figure.polygon, raster);
            self.state.phase = Phase::Output { figure: Arc::clone(&figure), brightness };
        }
        passed(cycles, Signal::Figure(figure))
    }

    /// Process 22.
    fn sample_points(&mut self, polygon: &Polygon, registers: Registers, cycles: &mut u64) -> Vec<[f32; 3]> {
        let c = &self.config;
        let specular = if registers.adds_specular_at_sample_points() { c.specular_brightness_cycles_per_point } else { 0 };
        let per_point = u64::from(c.brightness_cycles_per_point + specular) * self.state.setting.lights.len().max(1) as u64;
        *cycles += self.run(Process::Brightness, per_point * polygon.vertices.len() as u64);
        brightness(polygon, &self.state.setting, registers, self.shading.clamp)
    }

    /// Process 24 without its output; steps 94 and 95 of Figure 7.
    fn mean(&mut self, polygon: &Polygon, brightness: &[[f32; 3]], reused: bool, cycles: &mut u64) -> [f32; 3] {
        if let (true, Some(plane)) = (reused, &self.state.plane) {
            return plane.brightness;
        }
        *cycles += self.run(Process::Mean, u64::from(self.config.mean_cycles_per_point) * brightness.len() as u64);
        let mean = mean(brightness);
        if self.shading.mode != Mode::Polyhedron && self.short_cuts.same_plane.enabled {
            *cycles += self.run(Process::SamePlane, u64::from(self.config.memory_cycles));
            let normal = normals_of(polygon).first().copied().unwrap_or_default();
            self.state.plane = Plane::of(polygon, normal, mean);
        }
        mean
    }

    /// The next dot of process 24, or the polygon's end.
    #[inline]
    fn put_out(&mut self) -> Out {
        let Phase::Output { figure, brightness } = &self.state.phase else { return nothing(1) };
        let to_53 = figure.registers.mean_goes_to_53();
        let mut cycles = 1;
        let signal = if let Some(Fragment { x, y, z, .. }) = self.state.dots.next(&figure.polygon) {
            cycles = u64::from(self.config.dot_cycles);
            self.state.counters.dots += 1;
            self.state.processes[Process::Mean as usize].cycles += cycles;
            Signal::Dot(Dot { x, y, z, brightness: *brightness })
        } else {
            self.state.phase = Phase::Idle;
            Signal::End
        };
        let out = if to_53 { (None, None, Some(signal), None) } else { (None, None, None, Some(signal)) };
        Step::after(cycles, out).busy(cycles)
    }
}

impl Unit for Microcomputer {
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
}
