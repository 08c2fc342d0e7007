//! A finished frame, held against its exact picture.

use crate::exact::ExactPicture;
use basrelief_reference::{Picture, Quality, SizeMismatch};
use basrelief_report::model::Difference;
use basrelief_threads::Later;
use sha2::{Digest as _, Sha256};
use std::sync::Arc;

/// A finished frame, and what is told of it.
pub(crate) struct Judged {
    pub(crate) index: usize,
    pub(crate) machine: Picture,
    /// SHA-256 of the RGB8 rows, top row first.
    pub(crate) digest: String,
    pub(crate) exact: Option<(Arc<Picture>, Quality, Difference)>,
}

/// Judges a frame while the machine goes on: it has nothing more to do with it.
pub(crate) fn judged(index: usize, machine: Picture, exact: Option<ExactPicture>) -> Later<Result<Judged, SizeMismatch>> {
    Later::start(move || {
        let exact = exact.map(|exact| exact.judge(&machine)).transpose()?;
        Ok(Judged { index, digest: digest(&machine), machine, exact })
    })
}

fn digest(picture: &Picture) -> String {
    let mut hash = Sha256::new();
    hash.update(picture.rgb.as_flattened());
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
