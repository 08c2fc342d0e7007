//! What a view is a view of.

use crate::view::ViewHints;
use crate::{SceneError, ViewOptions};
use basrelief_input::{Held, OverBudget};
use basrelief_signals::{Frame, Light, Object, Scene};
use std::sync::Arc;

/// A model or a demo that nobody looks at yet: it is made once, and seen from as many sides as one likes. Made by
/// [`Subject::load_within`](Self::load_within) and [`Subject::demo`](Self::demo).
pub struct Subject {
    pub(crate) name: String,
    pub(crate) objects: Vec<Arc<Object>>,
    pub(crate) hints: ViewHints,
    pub(crate) warnings: Vec<String>,
}

impl Subject {
    /// The scene as these options look at it. What they leave open is the model's choice.
    ///
    /// # Errors
    /// Options out of range.
    pub fn seen(&self, options: &ViewOptions) -> Result<Scene, SceneError> {
        let Self { name, objects, hints, warnings } = self;
        let (name, objects, warnings) = (name.clone(), objects.clone(), warnings.clone());
        Ok(Scene { name, objects, frames: hints.frames(options)?, warnings })
    }

    /// Takes what the frames of a view hold.
    pub(crate) fn hold_frames(&self, options: &ViewOptions, held: &mut Held) -> Result<(), OverBudget> {
        let frame = (size_of::<Frame>() + 64 + self.hints.lamps.len() * size_of::<Light>()) as u64;
        held.grow(frame * u64::from(options.frames.unwrap_or(self.hints.frames)), "frames and their lights")
    }

    /// Its triangles.
    pub fn triangles(&self) -> usize {
        self.objects.iter().map(|object| object.mesh.indices.len() / 3).sum()
    }

    /// What was left out or replaced on import, one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
