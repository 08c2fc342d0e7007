//! Optional log of a frame besides its picture: spans with their division points, and the displacement of each pixel's texel.

use crate::signals::ScanSpan;
use serde::{Deserialize, Serialize};

/// A span with its division points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpanRecord {
    /// Row.
    pub y: u16,
    /// First and last column.
    pub x: [u16; 2],
    /// W at the first and last column: |1 / w| of clip space.
    pub w: [f64; 2],
    /// Columns of the division points between the ends, in the order of marching.
    pub divisions: Vec<u16>,
}

impl SpanRecord {
    /// Creates a span without division points between its ends.
    pub fn new(span: &ScanSpan) -> Self {
        let x = [span.column(0), span.column(span.last())];
        let w = [span.ends[0][2], span.ends[1][2]];
        let turned = |backwards: bool| if backwards { ([x[1], x[0]], [w[1], w[0]]) } else { (x, w) };
        let (x, w) = turned(span.backwards);
        Self { y: span.y, x, w, divisions: Vec::new() }
    }
}

/// Displacement of the texel of each visible pixel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplacementMap {
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// Displacement by pixel, top row first \[pixels\]. NaN for pixels without a texture.
    pub displacement: Vec<f32>,
    /// True if the pixel's coordinates were divided: an end of a span or a division point.
    pub divided: Vec<bool>,
}

impl DisplacementMap {
    /// Creates an empty map.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self { width, height, displacement: vec![f32::NAN; pixels], divided: vec![false; pixels] }
    }

    /// Records a pixel. Pixels outside the map are ignored.
    pub fn note(&mut self, x: u16, y: u16, displacement: f32, divided: bool) {
        let place = usize::from(y) * self.width as usize + usize::from(x);
        if u32::from(x) < self.width && u32::from(y) < self.height {
            self.displacement[place] = displacement;
            self.divided[place] = divided;
        }
    }
}

/// Log of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameLog {
    /// All spans with a texture in drawing order, including hidden ones.
    pub spans: Vec<SpanRecord>,
    /// Displacements of visible pixels.
    pub map: DisplacementMap,
}
