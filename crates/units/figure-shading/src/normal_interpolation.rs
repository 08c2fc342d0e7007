//! Normal-interpolation brightness circuit (50).

use crate::dots::{CornerValues, DotScan, INTERPOLATION, set_up_cycles, tell_interpolator, triangle_cycles};
use crate::{NormalInterpolationConfig, NormalLoad, PowerFunction, SpecularDot, SpecularFlow};
use basrelief_kernel::stats::{FigureGroup, UnitStats};
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, OperatorCounts, Operators, Step, Unit, UnitTable};
use basrelief_signals::width::NUMBER;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Counters of circuit (50).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct NormalInterpolationCounters {
    /// Polygons drawn.
    pub polygons: u64,
    /// Dots drawn.
    pub drawn: u64,
    /// Times that the table was filled.
    pub table_fills: u64,
    /// Cycles of occupancy by polygons.
    pub started_cycles: u64,
    /// Cycles of occupancy by polygons for which gate (51) is open.
    pub needed_cycles: u64,
}

/// State of circuit (50) between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalInterpolationState {
    /// Polygon in progress.
    pub load: Option<Arc<NormalLoad>>,
    /// Position in the polygon.
    pub dots: DotScan,
    /// Normals at the corners of the current triangle.
    pub corners: CornerValues,
    /// Occupancy and latency of a dot of this polygon \[cycles\]. They follow from n and the number of lights.
    pub dot_cycles: [u64; 2],
    /// Exponent of the current table, if the circuit has one.
    pub filled_for: Option<f32>,
    /// Table of powers.
    pub table: Vec<f32>,
    /// Counters.
    pub counters: NormalInterpolationCounters,
}

/// Normal-interpolation brightness circuit (50): computes `Ks * sum of Is*(Np.H)^n` and the screen address of every dot from the
/// normals at the sample points. Np is the weighted sum of the normals (equation (12)), normalised only if `renormalise` is set.
/// Np.H is clamped to 0..=1 before the power.
///
/// Each light occupies the circuit for the time of its power. The power by iteration has one multiplier, unless it is pipelined.
/// Normalising occupies the circuit for the time of the square root or the division, neither of which is pipelined. The circuit
/// has one of each, and only if it renormalises.
#[derive(Clone, Debug)]
pub struct NormalInterpolation {
    /// Parameters.
    pub config: NormalInterpolationConfig,
    renormalise: bool,
    operators: Operators,
    power: PowerFunction,
    /// State between steps.
    pub state: NormalInterpolationState,
}

type Out = Step<Option<SpecularFlow>>;

impl NormalInterpolation {
    /// Creates a circuit in its power-on state. `renormalise` is `shade.renormalise`.
    pub fn new(config: NormalInterpolationConfig, renormalise: bool, operators: Operators) -> Self {
        let power = PowerFunction::new(&config, &operators);
        Self { config, renormalise, operators, power, state: NormalInterpolationState::default() }
    }

    fn charge(&mut self, open: bool, cycles: u64) {
        self.state.counters.started_cycles += cycles;
        self.state.counters.needed_cycles += if open { cycles } else { 0 };
    }

    /// Fills the table for `n` if it holds another exponent. Returns the cycles.
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
        let setup = set_up_cycles(&load.polygon, false, &self.operators);
        let fill = self.fill(n);
        let cycles = (setup + fill).max(1);
        let open = load.open;
        self.state.dot_cycles = self.dot_cycles(n, load.illumination.lights.len().max(1) as u64);
        self.state.dots = DotScan::new(&load.polygon, load.raster);
        self.state.corners = CornerValues::default();
        self.state.counters.polygons += 1;
        self.state.load = Some(load);
        self.charge(open, cycles);
        Step::after(0, Some(SpecularFlow::Start { open })).busy(cycles)
    }

    /// Returns the next dot of the polygon, or its end.
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
            SpecularFlow::Dot(SpecularDot { x: dot.x, y: dot.y, brightness })
        } else {
            state.load = None;
            cycles = 1;
            SpecularFlow::End
        };
        self.charge(open, cycles);
        Step::after(latency, Some(out)).busy(cycles)
    }

    /// Returns occupancy and latency of a dot. The first light's power follows the inner product, and each further one follows
    /// the power before it. Then each is multiplied by Is*Ks, and added to the earlier ones. The normal is normalised once for
    /// all lights.
    fn dot_cycles(&self, n: f32, lights: u64) -> [u64; 2] {
        let power = self.power.occupancy(n);
        let second_product = self.power.inner_products() - u64::from(self.config.initiation_interval);
        let sum = if lights > 1 { self.operators.latency(OperatorCounts { add: 1, ..OperatorCounts::NONE }) } else { 0 };
        let first = self.latency_before() + second_product + self.power.latency(n) + self.operators.latency(SCALE);
        [(power * lights).max(self.normalise_interval()), first + power * (lights - 1) + sum]
    }

    /// Returns the cycles from a dot's start to its first N.H.
    fn latency_before(&self) -> u64 {
        let normalise = if self.renormalise { self.operators.latency(NORMALISATION) } else { 0 };
        self.operators.latency(INTERPOLATION) + normalise + self.operators.latency(INNER_PRODUCT)
    }

    /// Returns the occupancy of a normalisation \[cycles\].
    fn normalise_interval(&self) -> u64 {
        if self.renormalise { self.operators.interval(OperatorCounts::NORMALIZE, NORMALISER) } else { 1 }
    }

    fn tell_hardware(&self, stats: &mut UnitStats) {
        let interval = self.config.initiation_interval;
        tell_interpolator(stats, &self.operators, interval);
        let [multiply, add] = [self.operators.multiply.interval, self.operators.add.interval];
        if interval == 1 && multiply == 1 && add == 1 {
            stats.hardware(HardwareKind::InnerProduct, "N.H", 1_u64, OperandWidth::SINGLE);
        } else {
            let have = self.operators.sustaining(OperatorCounts::INNER_PRODUCT, interval);
            stats.hardware(HardwareKind::Multiplier, "N.H", have.multiply, OperandWidth::SINGLE);
            stats.hardware(HardwareKind::Adder, "N.H", have.add, OperandWidth::SINGLE);
        }
        if self.renormalise {
            stats.shared_operators("normals to length 1", NORMALISER, OperatorCounts::NORMALIZE, OperandWidth::SINGLE);
        }
        self.power.report_stats(stats);
        stats.hardware(HardwareKind::Multiplier, "Is*Ks", 1_u64, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Adder, "sum over lights", 1_u64, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "H and Is*Ks of a light, n", 5_u64, NUMBER);
    }
}

/// Longest dependent chain of an inner product.
const INNER_PRODUCT: OperatorCounts = OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE };
/// Longest dependent chain from a power to the gate.
const SCALE: OperatorCounts = OperatorCounts { multiply: 1, ..OperatorCounts::NONE };
/// Longest dependent chain of a normalisation: squared length, root, reciprocal, products.
const NORMALISATION: OperatorCounts = OperatorCounts { multiply: 2, add: 2, divide: 1, square_root: 1, ..OperatorCounts::NONE };
/// Hardware of the normalisation: multipliers and adders for one per cycle, one square-root unit and one divider, which are
/// slower.
const NORMALISER: OperatorCounts = OperatorCounts::NORMALIZE;

/// Exponent for which the rate is reported: the patent's largest.
const LARGEST_EXPONENT: f32 = 200.0;

impl Unit for NormalInterpolation {
    basrelief_kernel::unit_info!("interpolates normals: the specular term");
    type In = Option<Arc<NormalLoad>>;
    type Out = Option<SpecularFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.load.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Out {
        match input {
            Some(load) => self.begin(load),
            None => self.draw(),
        }
    }

    fn is_empty(&self) -> bool {
        self.state.load.is_none()
    }

    /// Returns the cycles of a triangle's set-up, of a dot before and behind its powers, of a further light's sum, of an inner product,
    /// and of a normalisation.
    fn twin_tables(&self) -> Vec<UnitTable> {
        let second_product = self.power.inner_products() - u64::from(self.config.initiation_interval);
        let numbers = [
            ("set_up", triangle_cycles(false, &self.operators)),
            ("fixed_latency", self.latency_before() + second_product + self.operators.latency(SCALE)),
            ("sum_latency", self.operators.latency(OperatorCounts { add: 1, ..OperatorCounts::NONE })),
            ("inner_products", self.power.inner_products()),
            ("normalise", self.normalise_interval()),
        ];
        numbers.into_iter().map(|(name, value)| UnitTable::number(name, value)).collect()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let [interval, latency] = self.dot_cycles(LARGEST_EXPONENT, 1);
        stats.rate(0, latency, interval);
        self.tell_hardware(stats);
        let c = &self.state.counters;
        stats.figure(
            "normal_interpolation_polygons",
            c.polygons,
            "polygons",
            "Polygons in the normal-interpolation brightness circuit (50)",
        );
        stats.figure("normal_interpolation_dots", c.drawn, "dots", "Their dots");
        let circuit = || "normal_interpolation".into();
        stats
            .figure("normal_interpolation_started_cycles", c.started_cycles, "cycles", "Cycles in which it was started")
            .part(FigureGroup::Started(circuit()));
        stats
            .figure("normal_interpolation_needed_cycles", c.needed_cycles, "cycles", "Started cycles whose result was needed")
            .part(FigureGroup::Needed(circuit()));
        stats.figure("power_table_fills", c.table_fills, "fills", "Times that the table of powers was filled");
    }
}
