//! Scene that is run more than once, with a cache of results that do not depend on the settings.

use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_machines::FrontConfig;
use basrelief_reference::{QualityMetrics, RenderStyle, RgbPicture, SizeMismatch, draw_scene};
use basrelief_report::model::Difference;
use basrelief_signals::Scene;
use basrelief_threads::Deferred;
use basrelief_trace::Digest;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Scene with a cache: hashes of its display list, reference images, and comparisons with them. Clones share the cache. The cache does not
/// change reports.
///
/// A scene converted from `Arc<Scene>` is meant for one run, and has no cache.
#[derive(Clone, Debug)]
pub struct PreparedScene {
    scene: Arc<Scene>,
    cache: Option<Arc<Mutex<SceneCache>>>,
}

impl From<Arc<Scene>> for PreparedScene {
    fn from(scene: Arc<Scene>) -> Self {
        Self { scene, cache: None }
    }
}

/// Maximum number of cached hashes, and of cached pictures.
const MAX_ENTRIES: usize = 16;
/// Memory per pixel of a reference image and of the compared picture \[bytes\].
const PIXEL: u64 = 8;

#[derive(Debug)]
struct SceneCache {
    hashes: Vec<(FrontConfig, Digest)>,
    pictures: Vec<ExactEntry>,
    /// Memory of the pictures.
    held: MemoryReservation,
}

/// A reference image, and the last comparison with it.
#[derive(Debug)]
struct ExactEntry {
    style: RenderStyle,
    frame: usize,
    exact: Arc<RgbPicture>,
    compared: Option<(RgbPicture, QualityMetrics, Difference)>,
}

impl PreparedScene {
    /// Creates a scene with a cache. When the memory limit is reached, nothing more is cached.
    pub fn cached(scene: Arc<Scene>, budget: &MemoryPool) -> Self {
        let cache = SceneCache { hashes: vec![], pictures: vec![], held: budget.empty_reservation() };
        Self { scene, cache: Some(Arc::new(Mutex::new(cache))) }
    }

    /// Returns the scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    fn cache(&self) -> Option<MutexGuard<'_, SceneCache>> {
        self.cache.as_ref().map(|cache| cache.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the cached hash of the display list that this front end makes.
    pub(crate) fn hash(&self, front: &FrontConfig) -> Option<Digest> {
        self.cache()?.hashes.iter().find(|(of, _)| of == front).map(|(_, hash)| *hash)
    }

    pub(crate) fn keep_hash(&self, front: FrontConfig, hash: Digest) {
        let Some(mut cache) = self.cache() else { return };
        if cache.hashes.len() < MAX_ENTRIES && cache.hashes.iter().all(|(of, _)| *of != front) {
            cache.hashes.push((front, hash));
        }
    }

    /// Starts to draw the reference image of a frame. Returns `None` if there is no such frame.
    pub(crate) fn exact(&self, style: RenderStyle, frame: usize) -> Option<Deferred<Arc<RgbPicture>>> {
        if let Some(exact) = self.cache().and_then(|cache| Some(Arc::clone(&cache.entry(style, frame)?.exact))) {
            return Some(Deferred::on_demand(move || exact));
        }
        let wanted = Arc::clone(self.scene.frames.get(frame)?);
        let prepared = self.clone();
        Some(Deferred::start(move || {
            let exact = Arc::new(draw_scene(&prepared.scene, &wanted, &style));
            prepared.keep_exact(style, frame, &exact);
            exact
        }))
    }

    fn keep_exact(&self, style: RenderStyle, frame: usize, exact: &Arc<RgbPicture>) {
        let Some(mut cache) = self.cache() else { return };
        let bytes = PIXEL * exact.rgb.len() as u64;
        if cache.pictures.len() < MAX_ENTRIES && cache.held.try_grow(bytes, "reference images").is_ok() {
            cache.pictures.push(ExactEntry { style, frame, exact: Arc::clone(exact), compared: None });
        }
    }

    /// Compares the machine's image of a frame with the reference image.
    pub(crate) fn compare(
        &self,
        style: RenderStyle,
        frame: usize,
        exact: &RgbPicture,
        machine: &RgbPicture,
    ) -> Result<(QualityMetrics, Difference), SizeMismatch> {
        let same = |entry: &ExactEntry| entry.compared.as_ref().filter(|(of, ..)| of == machine).map(|(_, q, d)| (*q, *d));
        if let Some(known) = self.cache().and_then(|cache| cache.entry(style, frame).and_then(same)) {
            return Ok(known);
        }
        let (quality, difference) = compare(exact, machine)?;
        if let Some(entry) = self.cache().as_mut().and_then(|cache| cache.entry_mut(style, frame)) {
            entry.compared = Some((machine.clone(), quality, difference));
        }
        Ok((quality, difference))
    }
}

/// Compares a machine's image with the reference image.
pub(crate) fn compare(exact: &RgbPicture, machine: &RgbPicture) -> Result<(QualityMetrics, Difference), SizeMismatch> {
    Ok((QualityMetrics::measure(exact, machine)?, crate::analysis::picture_difference::difference(exact, machine)))
}

impl SceneCache {
    fn entry(&self, style: RenderStyle, frame: usize) -> Option<&ExactEntry> {
        self.pictures.iter().find(|entry| entry.style == style && entry.frame == frame)
    }

    fn entry_mut(&mut self, style: RenderStyle, frame: usize) -> Option<&mut ExactEntry> {
        self.pictures.iter_mut().find(|entry| entry.style == style && entry.frame == frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_scene::{ViewOptions, demo};

    fn scene() -> Arc<Scene> {
        Arc::new(demo("cut-plane@1", &ViewOptions { size: [16, 12], ..ViewOptions::default() }).unwrap())
    }

    #[test]
    fn exact_picture_is_drawn_once() {
        let prepared = PreparedScene::cached(scene(), &MemoryPool::default());
        let [first, second] = [0, 1].map(|_| prepared.exact(RenderStyle::default(), 0).unwrap().get());
        assert!(Arc::ptr_eq(&first, &second));
        assert!(prepared.exact(RenderStyle::default(), 1).is_none(), "there is one frame");
        let once = PreparedScene::from(scene());
        let [first, second] = [0, 1].map(|_| once.exact(RenderStyle::default(), 0).unwrap().get());
        assert!(!Arc::ptr_eq(&first, &second) && first == second);
    }

    #[test]
    fn cache_respects_the_memory_limit() {
        let prepared = PreparedScene::cached(scene(), &MemoryPool::new(100));
        let [first, second] = [0, 1].map(|_| prepared.exact(RenderStyle::default(), 0).unwrap().get());
        assert!(!Arc::ptr_eq(&first, &second) && first == second);
    }

    #[test]
    fn changed_picture_is_compared_again() {
        let prepared = PreparedScene::cached(scene(), &MemoryPool::default());
        let style = RenderStyle::default();
        let exact = prepared.exact(style, 0).unwrap().get();
        let mut machine = (*exact).clone();
        assert_eq!(prepared.compare(style, 0, &exact, &machine).unwrap(), compare(&exact, &machine).unwrap());
        let drawn = machine.covered.iter().position(|covered| *covered).unwrap();
        machine.rgb[drawn] = machine.rgb[drawn].map(|c| c ^ 64);
        let compared = prepared.compare(style, 0, &exact, &machine).unwrap();
        assert_eq!(compared, compare(&exact, &machine).unwrap());
        assert_eq!(compared.1.largest, 64);
    }
}
