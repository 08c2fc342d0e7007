//! Comparison of a finished frame with its reference image, on a background thread.

use super::exact::ExactPicture;
use basrelief_reference::{QualityMetrics, RgbPicture, SizeMismatch};
use basrelief_report::model::Difference;
use basrelief_threads::Deferred;
use sha2::{Digest as _, Sha256};
use std::sync::Arc;

/// A finished frame with its comparison.
pub(crate) struct ComparedFrame {
    pub(crate) index: usize,
    pub(crate) machine: RgbPicture,
    /// SHA-256 of the RGB8 rows, top row first.
    pub(crate) digest: String,
    pub(crate) exact: Option<(Arc<RgbPicture>, QualityMetrics, Difference)>,
}

/// Compares a frame while the machine continues.
pub(crate) fn compare_frame(
    index: usize,
    machine: RgbPicture,
    exact: Option<ExactPicture>,
) -> Deferred<Result<ComparedFrame, SizeMismatch>> {
    Deferred::start(move || {
        let exact = exact.map(|exact| exact.compare(&machine)).transpose()?;
        Ok(ComparedFrame { index, digest: picture_hash(&machine), machine, exact })
    })
}

fn picture_hash(picture: &RgbPicture) -> String {
    let mut hash = Sha256::new();
    hash.update(picture.rgb.as_flattened());
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
