//! State of the step calculator between steps.

use super::{ChildSubdivision, StepEquation};
use crate::log::SpanRecord;
use crate::signals::{LineSegment, ScanSpan};
use crate::storage_element::StorageElement;
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Bins of the histogram of segment lengths: 1, 2, 3..4, 5..8, and so on to 8193..16384 pixels.
pub const BINS: usize = 15;

/// Returns the bin of a length \[pixels\].
#[inline]
pub fn bin_of(length: u16) -> usize {
    (u16::BITS - length.saturating_sub(1).leading_zeros()) as usize
}

/// Counters of the step calculator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepCalculatorCounters {
    /// Spans received.
    pub spans: u64,
    /// Pixels of the spans.
    pub pixels: u64,
    /// Pixels of spans with a texture.
    pub textured_pixels: u64,
    /// Spans of one pixel, whose ends are the same.
    pub single: u64,
    /// Spans too short to be subdivided (step 430).
    pub short: u64,
    /// Spans for which the decision found that the bound holds to the end.
    pub free: u64,
    /// Spans without a texture.
    pub untextured: u64,
    /// Segments sent.
    pub segments: u64,
    /// Division points between the ends of spans.
    pub division_points: u64,
    /// Square roots, or look-ups that replace them.
    pub roots: u64,
    /// Divisions e / |dw|, one for each subdivided span.
    pub step_divisions: u64,
    /// Segments by the number of their pixels. See [`BINS`].
    pub lengths: [u64; BINS],
    /// Pixels of the longest segment.
    pub longest: u64,
}

/// State of the step calculator between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepCalculatorState {
    /// Storage element with the accuracy criterion.
    pub storage: StorageElement,
    /// Polygon of the spans.
    pub polygon: Option<Arc<Polygon>>,
    /// Child polygons of the polygon.
    pub subdivision: ChildSubdivision,
    /// Span being subdivided.
    pub span: Option<ScanSpan>,
    /// Current division point of the span.
    pub from: u16,
    /// Equation of the steps. `None` if the span is not subdivided by it.
    pub equation: Option<StepEquation>,
    /// Counters.
    pub counters: StepCalculatorCounters,
    /// Spans of the frame, if requested.
    pub log: Option<Vec<SpanRecord>>,
    /// Spans of complete frames, not fetched yet.
    pub finished: Vec<Vec<SpanRecord>>,
}

impl StepCalculatorState {
    /// Counts and records a segment: pixels `from` to `to` of the span. New division points are all pixels (`exact`), both ends
    /// (`apart`: no point shared with the previous segment) or the farther end.
    pub(super) fn note(&mut self, segment: &LineSegment, apart: bool) {
        let LineSegment { span, from, to, walk, exact, .. } = segment;
        let counters = &mut self.counters;
        counters.textured_pixels += if span.textured { u64::from(*walk) } else { 0 };
        let (segments, length) = if *exact { (u64::from(*walk), 1) } else { (1, *walk) };
        counters.segments += segments;
        counters.lengths[bin_of(length).min(BINS - 1)] += segments;
        counters.longest = counters.longest.max(u64::from(length));
        if !span.textured {
            return;
        }
        let first = if apart { *from } else { *to };
        let stride = if *exact { 1 } else { (to - first).max(1) };
        let points = (first..=*to).step_by(usize::from(stride)).filter(|&k| k > 0 && k < span.last());
        match self.log.as_mut().and_then(|log| log.last_mut()) {
            None => counters.division_points += points.count() as u64,
            Some(record) => {
                let known = record.divisions.len();
                record.divisions.extend(points.map(|k| span.column(k)));
                counters.division_points += (record.divisions.len() - known) as u64;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_fall_into_power_of_two_bins() {
        assert_eq!([1, 2, 3, 4, 5, 8, 9, 4096, 8193, 16384].map(bin_of), [0, 1, 2, 2, 3, 3, 4, 12, 14, 14]);
    }
}
