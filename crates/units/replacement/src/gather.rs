//! Pseudo-normals held back until their code book is built.

use basrelief_signals::{Control, Flow, PseudoNormals};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// What is gathered: from the first fragment of a batch to the control token that ends it, in order, control in between
/// included. In hardware the pseudo-normals lie in memory (120).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gather {
    pub(crate) held: VecDeque<Flow<PseudoNormals>>,
    /// Bytes written to memory (120).
    pub(crate) written: u64,
    /// Bytes read back.
    pub(crate) read: u64,
    /// The control token that ended the batch; it leaves last.
    pub(crate) ending: Option<Control>,
    /// The batch's code book, once it is built.
    pub(crate) book: Option<Arc<Vec<Vec<[i16; 3]>>>>,
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

    /// All pseudo-normals of a table level, in order; `table_level` maps the sample's level to its table's.
    pub(crate) fn of_level(&self, level: u8, table_level: impl Fn(u8) -> u8) -> impl Iterator<Item = [i16; 3]> {
        let normals = move |flow: &'_ Flow<PseudoNormals>| {
            let mut normals = Vec::new();
            if let Flow::Item(PseudoNormals { stamp, samples }) = flow {
                for lane in 0..stamp.len() {
                    let of_level = samples.iter().filter(|s| table_level(s.level) == level);
                    normals.extend(of_level.map(|s| s.value[lane]));
                }
            }
            normals
        };
        self.held.iter().flat_map(normals)
    }
}
