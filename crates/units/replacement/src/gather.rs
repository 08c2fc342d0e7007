//! Pseudo-normals held back until their code book is built.

use crate::state::TableLoad;
use basrelief_signals::polygon::{Lit, Taken};
use basrelief_signals::width::{CONTROL, LEVEL, SHARE};
use basrelief_signals::{Control, Flow, Fragment, Lanes, PseudoNormals, Signal, Widths, quantization_memory};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// What is gathered: from the first fragment of a batch to the control token that ends it, in order, control in between
/// included. In hardware the pseudo-normals lie in memory (120).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gather {
    pub(crate) held: VecDeque<Flow<PseudoNormals>>,
    /// N', from the lower end of their room in memory (120) up.
    pub(crate) normals: Moved,
    /// Fragments and control that wait with them, from the upper end down.
    pub(crate) beside: Moved,
    /// The control token that ended the batch; it leaves last.
    pub(crate) ending: Option<Control>,
    /// The batch's code book, once it is built.
    pub(crate) book: Option<Arc<Vec<Vec<[i16; 3]>>>>,
    /// What of the book is still to be written to memory (120).
    pub(crate) unwritten: VecDeque<TableLoad>,
    /// The book has gone on; what was gathered follows.
    pub(crate) is_sending: bool,
}

/// How far writing and reading have come \[bytes\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Moved {
    pub(crate) written: u64,
    pub(crate) read: u64,
}

/// What fragments take beside their N': place, depth, weights, triangle, and the shares of their samples.
pub(crate) fn fragments_bytes(normals: &PseudoNormals) -> u32 {
    let widths = Widths { samples: normals.samples.len() as u32, ..Widths::default() };
    let bits = Fragment::bits(&widths) + widths.samples * (LEVEL + SHARE);
    normals.stamp.len() as u32 * bits.div_ceil(8)
}

/// What the device takes of a polygon that waits.
const TAKEN: Taken = Taken { lit: Lit::Targets, normal_maps: true, textures: true };

/// What a control token takes, with the set-up of a polygon.
pub(crate) fn control_bytes(control: &Control) -> u32 {
    let set_up = if let Control::Polygon(polygon) = control { polygon.bytes(TAKEN) as u32 } else { 0 };
    CONTROL.div_ceil(8) + set_up
}

impl Gather {
    /// Nothing is held back.
    pub fn is_empty(&self) -> bool {
        self.held.is_empty() && self.ending.is_none()
    }

    /// The batch is complete: the unit takes no input until all of it has left.
    pub fn is_flushing(&self) -> bool {
        self.ending.is_some()
    }

    /// Takes the book, and notes that it is to be written, `entry_bytes` an entry.
    pub(crate) fn write_book(&mut self, lists: Vec<Vec<[i16; 3]>>, entry_bytes: u64) {
        let of = |(level, list): (usize, &Vec<_>)| TableLoad {
            address: quantization_memory::vq_table(level as u8),
            bytes: list.len() as u64 * entry_bytes,
        };
        self.unwritten = lists.iter().enumerate().filter(|(_, list)| !list.is_empty()).map(of).collect();
        self.book = Some(Arc::new(lists));
    }

    /// All pseudo-normals of a table level, in order; `table_level` maps the sample's level to its table's.
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
