//! File format of recordings.
//!
//! A recording is the line `basrelief-tape/1`, then blocks. A block is a letter, the length of its content in bytes (32 bits, little
//! endian), and the content. `H`, the first block, contains the machine and its parameters as JSON. `R` contains a [chunk](RecordingChunk) of
//! steps. `E` contains the untimed result of the run and the SHA-256 of its work as JSON. `S`, the last block, contains the SHA-256 of the
//! contents of `H` and `E`. Recordings of earlier builds may lack it. Compression is outside of this format.

use crate::options::Overrides;
use crate::run::untimed::UntimedResult;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::stats::FigureValue;
use basrelief_machines::{InputKind, MachineSpec};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

/// First line of a recording.
pub(super) const FIRST_LINE: &[u8] = b"basrelief-tape/1\n";
/// Size limit of a block \[bytes\].
pub(super) const MAX_BLOCK_BYTES: u32 = 1 << 28;
/// Approximate size of a chunk of steps \[bytes\].
pub(crate) const CHUNK_BYTES: usize = 1 << 20;
/// Largest work of a short recording \[bytes\]. A step takes about five.
pub(super) const SHORT_BYTES: usize = 4 << 20;

/// Content of block `H`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RecordingHeader {
    /// Build of the simulator that executed the steps; in version 0.1, the version alone.
    #[serde(rename = "version")]
    pub(super) build: String,
    pub(super) machine: String,
    #[serde(rename = "way")]
    pub(super) input: InputKind,
    #[serde(rename = "given")]
    pub(super) overrides: Overrides,
}

/// Content of block `E`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RecordingEnd {
    #[serde(rename = "ended")]
    pub(super) result: UntimedResult,
    pub(super) figures: Vec<(String, FigureValue)>,
    pub(super) work: String,
}

/// Returns the size of the work in a chunk \[bytes\].
pub(super) fn work_bytes(chunk: &RecordingChunk) -> usize {
    chunk.streams().map(<[u8]>::len).sum()
}

/// SHA-256 of the work of each stage. It does not depend on the division into chunks.
#[derive(Clone, Default)]
pub(crate) struct WorkHash {
    stages: Vec<Sha256>,
    bytes: usize,
}

impl WorkHash {
    pub(crate) fn add(&mut self, chunk: &RecordingChunk) {
        self.stages.resize(chunk.streams().count(), Sha256::new());
        self.stages.iter_mut().zip(chunk.streams()).for_each(|(hash, stream)| hash.update(stream));
        self.bytes += work_bytes(chunk);
    }

    /// True if the recording is short enough for [`AnalysisPolicy::IfShort`](crate::AnalysisPolicy::IfShort).
    pub(crate) fn is_short(&self) -> bool {
        self.bytes <= SHORT_BYTES
    }

    pub(super) fn finish(self) -> String {
        let mut all = Sha256::new();
        self.stages.into_iter().for_each(|stage| all.update(stage.finalize()));
        all.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Length of a SHA-256 \[bytes\].
pub(super) const SEAL_BYTES: usize = 32;

/// SHA-256 of the header and the end of a recording. The end states the SHA-256 of the work between them.
pub(crate) struct RecordingSeal(Sha256);

impl RecordingSeal {
    pub(super) fn of_header(content: &[u8]) -> Self {
        Self(Sha256::new_with_prefix(content))
    }

    /// Returns the content of block `S`.
    pub(super) fn close(mut self, end: &[u8]) -> [u8; SEAL_BYTES] {
        self.0.update(end);
        self.0.finalize().into()
    }
}

/// Encodes a block.
pub(super) fn block(letter: u8, content: &[u8]) -> Vec<u8> {
    let mut all = vec![letter];
    all.extend((content.len() as u32).to_le_bytes());
    all.extend_from_slice(content);
    all
}

/// Encodes the first line and the header of a recording whose steps `build` of the simulator executed. Returns its seal, too.
pub(crate) fn header<S: MachineSpec>(build: &str, input: InputKind, overrides: &Overrides) -> (Vec<u8>, RecordingSeal) {
    let header = RecordingHeader { build: build.into(), machine: S::NAME.into(), input, overrides: overrides.clone() };
    let content = serde_json::to_vec(&header).unwrap_or_default();
    ([FIRST_LINE, &block(b'H', &content)].concat(), RecordingSeal::of_header(&content))
}

/// Encodes a chunk of steps.
pub(crate) fn steps(chunk: &RecordingChunk) -> Vec<u8> {
    block(b'R', &chunk.to_bytes())
}

/// Encodes the end of a recording.
pub(crate) fn end(result: &UntimedResult, figures: Vec<(String, FigureValue)>, work: WorkHash, seal: RecordingSeal) -> Vec<u8> {
    let end = RecordingEnd { result: result.clone(), figures, work: work.finish() };
    sealed_end(&serde_json::to_vec(&end).unwrap_or_default(), seal)
}

/// Encodes the last two blocks.
pub(super) fn sealed_end(content: &[u8], seal: RecordingSeal) -> Vec<u8> {
    [block(b'E', content), block(b'S', &seal.close(content))].concat()
}
