//! Reference images, which the images of the machine are compared with.

use super::trace_tap::TraceNotes;
use crate::prepared::{self, PreparedScene};
use basrelief_reference::{QualityMetrics, RenderStyle, RgbPicture, SizeMismatch};
use basrelief_report::model::Difference;
use basrelief_threads::Deferred;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// Source of reference images.
pub(crate) enum ExactSource {
    /// No reference images.
    None,
    /// ExactSource pictures of a scene, drawn while the machine draws the same or the previous frame.
    Scene(SceneExact),
    /// ExactSource pictures of a trace, drawn as its polygons pass.
    Trace(Rc<RefCell<TraceNotes>>),
}

/// ExactSource pictures of a scene. The next one is already being drawn.
pub(crate) struct SceneExact {
    prepared: PreparedScene,
    style: RenderStyle,
    next: Option<Deferred<Arc<RgbPicture>>>,
}

impl SceneExact {
    pub(crate) fn new(prepared: &PreparedScene, style: RenderStyle) -> Self {
        Self { prepared: prepared.clone(), style, next: prepared.exact(style, 0) }
    }
}

/// ExactSource picture of a frame.
pub(crate) struct ExactPicture {
    picture: Deferred<Arc<RgbPicture>>,
    /// Scene, style and frame, if the scene may have cached the comparison.
    cached: Option<(PreparedScene, RenderStyle, usize)>,
}

impl ExactSource {
    /// Returns the reference image of frame `index`. Must be called in the order of the frames.
    pub(crate) fn picture(&mut self, index: usize) -> Option<ExactPicture> {
        match self {
            Self::None => None,
            Self::Scene(SceneExact { prepared, style, next }) => {
                let picture = std::mem::replace(next, prepared.exact(*style, index + 1))?;
                Some(ExactPicture { picture, cached: Some((prepared.clone(), *style, index)) })
            }
            Self::Trace(seen) => {
                let (picture, _) = seen.borrow_mut().exact.pop_front()?;
                Some(ExactPicture { picture: Deferred::on_demand(move || Arc::new(picture)), cached: None })
            }
        }
    }
}

impl ExactPicture {
    /// Waits for the reference image, and compares the machine's image with it.
    ///
    /// # Errors
    /// Pictures of different sizes.
    pub(crate) fn compare(self, machine: &RgbPicture) -> Result<(Arc<RgbPicture>, QualityMetrics, Difference), SizeMismatch> {
        let exact = self.picture.get();
        let (quality, difference) = match self.cached {
            Some((prepared, style, index)) => prepared.compare(style, index, &exact, machine)?,
            None => prepared::compare(&exact, machine)?,
        };
        Ok((exact, quality, difference))
    }
}
