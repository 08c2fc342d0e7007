//! Visibility, then shading, of batches of triangles, by bands of rows.

use crate::RgbPicture;
use crate::raster::{CoveredTriangle, WindowCorner};
use crate::surface::{LitSurface, PixelAttributes};
use basrelief_threads as threads;
use glam::DVec3;
use std::ops::Range;

/// Triangles held before they are drawn. This bounds the memory of a stream (some 6 MB) and leaves most hidden pixels unshaded.
/// Drawing each triangle at once was rejected, because it shades pixels that are covered later.
const BATCH: usize = 8192;

/// Number that means no triangle of this batch.
const NOTHING: u32 = u32::MAX;

/// A picture being drawn.
#[derive(Clone, Debug)]
pub(crate) struct BatchRenderer {
    picture: RgbPicture,
    depth: Vec<f64>,
    visible: Vec<u32>,
    /// Pixels that show the back of a surface.
    backs: Vec<bool>,
    surfaces: Vec<LitSurface>,
    pending: Vec<PendingPixel>,
}

#[derive(Clone, Debug)]
struct PendingPixel {
    triangle: CoveredTriangle,
    surface: usize,
    back: bool,
}

impl BatchRenderer {
    pub fn new(width: u32, height: u32) -> Self {
        let picture = RgbPicture::new(width, height);
        let pixels = picture.rgb.len();
        let (surfaces, pending) = Default::default();
        Self { picture, depth: vec![1.0; pixels], visible: vec![NOTHING; pixels], backs: vec![false; pixels], surfaces, pending }
    }

    /// Sets the surface of the following triangles.
    pub fn surface(&mut self, surface: LitSurface) {
        let unused = self.pending.last().is_none_or(|last| last.surface + 1 < self.surfaces.len());
        if unused {
            self.surfaces.pop();
        }
        self.surfaces.push(surface);
    }

    /// Lights the vertices of a polygon of the current surface, as [`LitSurface::light`].
    pub fn light<V: AsMut<PixelAttributes>>(&self, vertices: &mut [V], face: impl FnOnce(&[V]) -> DVec3, back: bool) {
        if let Some(surface) = self.surfaces.last() {
            surface.light(vertices, face, back);
        }
    }

    /// Draws a triangle of the current surface. `mirrored`: the winding of front faces is clockwise on the screen. `cull`: back
    /// faces are left out.
    pub fn triangle(&mut self, corners: [WindowCorner; 3], mirrored: bool, cull: bool) {
        let Some(triangle) = CoveredTriangle::new(corners) else { return };
        let back = triangle.counter_clockwise == mirrored;
        let Some(surface) = self.surfaces.len().checked_sub(1) else { return };
        if back && cull {
            return;
        }
        self.pending.push(PendingPixel { triangle, surface, back });
        if self.pending.len() >= BATCH {
            self.resolve(self.rows_per_band());
        }
    }

    /// Returns the picture.
    pub fn finish(self) -> RgbPicture {
        self.finish_with_depth().0
    }

    /// Returns the picture, and the depth of its pixels.
    pub fn finish_with_depth(mut self) -> (RgbPicture, Vec<f64>) {
        self.resolve(self.rows_per_band());
        self.picture.backs = self.backs.iter().filter(|is_back| **is_back).count();
        (self.picture, self.depth)
    }

    fn rows_per_band(&self) -> usize {
        (self.picture.height as usize).div_ceil(threads::workers()).max(1)
    }

    /// Bands share no written data, so the order in which they are drawn has no effect.
    fn resolve(&mut self, rows: usize) {
        let width = self.picture.width as usize;
        let chunk = (width * rows).max(1);
        let bands = self
            .picture
            .rgb
            .chunks_mut(chunk)
            .zip(self.picture.covered.chunks_mut(chunk))
            .zip(self.depth.chunks_mut(chunk).zip(self.visible.chunks_mut(chunk)))
            .zip(self.backs.chunks_mut(chunk))
            .enumerate()
            .map(|(i, (((rgb, covered), (depth, visible)), backs))| {
                let height = rgb.len() / width.max(1);
                RowBand { width, rows: i * rows..i * rows + height, rgb, covered, depth, visible, backs }
            });
        let (pending, surfaces) = (&self.pending, &self.surfaces);
        threads::par_map(bands.collect(), |mut band| band.draw(pending, surfaces));
        self.pending.clear();
        self.surfaces.drain(..self.surfaces.len().saturating_sub(1));
    }
}

/// A band of rows of the picture and its buffers.
struct RowBand<'a> {
    width: usize,
    rows: Range<usize>,
    rgb: &'a mut [[u8; 3]],
    covered: &'a mut [bool],
    depth: &'a mut [f64],
    visible: &'a mut [u32],
    backs: &'a mut [bool],
}

impl RowBand<'_> {
    fn draw(&mut self, pending: &[PendingPixel], surfaces: &[LitSurface]) {
        for (number, entry) in (0..).zip(pending) {
            self.cover(number, &entry.triangle);
        }
        for row in self.rows.clone() {
            for column in 0..self.width {
                self.shade(column, row, pending, surfaces);
            }
        }
    }

    fn cover(&mut self, number: u32, triangle: &CoveredTriangle) {
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

    fn shade(&mut self, column: usize, row: usize, pending: &[PendingPixel], surfaces: &[LitSurface]) {
        let at = (row - self.rows.start) * self.width + column;
        let number = std::mem::replace(&mut self.visible[at], NOTHING);
        if let Some(entry) = pending.get(number as usize) {
            let point = entry.triangle.point(column, row, entry.back);
            self.rgb[at] = surfaces[entry.surface].shade(&point);
            self.covered[at] = true;
            self.backs[at] = entry.back;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RenderStyle;
    use crate::pyramid::PyramidCache;
    use basrelief_signals::{Frame, Material};
    use glam::DVec2;

    fn corner(x: f64, y: f64, depth: f64) -> WindowCorner {
        let attributes = PixelAttributes { color: DVec3::new(x / 64.0, y / 48.0, depth), ..PixelAttributes::default() };
        WindowCorner { window: DVec2::new(x, y), depth, inverse_w: 1.0 - depth / 2.0, attributes }
    }

    #[test]
    fn band_height_does_not_change_picture() {
        let frame = Frame { width: 64, height: 48, ..Frame::default() };
        let material = Material { base_color: [9.0; 4], ..Material::default() };
        let mut renderer = BatchRenderer::new(64, 48);
        renderer.surface(LitSurface::new(RenderStyle::default(), &frame, &material, [0.0; 3], &mut PyramidCache::default()));
        renderer.triangle([corner(3.0, 2.0, 0.1), corner(60.0, 20.0, 0.9), corner(20.0, 45.0, 0.5)], false, false);
        renderer.triangle([corner(1.0, 40.0, 0.6), corner(63.0, 30.0, 0.2), corner(20.0, 3.0, 0.8)], false, false);
        let pictures = [1, 5, 48, 100].map(|rows| {
            let mut renderer = renderer.clone();
            renderer.resolve(rows);
            renderer.picture
        });
        assert!(pictures[0].covered.iter().filter(|&&c| c).count() > 1000);
        assert!(pictures.iter().all(|picture| *picture == pictures[0]));
    }

    #[test]
    fn hidden_backs_are_not_counted() {
        let frame = Frame { width: 64, height: 48, ..Frame::default() };
        let mut renderer = BatchRenderer::new(64, 48);
        renderer.surface(LitSurface::new(
            RenderStyle::default(),
            &frame,
            &Material::default(),
            [0.0; 3],
            &mut PyramidCache::default(),
        ));
        let triangle = |depth| [corner(3.0, 2.0, depth), corner(60.0, 20.0, depth), corner(20.0, 45.0, depth)];
        renderer.triangle(triangle(0.5), false, false);
        renderer.resolve(48);
        let picture = renderer.clone().finish();
        assert_eq!(picture.backs, picture.covered.iter().filter(|covered| **covered).count());
        let [a, b, c] = triangle(0.1);
        renderer.triangle([a, c, b], false, false);
        assert_eq!(renderer.finish().backs, 0);
    }
}
