//! Brightness interpolation circuit (21).

use crate::dots::{CornerValues, DotScan, INTERPOLATION, set_up_cycles, tell_interpolator, triangle_cycles};
use crate::{BrightnessSelection, FigureFlow, InterpolationConfig, PolygonFigure, ShadedDot, ShadingMode};
use basrelief_kernel::stats::{FigureGroup, UnitStats};
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Operators, Step, Unit, UnitTable};
use basrelief_signals::Fragment;
use basrelief_signals::width::NUMBER;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Counters of circuit (21).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrightnessInterpolationCounters {
    /// Polygons drawn.
    pub polygons: u64,
    /// Dots drawn.
    pub drawn: u64,
    /// Cycles of occupancy by polygons.
    pub started_cycles: u64,
}

/// State of circuit (21) between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BrightnessInterpolationState {
    /// Polygon in progress.
    pub figure: Option<Arc<PolygonFigure>>,
    /// Position in the polygon.
    pub dots: DotScan,
    /// Brightness at the corners of the current triangle.
    pub corners: CornerValues,
    /// Counters.
    pub counters: BrightnessInterpolationCounters,
}

/// Brightness interpolation circuit (21): computes brightness and screen address of every dot from the brightness at the sample
/// points, linear on the screen (equation (6)), three components side by side. It also interpolates depth, which the patent does
/// not have.
///
/// Output 0 goes to the adder (52): all control, and the dots in normal-interpolation mode. Output 1 goes directly to selector
/// (28): dots in brightness-interpolation mode.
#[derive(Clone, Debug, Default)]
pub struct BrightnessInterpolation {
    /// Parameters.
    pub config: InterpolationConfig,
    operators: Operators,
    /// Latency of a dot.
    latency: u64,
    /// State between steps.
    pub state: BrightnessInterpolationState,
}

type Out = Step<(Option<FigureFlow>, Option<FigureFlow>)>;

impl BrightnessInterpolation {
    /// Creates a circuit in its power-on state.
    pub fn new(config: InterpolationConfig, operators: Operators) -> Self {
        let latency = operators.latency(INTERPOLATION);
        Self { config, operators, latency, state: BrightnessInterpolationState::default() }
    }

    /// Takes a polygon. Returns its occupancy in cycles, which is 0 if the dots come from process 24.
    fn begin(&mut self, figure: &Arc<PolygonFigure>) -> u64 {
        if figure.registers.selection() == BrightnessSelection::Mean {
            return 1;
        }
        let cycles = set_up_cycles(&figure.polygon, true, &self.operators).max(1);
        let state = &mut self.state;
        state.dots = DotScan::new(&figure.polygon, figure.raster);
        state.corners = CornerValues::default();
        state.figure = Some(Arc::clone(figure));
        state.counters.polygons += 1;
        state.counters.started_cycles += cycles;
        cycles
    }

    /// Returns the next dot of the polygon, or its end.
    #[inline]
    fn draw(&mut self) -> Out {
        let latency = self.latency;
        let state = &mut self.state;
        let Some(figure) = &state.figure else { return Step::after(0, (None, None)) };
        let to_adder = figure.registers.mode == ShadingMode::Normal;
        let (signal, cycles) = match state.dots.next(&figure.polygon) {
            Some(fragment) => {
                let brightness = state.corners.at(&fragment, |i| figure.brightness.get(i).copied().unwrap_or_default());
                let Fragment { x, y, z, .. } = fragment;
                state.counters.drawn += 1;
                (FigureFlow::Dot(ShadedDot { x, y, z, brightness }), u64::from(self.config.initiation_interval))
            }
            None => {
                state.figure = None;
                (FigureFlow::End, 1)
            }
        };
        state.counters.started_cycles += cycles;
        let out = if to_adder { (Some(signal), None) } else { (None, Some(signal)) };
        Step::after(latency, out).busy(cycles)
    }
}

impl Unit for BrightnessInterpolation {
    basrelief_kernel::unit_info!("interpolates brightness: all terms but the specular");
    type In = Option<FigureFlow>;
    type Out = (Option<FigureFlow>, Option<FigureFlow>);

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.figure.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Out {
        let Some(signal) = input else { return self.draw() };
        let cycles = if let FigureFlow::Figure(figure) = &signal { self.begin(figure) } else { 1 };
        Step::after(0, (Some(signal), None)).busy(cycles)
    }

    fn is_empty(&self) -> bool {
        self.state.figure.is_none()
    }

    fn twin_tables(&self) -> Vec<UnitTable> {
        let set_up = triangle_cycles(true, &self.operators);
        vec![UnitTable::number("latency", self.latency), UnitTable::number("set_up", set_up)]
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        for output in 0..2 {
            stats.rate(output, self.latency, self.config.initiation_interval);
        }
        tell_interpolator(stats, &self.operators, self.config.initiation_interval);
        stats.hardware(HardwareKind::Adder, "steps of the depth", 1_u64, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "depth and its two slopes", 3_u64, NUMBER);
        let c = &self.state.counters;
        stats.figure("interpolation_polygons", c.polygons, "polygons", "Polygons in the brightness interpolation circuit (21)");
        stats.figure("interpolation_dots", c.drawn, "dots", "Their dots");
        stats
            .figure("interpolation_started_cycles", c.started_cycles, "cycles", "Cycles in which it was started")
            .part(FigureGroup::Started("interpolation".into()));
    }
}
