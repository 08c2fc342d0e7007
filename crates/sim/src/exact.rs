//! The exact pictures that the machine's are held against.

use crate::prepared::{self, Prepared};
use crate::tee::TraceNotes;
use basrelief_reference::{Picture, Quality, SizeMismatch, Style};
use basrelief_report::model::Difference;
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
    prepared: Prepared,
    style: Style,
    next: Option<Later<Arc<Picture>>>,
}

impl SceneAhead {
    pub(crate) fn new(prepared: &Prepared, style: Style) -> Self {
        Self { prepared: prepared.clone(), style, next: prepared.exact(style, 0) }
    }
}

/// The exact picture of a frame.
pub(crate) struct ExactPicture {
    picture: Later<Arc<Picture>>,
    /// Whose it is, where that may know how far the machine's is from it.
    of: Option<(Prepared, Style, usize)>,
}

impl Exact {
    /// The exact picture of frame `index`; frames are asked for in order.
    pub(crate) fn picture(&mut self, index: usize) -> Option<ExactPicture> {
        match self {
            Self::None => None,
            Self::Scene(SceneAhead { prepared, style, next }) => {
                let picture = std::mem::replace(next, prepared.exact(*style, index + 1))?;
                Some(ExactPicture { picture, of: Some((prepared.clone(), *style, index)) })
            }
            Self::Trace(seen) => {
                let (picture, _) = seen.borrow_mut().exact.pop_front()?;
                Some(ExactPicture { picture: Later::on_demand(move || Arc::new(picture)), of: None })
            }
        }
    }
}

impl ExactPicture {
    /// The picture, once it is there, and how far the machine's is from it.
    ///
    /// # Errors
    /// Another size.
    pub(crate) fn judge(self, machine: &Picture) -> Result<(Arc<Picture>, Quality, Difference), SizeMismatch> {
        let exact = self.picture.get();
        let (quality, difference) = match self.of {
            Some((prepared, style, index)) => prepared.judge((style, index), &exact, machine)?,
            None => prepared::judge(&exact, machine)?,
        };
        Ok((exact, quality, difference))
    }
}
