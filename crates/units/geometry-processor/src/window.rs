//! Projection from clip space to the window.

use crate::transform::ClipCorner;
use basrelief_kernel::OperatorCounts;
use basrelief_signals::Frame;

/// Projection of the view volume to the window.
pub(crate) struct WindowTransform {
    /// Half width and height \[pixels\].
    half: [f32; 2],
}

impl WindowTransform {
    /// Arithmetic of a corner: reciprocal of w, three products with it, three more and three sums for the position.
    pub(crate) const PLACE: OperatorCounts = OperatorCounts { multiply: 6, add: 3, divide: 1, ..OperatorCounts::NONE };
    /// Longest dependent chain of the projection.
    pub(crate) const PLACE_CHAIN: OperatorCounts = OperatorCounts { multiply: 2, add: 1, divide: 1, ..OperatorCounts::NONE };

    pub(crate) fn new(frame: &Frame) -> Self {
        Self { half: [0.5 * frame.width as f32, 0.5 * frame.height as f32] }
    }

    /// Returns the window coordinates of a corner in front of the viewer.
    #[inline]
    pub(crate) fn place(&self, corner: &ClipCorner) -> [f32; 4] {
        let inverse_w = 1.0 / corner.clip.w;
        let [x, y, z] = (corner.clip.truncate() * inverse_w).to_array();
        [self.half[0] + self.half[0] * x, self.half[1] - self.half[1] * y, 0.5 + 0.5 * z, inverse_w]
    }
}
