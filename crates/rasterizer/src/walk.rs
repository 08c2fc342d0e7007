//! Traversal of a triangle: row of blocks by row of blocks, block by block, row by row; only covered pixels.
//!
//! Rows of blocks hold the analytic span of each of their rows. Testing every pixel of every touched block instead
//! was rejected: a triangle of fifteen pixels touches five blocks, that is five tests per fragment.

use crate::config::MAX_BLOCK;
use crate::triangle::Triangle;
use basrelief_signals::Fragment;
use serde::{Deserialize, Serialize};

/// Where the traversal of a triangle is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Walk {
    /// The triangle.
    pub triangle: Triangle,
    /// Side of a block \[pixels\], 1..=[`MAX_BLOCK`].
    block: i32,
    /// First row of the current row of blocks.
    top: i32,
    /// Spans of the rows of the current row of blocks.
    spans: [[i32; 2]; MAX_BLOCK],
    /// First column of the current block.
    left: i32,
    /// Column behind the last of the current row of blocks.
    right: i32,
    /// Row within the block to look at next.
    next_row: i32,
    /// Current pixel.
    x: i32,
    /// Current pixel.
    y: i32,
    /// Column behind the last of the current row of the current block.
    end: i32,
}

impl Walk {
    /// In front of the first pixel.
    pub fn new(triangle: Triangle, block: u32) -> Self {
        let block = block.clamp(1, MAX_BLOCK as u32) as i32;
        let top = triangle.bounds.y[0] / block * block - block;
        Self { triangle, block, top, next_row: block, ..Self::default() }
    }

    /// Column and row of the current pixel.
    #[inline]
    pub fn pixel(&self) -> [i32; 2] {
        [self.x, self.y]
    }

    /// Fragment of the current pixel.
    #[inline]
    pub fn fragment(&self) -> Fragment {
        self.triangle.fragment(self.x, self.y)
    }

    /// On to the next covered pixel; false where there is none.
    #[inline]
    pub fn advance(&mut self) -> bool {
        self.x += 1;
        self.x < self.end || self.next_run()
    }

    /// On to the next row that has pixels in its block.
    fn next_run(&mut self) -> bool {
        loop {
            for (row, &[first, end]) in
                self.spans.iter().enumerate().take(self.block as usize).skip(self.next_row as usize)
            {
                self.x = first.max(self.left);
                self.end = end.min(self.left + self.block);
                if self.x < self.end {
                    self.y = self.top + row as i32;
                    self.next_row = row as i32 + 1;
                    return true;
                }
            }
            self.next_row = 0;
            self.left += self.block;
            if self.left >= self.right && !self.next_row_of_blocks() {
                return false;
            }
        }
    }

    fn next_row_of_blocks(&mut self) -> bool {
        let [first_row, end_row] = self.triangle.bounds.y;
        loop {
            self.top += self.block;
            if self.top >= end_row {
                return false;
            }
            let (mut first, mut last) = (i32::MAX, 0);
            for (y, span) in (self.top..).zip(self.spans.iter_mut().take(self.block as usize)) {
                *span = if (first_row..end_row).contains(&y) { self.triangle.span(y) } else { [0, 0] };
                if span[0] < span[1] {
                    first = first.min(span[0]);
                    last = last.max(span[1]);
                }
            }
            if first < last {
                self.left = first / self.block * self.block;
                self.right = last;
                return true;
            }
        }
    }
}
