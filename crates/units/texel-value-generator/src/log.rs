//! What can be told of a frame beside its picture, where somebody asks: spans with their division points, and how far each
//! pixel's texel is from its place.

use crate::signals::Span;
use serde::{Deserialize, Serialize};

/// A span with its division points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpanRecord {
    /// Row.
    pub y: u16,
    /// First and last column.
    pub x: [u16; 2],
    /// W there: |1 / w| of clip space.
    pub w: [f64; 2],
    /// Columns of the division points between the ends, in the order of marching.
    pub divisions: Vec<u16>,
}

impl SpanRecord {
    /// A span without division points between its ends.
    pub fn new(span: &Span) -> Self {
        let x = [span.column(0), span.column(span.last())];
        let w = [span.ends[0][2], span.ends[1][2]];
        let turned = |backwards: bool| if backwards { ([x[1], x[0]], [w[1], w[0]]) } else { (x, w) };
        let (x, w) = turned(span.backwards);
        Self { y: span.y, x, w, divisions: Vec::new() }
    }
}

/// How far the texel of each visible pixel is from its place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplacementMap {
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// Displacement by pixel, top row first \[pixels\]; NaN where no texture was drawn.
    pub displacement: Vec<f32>,
    /// Whether the pixel's coordinates were divided: an end of a span or a division point.
    pub divided: Vec<bool>,
}

impl DisplacementMap {
    /// A map on which nothing is drawn.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self { width, height, displacement: vec![f32::NAN; pixels], divided: vec![false; pixels] }
    }

    /// Notes a pixel; outside the map, nothing.
    pub fn note(&mut self, x: u16, y: u16, displacement: f32, divided: bool) {
        let place = usize::from(y) * self.width as usize + usize::from(x);
        if u32::from(x) < self.width && u32::from(y) < self.height {
            self.displacement[place] = displacement;
            self.divided[place] = divided;
        }
    }
}

/// What is told of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameLog {
    /// All spans with a texture, in the order in which they were drawn, hidden ones too.
    pub spans: Vec<SpanRecord>,
    /// Of the pixels that are seen.
    pub map: DisplacementMap,
}
