//! The exact pictures that the machine's are held against.

use crate::tee::TraceNotes;
use basrelief_reference::{Picture, Style, draw_scene};
use basrelief_signals::Scene;
use basrelief_threads::Later;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// Where exact pictures come from.
pub(crate) enum Exact {
    /// Nobody wants any.
    None,
    /// The scene itself: each is drawn while the machine draws the same, or the frame before.
    Scene(SceneAhead),
    /// The polygons of a trace, drawn as they passed.
    Trace(Rc<RefCell<TraceNotes>>),
}

/// The exact pictures of a scene, the next one under way.
pub(crate) struct SceneAhead {
    scene: Arc<Scene>,
    style: Style,
    next: Option<Later<Picture>>,
}

impl SceneAhead {
    pub(crate) fn new(scene: &Arc<Scene>, style: Style) -> Self {
        let mut ahead = Self { scene: Arc::clone(scene), style, next: None };
        ahead.next = ahead.start(0);
        ahead
    }

    fn start(&self, index: usize) -> Option<Later<Picture>> {
        let frame = Arc::clone(self.scene.frames.get(index)?);
        let (scene, style) = (Arc::clone(&self.scene), self.style);
        Some(Later::start(move || draw_scene(&scene, &frame, &style)))
    }
}

impl Exact {
    /// The exact picture of frame `index`; frames are asked for in order.
    pub(crate) fn picture(&mut self, index: usize) -> Option<Later<Picture>> {
        match self {
            Self::None => None,
            Self::Scene(ahead) => {
                let following = ahead.start(index + 1);
                std::mem::replace(&mut ahead.next, following)
            }
            Self::Trace(seen) => {
                let picture = seen.borrow_mut().exact.pop_front().map(|(picture, _)| picture);
                picture.map(|picture| Later::on_demand(move || picture))
            }
        }
    }
}
