//! Visibility, then shading, of batches of triangles; by bands of rows.

use crate::Picture;
use crate::raster::{Corner, Triangle};
use crate::surface::Surface;
use std::ops::Range;

/// Triangles held before they are drawn: bounds the memory of a stream (some 6 MB) and lets most hidden pixels go
/// unshaded. Drawing each triangle at once was rejected: it shades what is covered later.
const BATCH: usize = 8192;

/// No triangle of this batch.
const NOTHING: u32 = u32::MAX;

/// A picture being drawn.
#[derive(Clone, Debug)]
pub(crate) struct Renderer {
    picture: Picture,
    depth: Vec<f64>,
    visible: Vec<u32>,
    surfaces: Vec<Surface>,
    pending: Vec<Pending>,
}

#[derive(Clone, Debug)]
struct Pending {
    triangle: Triangle,
    surface: usize,
    back: bool,
}

impl Renderer {
    pub fn new(width: u32, height: u32) -> Self {
        let picture = Picture::new(width, height);
        let pixels = picture.rgb.len();
        Self { picture, depth: vec![1.0; pixels], visible: vec![NOTHING; pixels], surfaces: Vec::new(), pending: Vec::new() }
    }

    /// The triangles that follow have this surface.
    pub fn surface(&mut self, surface: Surface) {
        let unused = self.pending.last().is_none_or(|last| last.surface + 1 < self.surfaces.len());
        if unused {
            self.surfaces.pop();
        }
        self.surfaces.push(surface);
    }

    /// Draws a triangle of the surface set last. `mirrored`: the winding of front faces is clockwise on the screen;
    /// `cull`: back faces are left out.
    pub fn triangle(&mut self, corners: [Corner; 3], mirrored: bool, cull: bool) {
        let Some(triangle) = Triangle::new(corners) else { return };
        let back = triangle.counter_clockwise == mirrored;
        let Some(surface) = self.surfaces.len().checked_sub(1) else { return };
        if back && cull {
            return;
        }
        self.pending.push(Pending { triangle, surface, back });
        if self.pending.len() >= BATCH {
            self.resolve();
        }
    }

    /// The picture.
    pub fn finish(mut self) -> Picture {
        self.resolve();
        self.picture
    }

    fn resolve(&mut self) {
        let width = self.picture.width as usize;
        let rows = rows_per_band(self.picture.height as usize);
        let chunk = (width * rows).max(1);
        let bands = self
            .picture
            .rgb
            .chunks_mut(chunk)
            .zip(self.picture.covered.chunks_mut(chunk))
            .zip(self.depth.chunks_mut(chunk).zip(self.visible.chunks_mut(chunk)))
            .enumerate()
            .map(|(i, ((rgb, covered), (depth, visible)))| {
                let height = rgb.len() / width.max(1);
                Band { width, rows: i * rows..i * rows + height, rgb, covered, depth, visible }
            });
        let (pending, surfaces) = (&self.pending, &self.surfaces);
        for_each(bands, |mut band| band.draw(pending, surfaces));
        self.pending.clear();
        self.surfaces.drain(..self.surfaces.len().saturating_sub(1));
    }
}

/// A band of rows of the picture and its buffers.
struct Band<'a> {
    width: usize,
    rows: Range<usize>,
    rgb: &'a mut [[u8; 3]],
    covered: &'a mut [bool],
    depth: &'a mut [f64],
    visible: &'a mut [u32],
}

impl Band<'_> {
    fn draw(&mut self, pending: &[Pending], surfaces: &[Surface]) {
        for (number, entry) in (0..).zip(pending) {
            self.cover(number, &entry.triangle);
        }
        for row in self.rows.clone() {
            for column in 0..self.width {
                self.shade(column, row, pending, surfaces);
            }
        }
    }

    fn cover(&mut self, number: u32, triangle: &Triangle) {
        let (width, start) = (self.width, self.rows.start);
        triangle.spans(width, &self.rows, |row, columns| {
            for column in columns {
                let at = (row - start) * width + column;
                let depth = triangle.depth(column, row);
                if depth < self.depth[at] {
                    self.depth[at] = depth;
                    self.visible[at] = number;
                }
            }
        });
    }

    fn shade(&mut self, column: usize, row: usize, pending: &[Pending], surfaces: &[Surface]) {
        let at = (row - self.rows.start) * self.width + column;
        let number = std::mem::replace(&mut self.visible[at], NOTHING);
        if let Some(entry) = pending.get(number as usize) {
            let point = entry.triangle.point(column, row, entry.back);
            self.rgb[at] = surfaces[entry.surface].shade(&point);
            self.covered[at] = true;
        }
    }
}

#[cfg(feature = "threads")]
fn rows_per_band(height: usize) -> usize {
    height.div_ceil(std::thread::available_parallelism().map_or(1, usize::from)).max(1)
}

#[cfg(not(feature = "threads"))]
fn rows_per_band(height: usize) -> usize {
    height.max(1)
}

/// Bands share nothing that is written, so the order in which they are drawn cannot show.
#[cfg(feature = "threads")]
fn for_each<'a>(bands: impl Iterator<Item = Band<'a>>, draw: impl Fn(Band<'a>) + Sync) {
    let draw = &draw;
    std::thread::scope(|scope| {
        for band in bands {
            scope.spawn(move || draw(band));
        }
    });
}

#[cfg(not(feature = "threads"))]
fn for_each<'a>(bands: impl Iterator<Item = Band<'a>>, draw: impl Fn(Band<'a>)) {
    bands.for_each(draw);
}
