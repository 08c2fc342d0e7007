//! Traversal of the covered pixels of a triangle: row of blocks by row of blocks, block by block, row by row. In traversal by
//! columns, rows and columns are exchanged, here and in all names below.
//!
//! A row of blocks starts with the analytic span of each of its rows. A block is then a mask of covered pixels, taken bit by bit.
//! Testing every pixel of every touched block was rejected: a triangle of fifteen pixels touches five blocks, which gives five
//! tests per fragment. Walking the spans without a mask was also rejected: its branch at the end of every four pixels cannot be
//! predicted.

use super::{MAX_BLOCK, RasterGrid, RasterTriangle};
use basrelief_signals::Fragment;
use serde::{Deserialize, Serialize};

/// Bits of the mask per row of a block.
const ROW: u32 = MAX_BLOCK as u32;

/// Traversal of a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TriangleWalk {
    /// Triangle being traversed.
    pub triangle: RasterTriangle,
    /// Side of a block \[pixels\], 1..=[`MAX_BLOCK`].
    block: i32,
    /// True if rows and columns are exchanged.
    columns: bool,
    /// First row of the current row of blocks.
    top: i32,
    /// Spans of the rows of the current row of blocks.
    spans: [[i32; 2]; MAX_BLOCK],
    /// First column of the current block.
    left: i32,
    /// Column behind the last of the current row of blocks.
    right: i32,
    /// Covered pixels of the current block that are not done. The current pixel is the lowest bit; bit 8 * row + column.
    mask: u64,
}

impl TriangleWalk {
    /// Creates a traversal that stands in front of the first pixel.
    #[inline]
    pub fn new(triangle: RasterTriangle, raster: RasterGrid) -> Self {
        let (block, columns) = (raster.block.clamp(1, ROW) as i32, raster.columns);
        let first = if columns { triangle.bounds.x[0] } else { triangle.bounds.y[0] };
        Self { triangle, block, columns, top: first / block * block - block, ..Self::default() }
    }

    /// Returns column and row of the current pixel.
    #[inline]
    pub fn pixel(&self) -> [i32; 2] {
        let bit = self.mask.trailing_zeros();
        let (column, row) = (self.left + (bit % ROW) as i32, self.top + (bit / ROW) as i32);
        if self.columns { [row, column] } else { [column, row] }
    }

    /// Returns the fragment of the current pixel.
    #[inline]
    pub fn fragment(&self) -> Fragment {
        let [x, y] = self.pixel();
        self.triangle.fragment(x, y)
    }

    /// Returns the fragment of the current pixel, with weights that are linear on the screen.
    #[inline]
    pub fn linear_fragment(&self) -> Fragment {
        let [x, y] = self.pixel();
        self.triangle.linear_fragment(x, y)
    }

    /// Advances to the next covered pixel. Returns false if none is left.
    #[inline]
    pub fn advance(&mut self) -> bool {
        self.mask &= self.mask.wrapping_sub(1);
        self.mask != 0 || self.next_block()
    }

    /// Advances to the next block that has pixels.
    fn next_block(&mut self) -> bool {
        loop {
            self.left += self.block;
            if self.left >= self.right && !self.next_row_of_blocks() {
                return false;
            }
            self.mask = self.covered();
            if self.mask != 0 {
                return true;
            }
        }
    }

    /// Returns the coverage mask of the current block.
    #[inline]
    fn covered(&self) -> u64 {
        let below = |column: i32| (1u64 << (column - self.left).clamp(0, self.block)) - 1;
        let rows = &self.spans[..self.block as usize];
        rows.iter().rev().fold(0, |mask, &[first, end]| mask << ROW | below(end) & !below(first))
    }

    fn next_row_of_blocks(&mut self) -> bool {
        let bounds = &self.triangle.bounds;
        let end = if self.columns { bounds.x[1] } else { bounds.y[1] };
        loop {
            self.top += self.block;
            if self.top >= end {
                return false;
            }
            self.triangle.spans_across(self.columns.into(), self.top, self.block, &mut self.spans);
            let covered = self.spans.iter().filter(|[first, end]| first < end);
            let (first, end) = covered.fold((i32::MAX, 0), |(f, e), s| (f.min(s[0]), e.max(s[1])));
            if first < end {
                self.left = first / self.block * self.block;
                self.right = end;
                return true;
            }
        }
    }
}
