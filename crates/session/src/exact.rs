//! The exact pictures that the machine's are held against.

use crate::tee::TraceNotes;
use basrelief_reference::{Picture, Style, draw_scene};
use basrelief_signals::Scene;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// Where exact pictures come from.
pub(crate) enum Exact {
    /// Nobody wants any.
    None,
    /// The scene itself.
    Scene(Arc<Scene>, Style),
    /// The polygons of a trace, drawn as they passed.
    Trace(Rc<RefCell<TraceNotes>>),
}

impl Exact {
    /// The exact picture of frame `index`; frames are asked for in order.
    pub(crate) fn picture(&self, index: usize) -> Option<Picture> {
        match self {
            Self::None => None,
            Self::Scene(scene, style) => scene.frames.get(index).map(|frame| draw_scene(scene, frame, style)),
            Self::Trace(seen) => seen.borrow_mut().exact.pop_front().map(|(picture, _)| picture),
        }
    }
}
