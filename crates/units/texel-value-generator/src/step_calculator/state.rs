//! Everything the step calculator remembers.

use super::{StepEquation, Subdivision};
use crate::log::SpanRecord;
use crate::signals::{Segment, Span};
use crate::storage_element::StorageElement;
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Bins of the histogram of segment lengths: 1, 2, 3..4, 5..8, and so on to 8193..16384 pixels.
pub const BINS: usize = 15;

/// The bin of a length \[pixels\].
#[inline]
pub fn bin_of(length: u16) -> usize {
    (u16::BITS - length.saturating_sub(1).leading_zeros()) as usize
}

/// What the step calculator has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepCalculatorCounters {
    /// Spans.
    pub spans: u64,
    /// Pixels of these.
    pub pixels: u64,
    /// Pixels of spans with a texture.
    pub textured_pixels: u64,
    /// Spans of one pixel: their ends are one.
    pub single: u64,
    /// Spans that were too short to be subdivided (step 430).
    pub short: u64,
    /// Spans of which two products said that the bound holds to their end.
    pub free: u64,
    /// Spans without a texture.
    pub untextured: u64,
    /// Segments.
    pub segments: u64,
    /// Division points between the ends of spans.
    pub division_points: u64,
    /// Square roots, or look-ups in their place.
    pub roots: u64,
    /// Divisions e / |dw|, one for each span that is subdivided.
    pub step_divisions: u64,
    /// Segments by the pixels that they generate; see [`BINS`].
    pub lengths: [u64; BINS],
    /// Pixels of the longest.
    pub longest: u64,
}

/// Everything the step calculator remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepCalculatorState {
    /// The accuracy criterion.
    pub storage: StorageElement,
    /// The polygon of the spans.
    pub polygon: Option<Arc<Polygon>>,
    /// Its child polygons.
    pub subdivision: Subdivision,
    /// The span that is subdivided.
    pub span: Option<Span>,
    /// Its current division point.
    pub from: u16,
    /// The equation of its steps; none where it is not subdivided by it.
    pub equation: Option<StepEquation>,
    /// What it has counted.
    pub counters: StepCalculatorCounters,
    /// Spans of the frame, where somebody asked.
    pub log: Option<Vec<SpanRecord>>,
    /// Those of frames that are complete and that nobody has fetched.
    pub finished: Vec<Vec<SpanRecord>>,
}

impl StepCalculatorState {
    /// Counts and records a segment: pixels `from` to `to` of the span; each of them (`exact`), both ends (`apart`: nothing is
    /// shared with the segment in front) or the farther end is a new division point.
    pub(super) fn note(&mut self, segment: &Segment, apart: bool) {
        let Segment { span, from, to, walk, exact, .. } = segment;
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
    fn lengths_fall_into_powers_of_two() {
        assert_eq!([1, 2, 3, 4, 5, 8, 9, 4096, 8193, 16384].map(bin_of), [0, 1, 2, 2, 3, 3, 4, 12, 14, 14]);
    }
}
