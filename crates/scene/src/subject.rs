//! Models and demos without a view.

use crate::outside::over_budget;
use crate::view::{MAX_FRAMES, ViewHints};
use crate::{SceneError, ViewOptions};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_signals::{Frame, Light, Object, Scene};
use std::sync::Arc;

/// A model or a demo without a view. It is built once, and then drawn from any number of views. Built by
/// [`SceneSubject::load`](Self::load) and [`SceneSubject::demo`](Self::demo).
pub struct SceneSubject {
    pub(crate) name: String,
    pub(crate) objects: Vec<Arc<Object>>,
    pub(crate) hints: ViewHints,
    /// Width of the view of the model's camera in heights, if the model states it.
    pub(crate) camera_ratio: Option<f64>,
    pub(crate) warnings: Vec<String>,
}

impl SceneSubject {
    /// Returns the scene from this view. The model supplies missing options.
    ///
    /// # Errors
    /// Options out of range.
    pub fn seen(&self, options: &ViewOptions) -> Result<Scene, SceneError> {
        let Self { name, objects, hints, warnings, .. } = self;
        let (name, objects, mut warnings) = (name.clone(), objects.clone(), warnings.clone());
        warnings.extend(self.cut_sides(options));
        Ok(Scene { name, objects, frames: hints.frames(options)?, warnings })
    }

    /// Warns if the view of the model's camera is wider than the image, by more than a pixel at either side.
    fn cut_sides(&self, options: &ViewOptions) -> Option<String> {
        let [width, height] = options.size.map(f64::from);
        let whole = self.camera_ratio.filter(|_| options.camera.is_none())? * height;
        (whole > width + 2.0).then(|| {
            format!(
                "the view of the model's camera is {:.2} times as wide as the image, which cuts its sides off; choose a wider image",
                whole / width
            )
        })
    }

    /// Like [`seen`](Self::seen), with a memory limit: the scene, and the reservation of its frames.
    ///
    /// # Errors
    /// Errors of [`seen`](Self::seen), and input over the memory limit.
    pub fn seen_within(&self, options: &ViewOptions, budget: &MemoryPool) -> Result<(Scene, MemoryReservation), SceneError> {
        let frame = (size_of::<Frame>() + 64 + self.hints.lamps.len() * size_of::<Light>()) as u64;
        let frames = self.hints.count(options).min(MAX_FRAMES as usize) as u64;
        let held = budget.try_reserve(frame.saturating_mul(frames), "frames and their lights");
        let held = held.map_err(|error| over_budget("", &error).in_file(&self.name))?;
        Ok((self.seen(options)?, held))
    }

    /// Its name: that of its file, as the user named it, or of the demo.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Replaces the path of the file by its name alone, also in warnings: a path can tell about a computer and its user.
    pub fn without_path(mut self) -> Self {
        let file = std::path::Path::new(&self.name).file_name();
        if let Some(file) = file.map(|file| file.to_string_lossy().into_owned()) {
            self.warnings.iter_mut().for_each(|warning| *warning = warning.replace(&self.name, &file));
            self.name = file;
        }
        self
    }

    /// Its objects, in drawing order.
    pub fn objects(&self) -> &[Arc<Object>] {
        &self.objects
    }

    /// Its triangles.
    pub fn triangles(&self) -> usize {
        self.objects.iter().map(|object| object.mesh.indices.len() / 3).sum()
    }

    /// Warnings of the import, one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
