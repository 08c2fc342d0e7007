//! Storage element for the accuracy criterion.

use serde::{Deserialize, Serialize};

/// Storage element (claims 6 and 8): the register that holds the selected accuracy criterion e. What is selected in step 442
/// holds for all scan lines until another is selected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StorageElement {
    error_bound: f64,
    /// The largest that was selected \[pixels\].
    pub largest: f64,
    /// Times that a criterion was selected.
    pub selected: u64,
}

impl StorageElement {
    /// Step 442: selects e \[pixels\], > 0.
    pub fn select(&mut self, error_bound: f64) {
        self.error_bound = error_bound;
        self.largest = self.largest.max(error_bound);
        self.selected += 1;
    }

    /// The selected e \[pixels\].
    #[inline]
    pub fn criterion(&self) -> f64 {
        self.error_bound
    }
}
