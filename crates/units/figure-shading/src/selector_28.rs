//! Selector (28), the output of the device.

use crate::{
    BrightnessSelection, CircuitConfig, FigureFlow, FinishedPolygon, PolygonFigure, PolygonRoute, ShadedDot, ShadingMode,
};
use basrelief_kernel::stats::{FigureGroup, UnitStats};
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Step, Unit};
use basrelief_shading::saturated;
use basrelief_signals::{Control, Flow, Pixel, Stamp};
use serde::{Deserialize, Serialize};

/// Input from selector (53), which also carries control.
const FROM_53: usize = 0;
/// Input from circuit (21).
const FROM_21: usize = 1;
/// Input from process 24.
const FROM_24: usize = 2;

/// Counters of selector (28).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Selector28Counters {
    /// Polygons, by route.
    pub polygons: [u64; 6],
    /// Dots, by route.
    pub dots: [u64; 6],
}

/// State of selector (28) between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Selector28State {
    /// Selected input.
    pub selected: usize,
    /// Route of the current polygon.
    pub route: PolygonRoute,
    /// Counters.
    pub counters: Selector28Counters,
}

/// Selector (28): passes the output of selector (53) (input 0), of circuit (21) (input 1) or of process 24 (input 2) to the frame
/// memory (300), as the mode register (14) selects. The address comes with the dot. Brightness is saturated to 8 bits here, once.
/// (In brightness-interpolation mode flat polygons come from process 24 if `shade.flat_in_brightness_mode` is set.)
///
/// Output 1 reports each finished polygon to the host interface.
#[derive(Clone, Debug, Default)]
pub struct Selector28 {
    /// Parameters.
    pub config: CircuitConfig,
    /// State between steps.
    pub state: Selector28State,
}

impl Selector28 {
    /// Creates a selector in its power-on state.
    pub fn new(config: CircuitConfig) -> Self {
        Self { config, state: Selector28State::default() }
    }

    fn select(&mut self, figure: &PolygonFigure) {
        self.state.route = figure.route;
        self.state.counters.polygons[figure.route as usize] += 1;
        self.state.selected = match (figure.registers.mode, figure.registers.selection()) {
            (ShadingMode::Normal, _) => FROM_53,
            (_, BrightnessSelection::Mean) => FROM_24,
            _ => FROM_21,
        };
    }

    #[inline]
    fn pixel(&mut self, dot: ShadedDot) -> Pixel {
        self.state.counters.dots[self.state.route as usize] += 1;
        Pixel { x: dot.x, y: dot.y, z: dot.z, rgb: saturated(dot.brightness) }
    }
}

impl Unit for Selector28 {
    basrelief_kernel::unit_info!("by the mode: (53), (21) or process 24; saturates");
    type In = (Option<FigureFlow>, Option<FigureFlow>, Option<FigureFlow>);
    type Out = (Option<Flow<Stamp<Pixel>>>, Option<FinishedPolygon>);

    #[inline]
    fn demand(&self) -> Demand {
        Demand::Only(self.state.selected)
    }

    #[inline]
    fn step(&mut self, (from_53, from_21, from_24): Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let mut cycles = 1;
        let out = match from_53.or(from_21).or(from_24) {
            Some(FigureFlow::Dot(dot)) => {
                cycles = u64::from(self.config.initiation_interval);
                // One push: collecting an iterator costs half as much again as the rest of the step.
                let mut stamp = Stamp::new();
                stamp.push(self.pixel(dot));
                (Some(Flow::Item(stamp)), None)
            }
            Some(FigureFlow::Figure(figure)) => {
                self.select(&figure);
                (None, None)
            }
            Some(FigureFlow::End) => {
                self.state.selected = FROM_53;
                (None, Some(FinishedPolygon))
            }
            Some(FigureFlow::Frame(frame)) => (Some(Flow::Control(Control::Frame(frame))), None),
            Some(FigureFlow::FrameEnd) => (Some(Flow::Control(Control::FrameEnd)), None),
            None => (None, None),
        };
        Step::after(u64::from(self.config.latency), out).busy(cycles)
    }

    fn is_empty(&self) -> bool {
        self.state.selected == FROM_53
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.config.latency, self.config.initiation_interval);
        let each = 3_u32.div_ceil(self.config.initiation_interval.max(1));
        // 255 c = 256 c - c, so no multiplier is needed.
        stats.hardware(HardwareKind::Adder, "to steps of 8 bits", each, OperandWidth::from(32).of_integers());
        stats.hardware(HardwareKind::Adder, "rounding", each, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Adder, "cutting off at either end", 2 * each, OperandWidth::from(8).of_integers());
        stats.hardware(HardwareKind::Registers, "mode register (14) as of the polygon that passes", 1_u64, 2);
        let c = &self.state.counters;
        stats.figure("fragments", c.dots.iter().sum::<u64>(), "dots", "Dots drawn; a dot is a fragment").part(FigureGroup::Work);
        let routes = |counts: [u64; 6]| PolygonRoute::ALL.map(|route| (route.name(), counts[route as usize]));
        for (name, polygons) in routes(c.polygons) {
            stats
                .figure(&format!("polygons_{name}"), polygons, "polygons", "Polygons on this route")
                .part(FigureGroup::Route(name.into()));
        }
        for (name, dots) in routes(c.dots) {
            stats.figure(&format!("dots_{name}"), dots, "dots", "Their dots").part(FigureGroup::Route(name.into()));
        }
    }
}
