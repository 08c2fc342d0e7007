//! The unit and its step.

use super::state::BINS;
use super::{RootTable, StepCalculatorState, StepEquation, StepReach, keeps_bound};
use crate::config::{Method, TexelConfig};
use crate::fixed::down;
use crate::log::SpanRecord;
use crate::signals::{DivisionPoints, LineSegment, ScanSpan};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, OperatorCounts, Operators, Step, Unit, UnitTable};
use basrelief_signals::{Control, Flow};
use smallvec::smallvec;
use std::sync::Arc;

/// Arithmetic from e / |dw| to the argument of the first root, and from that root to the step.
const FIRST_STEP: OperatorCounts = OperatorCounts { multiply: 1, add: 1, ..OperatorCounts::NONE };
/// Arithmetic from a step to the argument of the next root, which differs by e t, and from that root to the next step.
const NEXT_STEP: OperatorCounts = OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE };

/// Step calculator of the texel value generator (310), with its storage element. It takes spans, chooses division points, and
/// sends each segment to the approximate calculator (310a) and its points to the dividers.
///
/// A step of this unit is a turn of Figure 4B: from the current point to the next one. It takes a square root, or a look-up, and
/// the next turn waits for it. The first turn of a span also waits for e / |dw|. Division points of a span are thus found ahead
/// of the quotients, and no division waits for the interpolation before it.
///
/// Products and a comparison decide if a span needs division points ([`keeps_bound`]). They work in a pipeline ahead of the
/// turns, so that spans without division points pass at its rate. (Dividing for each span first, and then finding that the step
/// reaches its end, would occupy the unit longer for a span of a dozen pixels than walking them takes.)
#[derive(Clone, Debug, Default)]
pub struct StepCalculator {
    /// Parameters.
    pub config: TexelConfig,
    /// Bits of a quotient or root computed per cycle.
    pub bits_per_cycle: u32,
    /// Latencies of the operators.
    pub operators: Operators,
    /// State between steps.
    pub state: StepCalculatorState,
    /// Table of roots, computed from the parameters.
    pub(super) table: Option<RootTable>,
}

impl StepCalculator {
    /// Creates a step calculator in its power-on state. The first token selects the configured criterion, and the display list
    /// can select others (step 442).
    pub fn new(config: TexelConfig, bits_per_cycle: u32, operators: Operators) -> Self {
        let table = (config.step_table > 0).then(|| RootTable::new(config.step_table));
        Self { config, bits_per_cycle, operators, state: StepCalculatorState::default(), table }
    }

    /// Returns the table that replaces the square root, if any.
    pub fn table(&self) -> Option<&RootTable> {
        self.table.as_ref()
    }

    /// Starts to record spans.
    pub fn keep_log(&mut self) {
        self.state.log = Some(Vec::new());
    }

    /// Applies a control token.
    fn take(&mut self, control: &Control) {
        let state = &mut self.state;
        match control {
            // Step 442.
            Control::Criterion(error_bound) => state.storage.select(*error_bound),
            Control::Polygon(polygon) => {
                state.polygon = Some(Arc::clone(polygon));
                state.subdivision.forget();
            }
            Control::FrameEnd => {
                if let Some(log) = &mut state.log {
                    state.finished.push(std::mem::take(log));
                }
            }
            Control::Frame(_) | Control::Object(_) | Control::CodeBook(_) => {}
        }
    }

    /// Runs Figure 4A from step 420 on. Returns the cycles beyond the first turn.
    fn begin(&mut self, span: ScanSpan) -> u64 {
        let state = &mut self.state;
        state.from = 0;
        state.equation = None;
        state.counters.spans += 1;
        state.counters.pixels += u64::from(span.count);
        state.counters.single += u64::from(span.count == 1);
        let mut cycles = 0;
        if !span.textured {
            state.counters.untextured += 1;
        } else if self.config.method == Method::Adaptive {
            cycles = self.begin_adaptive(&span);
        } else if self.config.method == Method::Subpolygon {
            state.subdivision.enter(state.polygon.as_deref(), span.triangle, self.config.interval);
        }
        if let Some(log) = self.state.log.as_mut().filter(|_| span.textured) {
            log.push(SpanRecord::new(&span));
        }
        self.state.span = Some(span);
        cycles
    }

    /// Runs step 430, or step 440 if the bound does not hold to the end.
    fn begin_adaptive(&mut self, span: &ScanSpan) -> u64 {
        let (decision, iterations) = (self.decision(), self.iterations());
        let state = &mut self.state;
        let e = state.storage.criterion();
        if u32::from(span.count) <= self.config.min_span {
            state.counters.short += 1;
            return 0;
        }
        if keeps_bound(span.ends[0][2], span.ends[1][2], f64::from(span.last()), e) {
            state.counters.free += 1;
            return decision - 1;
        }
        state.counters.step_divisions += 1;
        state.equation = Some(StepEquation::new(span.step[2], e, self.config.step_bits));
        decision - 1 + iterations
    }

    /// Runs step 444: returns the next division point behind `from`, and the cycles of the search.
    fn next_point(&mut self, span: &ScanSpan, from: u16) -> (u16, u64) {
        let Some(equation) = self.state.equation else { return (span.last(), 1) };
        let products = self.operators.latency(if from == 0 { FIRST_STEP } else { NEXT_STEP });
        let wl = span.value(from)[2];
        if equation.is_free(wl) {
            return (span.last(), products);
        }
        self.state.counters.roots += 1;
        let bits = self.config.step_bits;
        let root = |x: f64| down(self.table.as_ref().map_or_else(|| x.sqrt(), |t| t.root(x)), bits);
        let reach = equation.reach(wl, self.config.step_form, root);
        let rest = span.last() - from;
        let step = match reach {
            StepReach::End => rest,
            // The conversion saturates.
            StepReach::Pixels(t) => (t as u16).max(1).min(rest),
        };
        (from + step, products + self.root())
    }

    /// Returns the end of the segment that begins at `from`, and the cycles of the search.
    fn end_of(&mut self, span: &ScanSpan, from: u16) -> (u16, u64) {
        let last = span.last();
        if !span.textured {
            return (last, 1);
        }
        match self.config.method {
            Method::Adaptive => self.next_point(span, from),
            Method::Exact => (from + span.in_cell(from) - 1, 1),
            Method::Subpolygon => (self.state.subdivision.last_with(span, from), 1),
            Method::Fixed if self.config.points == 0 => {
                (u32::from(from).saturating_add(self.config.interval).min(u32::from(last)) as u16, 1)
            }
            Method::Fixed => (evenly(last, from, self.config.points), 1),
        }
    }

    /// Returns the next segment of the span, its points, and the cycles of the search.
    fn segment(&mut self) -> Option<(LineSegment, DivisionPoints, u64)> {
        let span = self.state.span?;
        let from = self.state.from;
        let (to, cycles) = self.end_of(&span, from);
        let to = to.min(from.saturating_add(self.config.longest_segment as u16));
        let exact = self.config.method == Method::Exact && span.textured;
        // Child polygons share no pixel. Other segments share their division point.
        let apart = exact || self.config.method == Method::Subpolygon;
        let ends = to == span.last();
        let walk = to - from + u16::from(apart || ends);
        let fresh = from == 0 || apart;
        let point = |k: u16| span.point(k, self.config.coordinate_bits);
        let points: DivisionPoints = match (span.textured, exact, fresh) {
            (false, ..) => DivisionPoints::new(),
            (_, true, _) => (from..=to).map(point).collect(),
            (_, _, false) => smallvec![point(to)],
            _ if from == to => smallvec![point(from)],
            _ => smallvec![point(from), point(to)],
        };
        let segment = LineSegment { span, from, to, walk, exact, fresh };
        self.state.note(&segment, apart);
        self.state.from = if apart { to.saturating_add(1) } else { to };
        if ends {
            self.state.span = None;
        }
        Some((segment, points, cycles))
    }
}

/// Returns the next of `points` division points that divide 0 ..= last evenly.
fn evenly(last: u16, from: u16, points: u32) -> u16 {
    let parts = u64::from(points) + 1;
    let place = |i: u64| ((2 * i * u64::from(last) + parts) / (2 * parts)) as u16;
    // Number of the first point behind `from`, estimated.
    let near = u64::from(from) * parts / u64::from(last.max(1));
    (near..=parts).map(place).find(|&p| p > from).unwrap_or(last)
}

impl Unit for StepCalculator {
    basrelief_kernel::unit_info!("chooses division points by the criterion in its storage element");
    type In = Option<Flow<ScanSpan>>;
    type Out = (Option<Flow<LineSegment>>, Option<Flow<DivisionPoints>>);

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.span.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = self.latency();
        if self.state.storage.selected == 0 {
            self.state.storage.select(self.config.error_bound);
        }
        let beginning = match input {
            Some(Flow::Control(control)) => {
                self.take(&control);
                return Step::after(latency, (Some(Flow::Control(control.clone())), Some(Flow::Control(control))));
            }
            Some(Flow::Item(span)) => self.begin(span),
            None => 0,
        };
        let Some((segment, points, cycles)) = self.segment() else { return Step::after(latency, (None, None)) };
        let cycles = beginning + cycles;
        let out = (Some(Flow::Item(segment)), Some(Flow::Item(points)));
        Step::during(cycles, latency, out)
    }

    fn is_empty(&self) -> bool {
        self.state.span.is_none()
    }

    fn twin_tables(&self) -> Vec<UnitTable> {
        let numbers = [
            ("latency", self.latency()),
            ("decision", self.decision()),
            ("quotient", self.iterations()),
            ("root", self.root()),
            ("first", self.operators.latency(FIRST_STEP)),
            ("next", self.operators.latency(NEXT_STEP)),
            ("criterion", self.config.error_bound.to_bits()),
        ];
        numbers.into_iter().map(|(name, value)| UnitTable::number(name, value)).collect()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let turn = if self.config.method == Method::Adaptive { self.operators.latency(NEXT_STEP) + self.root() } else { 1 };
        for output in 0..2 {
            stats.rate(output, self.latency() + turn - 1, turn);
        }
        self.tell_hardware(stats);
        let c = &self.state.counters;
        let (roots, look_ups) = if self.table.is_some() { (0, c.roots) } else { (c.roots, 0) };
        let bins = c.lengths.iter().rposition(|n| *n > 0).map_or(0, |i| i + 1).min(BINS);
        stats.figure("textured_fragments", c.textured_pixels, "pixels", "Pixels of spans with a texture");
        stats.figure("spans", c.spans, "spans", "Spans with a texture");
        stats.figure("spans_untextured", c.untextured, "spans", "Spans without");
        stats.figure("spans_of_one_pixel", c.single, "spans", "Spans of one pixel");
        stats.figure("spans_not_subdivided", c.short, "spans", "Spans too short to be subdivided");
        stats.figure("spans_without_division", c.free, "spans", "Spans that products decided to need no division point");
        stats.figure("segments", c.segments, "segments", "Segments between division points");
        stats.figure(
            "segment_lengths_up_to",
            (0..bins).map(|i| 1_u64 << i).collect::<Vec<_>>(),
            "pixels",
            "Longest segments of each class of `segment_lengths`",
        );
        stats.figure("segment_lengths", c.lengths[..bins].to_vec(), "segments", "Segments of each class of lengths");
        stats.figure("segment_longest", c.longest, "pixels", "The longest segment");
        stats.figure("division_points", c.division_points, "points", "Division points");
        stats.figure("square_roots", roots, "roots", "Square roots calculated");
        stats.figure("step_table_look_ups", look_ups, "look-ups", "Square roots looked up in their place");
        stats.figure("step_divisions", c.step_divisions, "divisions", "Divisions e / |dw| of the step calculator");
        let bound = if self.state.storage.selected > 0 { self.state.storage.largest } else { self.config.error_bound };
        stats.figure(
            "displacement_bound",
            bound,
            "pixels",
            "Largest displacement that the criterion allows, of all that were selected",
        );
        if let Some(table) = &self.table {
            stats.figure("step_table_largest_error", table.largest_error(), "", "Largest relative error of the table of roots");
        }
    }
}
