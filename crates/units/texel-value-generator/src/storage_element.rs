//! Storage element for the accuracy criterion.

use serde::{Deserialize, Serialize};

/// Storage element (claims 6 and 8): the register that holds the selected accuracy criterion e. A criterion selected in step 442
/// applies to all scan lines until another is selected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StorageElement {
    error_bound: f64,
    /// Largest criterion selected \[pixels\].
    pub largest: f64,
    /// Number of selections.
    pub selected: u64,
}

impl StorageElement {
    /// Selects e \[pixels\], > 0, in step 442.
    pub fn select(&mut self, error_bound: f64) {
        self.error_bound = error_bound;
        self.largest = self.largest.max(error_bound);
        self.selected += 1;
    }

    /// Returns the selected e \[pixels\].
    #[inline]
    pub fn criterion(&self) -> f64 {
        self.error_bound
    }
}
