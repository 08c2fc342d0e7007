//! First pass: scans the triangles, and passes the visible fragments on in columns.

use super::block::{Canvas, LaneSteps};
use super::columns::{BATCH, Columns};
use super::drawing::Drawing;
use super::lanes::LANES;
use super::search::NormalGrid;
use super::shade::Shading;
use super::triangle::{Triangle, triangles};
use pulp::NullaryFnOnce;
use pulp::x86::V3;

/// The drawing of a picture.
pub(crate) struct Drawer<'a> {
    simd: V3,
    drawing: &'a Drawing,
    canvas: Canvas,
    grids: Vec<NormalGrid>,
    /// Fragments by the finer of their levels.
    levels: Vec<Columns>,
    fragments: u64,
}

impl<'a> Drawer<'a> {
    pub(crate) fn new(simd: V3, drawing: &'a Drawing) -> Self {
        let grids: Vec<NormalGrid> = drawing.normals.iter().map(|normals| NormalGrid::new(normals)).collect();
        let levels = grids.iter().map(|_| Columns::new()).collect();
        Self { simd, drawing, canvas: Canvas::new(drawing.size[0] * drawing.size[1]), grids, levels, fragments: 0 }
    }

    #[inline(always)]
    fn scan(&mut self, triangle: &Triangle) {
        let steps = LaneSteps::new(self.simd, triangle);
        let [first, end] = triangle.columns;
        for y in triangle.rows[0]..triangle.rows[1] {
            for x in (first..end).step_by(LANES) {
                self.draw_block(triangle, &steps, [x, y]);
            }
        }
    }

    /// Draws the eight pixels from this one on.
    #[inline(always)]
    fn draw_block(&mut self, triangle: &Triangle, steps: &LaneSteps, pixel: [i64; 2]) {
        let covered = steps.covered(self.simd, triangle, pixel);
        if covered == 0 {
            return;
        }
        self.fragments += u64::from(covered.count_ones());
        let place = pixel[1] as usize * self.drawing.size[0] + pixel[0] as usize;
        let block = steps.block(self.simd, triangle, pixel, covered, place, &mut self.canvas);
        let columns = &mut self.levels[triangle.level];
        columns.push(self.simd, triangle, &block);
        if columns.count > BATCH {
            let whole = columns.count / LANES * LANES;
            self.shade(triangle.level, whole);
        }
    }

    /// Shades the first fragments of a level.
    #[inline(always)]
    fn shade(&mut self, level: usize, count: usize) {
        let Self { simd, drawing, canvas, grids, levels, .. } = self;
        simd.vectorize(Shading { simd: *simd, drawing, level, columns: &mut levels[level], count, grids, canvas });
    }
}

impl NullaryFnOnce for Drawer<'_> {
    /// The picture, and the number of fragments.
    type Output = (Vec<[u8; 3]>, u64);

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        let mut number = 0;
        for polygon in &self.drawing.polygons {
            for triangle in triangles(polygon, self.drawing.size, number) {
                self.scan(&triangle);
            }
            number += polygon.vertices.len() as u32;
        }
        for level in 0..self.levels.len() {
            self.shade(level, self.levels[level].count);
        }
        (self.canvas.rgb, self.fragments)
    }
}
