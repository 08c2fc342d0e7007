//! Pseudo-normals held until their code book is built.

use basrelief_signals::polygon::{LightingStage, VertexAttributes};
use basrelief_signals::width::{CONTROL, LEVEL, SHARE};
use basrelief_signals::{BitWidth, Control, Flow, Fragment, PseudoNormals, SignalWidths, StampLanes, quantization_memory};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Remaining part of a VQ table to be read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct TableLoad {
    pub(crate) address: u64,
    pub(crate) bytes: u64,
}

impl TableLoad {
    /// Returns address and size of the next piece, of at most `most` bytes.
    pub(crate) fn next(&mut self, most: u64) -> (u64, u32) {
        let (address, bytes) = (self.address, self.bytes.min(most).max(1));
        self.address += bytes;
        self.bytes = self.bytes.saturating_sub(bytes);
        (address, bytes as u32)
    }
}

/// Gathered tokens: from the first fragment of a batch to the control token that ends it, in order and with control in between.
/// In hardware the pseudo-normals lie in memory (120).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GatheredBatch {
    pub(crate) held: VecDeque<Flow<PseudoNormals>>,
    /// N', which grow up from the lower end of their room in memory (120).
    pub(crate) normals: MemoryProgress,
    /// Fragments and control held with N', which grow down from the upper end.
    pub(crate) beside: MemoryProgress,
    /// The control token that ended the batch. It leaves last.
    pub(crate) ending: Option<Control>,
    /// The batch's code book, once built.
    pub(crate) book: Option<Arc<Vec<Vec<[i16; 3]>>>>,
    /// Part of the book that is still to be written to memory (120).
    pub(crate) unwritten: VecDeque<TableLoad>,
    /// True once the book has been sent. The gathered tokens follow.
    pub(crate) is_sending: bool,
}

/// Progress of writing and reading \[bytes\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct MemoryProgress {
    pub(crate) written: u64,
    pub(crate) read: u64,
}

/// Returns the size of a stamp without its N' \[bytes\]: position, depth, weights, triangle, and the shares of its samples.
pub(crate) fn fragments_bytes(normals: &PseudoNormals) -> u32 {
    let widths = SignalWidths { samples: normals.samples.len() as u32, ..SignalWidths::default() };
    let bits = Fragment::bits(&widths) + widths.samples * (LEVEL + SHARE);
    normals.stamp.len() as u32 * bits.div_ceil(8)
}

/// Vertex attributes of a waiting polygon that the device accepts.
const TAKEN: VertexAttributes = VertexAttributes { lit: LightingStage::Targets, normal_maps: true, textures: true };

/// Returns the size of a control token, with the set-up of a polygon \[bytes\].
pub(crate) fn control_bytes(control: &Control) -> u32 {
    let set_up = if let Control::Polygon(polygon) = control { polygon.bytes(TAKEN) as u32 } else { 0 };
    CONTROL.div_ceil(8) + set_up
}

impl GatheredBatch {
    /// Returns true if nothing is held.
    pub fn is_empty(&self) -> bool {
        self.held.is_empty() && self.ending.is_none()
    }

    /// Returns true if the batch is complete. The unit then takes no input until the whole batch has left.
    pub fn is_flushing(&self) -> bool {
        self.ending.is_some()
    }

    /// Stores the book and queues it for writing, `entry_bytes` bytes per entry.
    pub(crate) fn write_book(&mut self, lists: Vec<Vec<[i16; 3]>>, entry_bytes: u64) {
        let of = |(level, list): (usize, &Vec<_>)| TableLoad {
            address: quantization_memory::vq_table(level as u8),
            bytes: list.len() as u64 * entry_bytes,
        };
        self.unwritten = lists.iter().enumerate().filter(|(_, list)| !list.is_empty()).map(of).collect();
        self.book = Some(Arc::new(lists));
    }

    /// Returns all pseudo-normals of a table level, in order. `table_level` maps the sample's level to its table's.
    pub(crate) fn of_level(&self, level: u8, table_level: impl Fn(u8) -> u8) -> impl Iterator<Item = [i16; 3]> {
        let normals = move |flow: &'_ Flow<PseudoNormals>| {
            let mut normals = Vec::new();
            if let Flow::Item(PseudoNormals { stamp, samples }) = flow {
                for lane in 0..stamp.len() {
                    let of_level = samples.iter().filter(|s| table_level(s.level) == level);
                    normals.extend(of_level.map(|s| s.value.lane(lane)));
                }
            }
            normals
        };
        self.held.iter().flat_map(normals)
    }
}
