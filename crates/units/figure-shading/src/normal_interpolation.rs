//! Normal-interpolation brightness circuit (50).

use crate::dots::{Corners, Dots, INTERPOLATION, needed, set_up_cycles, tell_interpolator};
use crate::{Highlight, Highlights, NormalInterpolationConfig, NormalLoad, Power};
use basrelief_kernel::facts::{Facts, Part};
use basrelief_kernel::{Demand, HardwareKind, Operators, Step, Traffic, Unit, Work};
use basrelief_signals::width::NUMBER;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What circuit (50) has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct NormalInterpolationCounters {
    /// Polygons drawn.
    pub polygons: u64,
    /// Dots drawn.
    pub drawn: u64,
    /// Times that the table was filled.
    pub table_fills: u64,
    /// Cycles that polygons kept the circuit.
    pub started_cycles: u64,
    /// Of these, cycles of polygons for which gate (51) is open.
    pub needed_cycles: u64,
}

/// Everything circuit (50) remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalInterpolationState {
    /// The polygon that is part-way.
    pub load: Option<Arc<NormalLoad>>,
    /// Where in it.
    pub dots: Dots,
    /// Normals at the corners of the current triangle.
    pub corners: Corners,
    /// Cycles that a dot of this polygon keeps the circuit, and from its start to delivery; they follow from n and the
    /// number of lights.
    pub dot_cycles: [u64; 2],
    /// Exponent for which the table is filled, with a table.
    pub filled_for: Option<f32>,
    /// The table.
    pub table: Vec<f32>,
    /// What it has counted.
    pub counters: NormalInterpolationCounters,
}

/// Normal-interpolation brightness circuit (50): from the normals at the sample points to `Ks * sum of Is*(Np.H)^n` and the
/// screen address of every dot. Np is the weighted sum of the normals (equation (12)), not brought to length 1 unless
/// `renormalise` asks for it; Np.H is clamped to 0..=1 before the power.
///
/// Each light keeps the circuit as long as its power does; the power by iteration has one multiplier, unless it is
/// pipelined. Bringing a normal to length 1 keeps it as long as the square root or the division does, neither of which is in a
/// pipeline: the circuit has one of each, and only where it renormalises.
#[derive(Clone, Debug)]
pub struct NormalInterpolation {
    /// Parameters.
    pub config: NormalInterpolationConfig,
    renormalise: bool,
    operators: Operators,
    power: Power,
    /// Everything it remembers.
    pub state: NormalInterpolationState,
}

type Out = Step<Option<Highlights>>;

impl NormalInterpolation {
    /// A circuit at power-on; `renormalise` is `shade.renormalise`.
    pub fn new(config: NormalInterpolationConfig, renormalise: bool, operators: Operators) -> Self {
        let power = Power::new(&config, &operators);
        Self { config, renormalise, operators, power, state: NormalInterpolationState::default() }
    }

    fn charge(&mut self, open: bool, cycles: u64) {
        self.state.counters.started_cycles += cycles;
        self.state.counters.needed_cycles += if open { cycles } else { 0 };
    }

    /// Fills the table for `n`, unless it is; the cycles that it takes.
    fn fill(&mut self, n: f32) -> u64 {
        if self.state.filled_for == Some(n) {
            return 0;
        }
        let cycles = self.power.fill_cycles(n);
        self.state.counters.table_fills += u64::from(cycles > 0);
        self.state.table = self.power.table(n);
        self.state.filled_for = Some(n);
        cycles
    }

    fn begin(&mut self, load: Arc<NormalLoad>) -> Out {
        let n = load.illumination.lighting.n;
        let setup = set_up_cycles(&load.polygon, &self.operators);
        let fill = self.fill(n);
        let cycles = (setup + fill).max(1);
        let open = load.open;
        self.state.dot_cycles = self.dot_cycles(n, load.illumination.lights.len().max(1) as u64);
        self.state.dots = Dots::new(&load.polygon, load.raster);
        self.state.corners = Corners::default();
        self.state.counters.polygons += 1;
        self.state.load = Some(load);
        self.charge(open, cycles);
        Step::after(0, Some(Highlights::Start { open })).busy(cycles)
    }

    /// The next dot of the polygon, or its end.
    #[inline]
    fn draw(&mut self) -> Out {
        let state = &mut self.state;
        let Some(load) = &state.load else { return Step::after(0, None) };
        let (illumination, open) = (&load.illumination, load.open);
        let [mut cycles, latency] = state.dot_cycles;
        let out = if let Some(dot) = state.dots.next(&load.polygon) {
            let sum = Vec3::from(state.corners.at(&dot, |i| load.normals.get(i).copied().unwrap_or_default().to_array()));
            let normal = if self.renormalise { sum.normalize_or_zero() } else { sum };
            let (power, table, n) = (&self.power, &state.table, illumination.lighting.n);
            let brightness = illumination.highlight(|light| power.at(table, normal.dot(light.halfway).clamp(0.0, 1.0), n));
            state.counters.drawn += 1;
            Highlights::Dot(Highlight { x: dot.x, y: dot.y, brightness })
        } else {
            state.load = None;
            cycles = 1;
            Highlights::End
        };
        self.charge(open, cycles);
        Step::after(latency, Some(out)).busy(cycles)
    }

    /// Occupancy and latency of a dot: the first light's power comes behind the inner product, each further one's behind
    /// the power before it; then it is multiplied by Is*Ks, and added to those before it. The normal is brought to length 1
    /// once for all lights.
    fn dot_cycles(&self, n: f32, lights: u64) -> [u64; 2] {
        let power = self.power.occupancy(n);
        let second_product = self.power.inner_products() - u64::from(self.config.initiation_interval);
        let sum = if lights > 1 { self.operators.latency(Work { add: 1, ..Work::NONE }) } else { 0 };
        let first = self.latency_before() + second_product + self.power.latency(n) + self.operators.latency(SCALE);
        [(power * lights).max(self.normalise_interval()), first + power * (lights - 1) + sum]
    }

    /// Cycles from a dot's start to its first N.H.
    fn latency_before(&self) -> u64 {
        let normalise = if self.renormalise { self.operators.latency(NORMALISATION) } else { 0 };
        self.operators.latency(INTERPOLATION) + normalise + self.operators.latency(INNER_PRODUCT)
    }

    /// Cycles for which bringing a normal to length 1 keeps the circuit.
    fn normalise_interval(&self) -> u64 {
        if self.renormalise { self.operators.interval(Work::NORMALIZE, NORMALISER) } else { 1 }
    }

    fn tell_hardware(&self, facts: &mut Facts) {
        let interval = self.config.initiation_interval;
        tell_interpolator(facts, &self.operators, interval);
        let [multiply, add] = [self.operators.multiply.interval, self.operators.add.interval];
        if interval == 1 && multiply == 1 && add == 1 {
            facts.hardware(HardwareKind::InnerProduct, "N.H", 1_u64, NUMBER);
        } else {
            facts.hardware(HardwareKind::Multiplier, "N.H", needed(Work::INNER_PRODUCT.multiply, multiply, interval), NUMBER);
            facts.hardware(HardwareKind::Adder, "N.H", needed(Work::INNER_PRODUCT.add, add, interval), NUMBER);
        }
        if self.renormalise {
            let about = "normals to length 1";
            facts.hardware(HardwareKind::Multiplier, about, NORMALISER.multiply, NUMBER);
            facts.hardware(HardwareKind::Adder, about, NORMALISER.add, NUMBER);
            facts.hardware(HardwareKind::Divider, about, NORMALISER.divide, NUMBER);
            facts.hardware(HardwareKind::SquareRoot, about, NORMALISER.square_root, NUMBER);
        }
        self.power.tell(facts);
        facts.hardware(HardwareKind::Multiplier, "Is*Ks", 1_u64, NUMBER);
        facts.hardware(HardwareKind::Adder, "sum over lights", 1_u64, NUMBER);
        facts.hardware(HardwareKind::Registers, "H and Is*Ks of a light, n", 5_u64, NUMBER);
    }
}

/// Chain of an inner product.
const INNER_PRODUCT: Work = Work { multiply: 1, add: 2, ..Work::NONE };
/// Chain of a power's way to the gate.
const SCALE: Work = Work { multiply: 1, ..Work::NONE };
/// Chain that brings a normal to length 1: the square of its length, the root, its reciprocal, the products.
const NORMALISATION: Work = Work { multiply: 2, add: 2, divide: 1, square_root: 1, power: 0 };
/// What there is for it: multipliers and adders for one per cycle, one root and one divider, which are slower.
const NORMALISER: Work = Work::NORMALIZE;

/// Exponent for which the rate is told: the patent's largest.
const LARGEST_EXPONENT: f32 = 200.0;

impl Unit for NormalInterpolation {
    basrelief_kernel::role!("interpolates normals: the specular term");
    type In = Option<Arc<NormalLoad>>;
    type Out = Option<Highlights>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.load.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut Traffic) -> Out {
        match input {
            Some(load) => self.begin(load),
            None => self.draw(),
        }
    }

    fn is_empty(&self) -> bool {
        self.state.load.is_none()
    }

    fn tell(&self, facts: &mut Facts) {
        let [interval, latency] = self.dot_cycles(LARGEST_EXPONENT, 1);
        facts.rate(0, latency, interval);
        self.tell_hardware(facts);
        let c = &self.state.counters;
        facts.figure(
            "normal_interpolation_polygons",
            c.polygons,
            "polygons",
            "Polygons in the normal-interpolation brightness circuit (50)",
        );
        facts.figure("normal_interpolation_dots", c.drawn, "dots", "Their dots");
        let circuit = || "normal_interpolation".into();
        facts
            .figure("normal_interpolation_started_cycles", c.started_cycles, "cycles", "Cycles in which it was started")
            .part(Part::Started(circuit()));
        facts
            .figure("normal_interpolation_needed_cycles", c.needed_cycles, "cycles", "Those whose result was needed")
            .part(Part::Needed(circuit()));
        facts.figure("power_table_fills", c.table_fills, "fills", "Times that the table of powers was filled");
    }
}
