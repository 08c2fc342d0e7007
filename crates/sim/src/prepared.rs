//! A scene that is run more than once: what a setting does not change is done once.

use basrelief_input::{Budget, Held};
use basrelief_machines::FrontConfig;
use basrelief_reference::{Picture, Quality, SizeMismatch, Style, draw_scene};
use basrelief_report::model::Difference;
use basrelief_signals::Scene;
use basrelief_threads::Later;
use basrelief_trace::Digest;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A scene to be run, and what is known of it from runs before: the hash of its display list, its exact pictures, and how far
/// the machine's were from them. Reports are the same whether anything was known or not. Clones know the same.
///
/// A scene as such, `Arc<Scene>`, stands for one that is run once: nothing of it is kept.
#[derive(Clone, Debug)]
pub struct Prepared {
    scene: Arc<Scene>,
    known: Option<Arc<Mutex<Known>>>,
}

impl From<Arc<Scene>> for Prepared {
    fn from(scene: Arc<Scene>) -> Self {
        Self { scene, known: None }
    }
}

/// Most front ends whose display lists' hashes are remembered, and most exact pictures.
const MOST: usize = 16;
/// Bytes per pixel of an exact picture and of the machine's beside it.
const PIXEL: u64 = 8;

#[derive(Debug)]
struct Known {
    hashes: Vec<(FrontConfig, Digest)>,
    pictures: Vec<Drawn>,
    /// For the pictures.
    held: Held,
}

/// An exact picture, and the machine's that was held against it last.
#[derive(Debug)]
struct Drawn {
    style: Style,
    frame: usize,
    exact: Arc<Picture>,
    judged: Option<(Picture, Quality, Difference)>,
}

impl Prepared {
    /// A scene to be run more than once. What is kept of it counts against the budget; where that is used up, nothing more is.
    pub fn kept(scene: Arc<Scene>, budget: &Budget) -> Self {
        let known = Known { hashes: vec![], pictures: vec![], held: budget.nothing() };
        Self { scene, known: Some(Arc::new(Mutex::new(known))) }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    fn known(&self) -> Option<MutexGuard<'_, Known>> {
        self.known.as_ref().map(|known| known.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The hash of the display list that this front end makes of it.
    pub(crate) fn hash(&self, front: &FrontConfig) -> Option<Digest> {
        self.known()?.hashes.iter().find(|(of, _)| of == front).map(|(_, hash)| *hash)
    }

    pub(crate) fn keep_hash(&self, front: FrontConfig, hash: Digest) {
        let Some(mut known) = self.known() else { return };
        if known.hashes.len() < MOST && known.hashes.iter().all(|(of, _)| *of != front) {
            known.hashes.push((front, hash));
        }
    }

    /// The exact picture of a frame, under way; none where there is no such frame.
    pub(crate) fn exact(&self, style: Style, frame: usize) -> Option<Later<Arc<Picture>>> {
        if let Some(exact) = self.known().and_then(|known| Some(Arc::clone(&known.drawn(style, frame)?.exact))) {
            return Some(Later::on_demand(move || exact));
        }
        let wanted = Arc::clone(self.scene.frames.get(frame)?);
        let prepared = self.clone();
        Some(Later::start(move || {
            let exact = Arc::new(draw_scene(&prepared.scene, &wanted, &style));
            prepared.keep_exact(style, frame, &exact);
            exact
        }))
    }

    fn keep_exact(&self, style: Style, frame: usize, exact: &Arc<Picture>) {
        let Some(mut known) = self.known() else { return };
        let bytes = PIXEL * exact.rgb.len() as u64;
        if known.pictures.len() < MOST && known.held.grow(bytes, "exact pictures").is_ok() {
            known.pictures.push(Drawn { style, frame, exact: Arc::clone(exact), judged: None });
        }
    }

    /// How far the machine's picture is from the exact one.
    pub(crate) fn judge(
        &self,
        (style, frame): (Style, usize),
        exact: &Picture,
        machine: &Picture,
    ) -> Result<(Quality, Difference), SizeMismatch> {
        let same = |drawn: &Drawn| drawn.judged.as_ref().filter(|(of, ..)| of == machine).map(|(_, q, d)| (*q, *d));
        if let Some(judged) = self.known().and_then(|known| known.drawn(style, frame).and_then(same)) {
            return Ok(judged);
        }
        let (quality, difference) = judge(exact, machine)?;
        if let Some(drawn) = self.known().as_mut().and_then(|known| known.drawn_mut(style, frame)) {
            drawn.judged = Some((machine.clone(), quality, difference));
        }
        Ok((quality, difference))
    }
}

/// How far a machine's picture is from the exact one.
pub(crate) fn judge(exact: &Picture, machine: &Picture) -> Result<(Quality, Difference), SizeMismatch> {
    Ok((Quality::measure(exact, machine)?, crate::difference::difference(exact, machine)))
}

impl Known {
    fn drawn(&self, style: Style, frame: usize) -> Option<&Drawn> {
        self.pictures.iter().find(|drawn| drawn.style == style && drawn.frame == frame)
    }

    fn drawn_mut(&mut self, style: Style, frame: usize) -> Option<&mut Drawn> {
        self.pictures.iter_mut().find(|drawn| drawn.style == style && drawn.frame == frame)
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
    fn an_exact_picture_is_drawn_once() {
        let prepared = Prepared::kept(scene(), &Budget::default());
        let [first, second] = [0, 1].map(|_| prepared.exact(Style::default(), 0).unwrap().get());
        assert!(Arc::ptr_eq(&first, &second));
        assert!(prepared.exact(Style::default(), 1).is_none(), "there is one frame");
        let once = Prepared::from(scene());
        let [first, second] = [0, 1].map(|_| once.exact(Style::default(), 0).unwrap().get());
        assert!(!Arc::ptr_eq(&first, &second) && first == second);
    }

    #[test]
    fn nothing_is_kept_beyond_the_budget() {
        let prepared = Prepared::kept(scene(), &Budget::new(100));
        let [first, second] = [0, 1].map(|_| prepared.exact(Style::default(), 0).unwrap().get());
        assert!(!Arc::ptr_eq(&first, &second) && first == second);
    }

    #[test]
    fn a_picture_that_has_changed_is_judged_again() {
        let prepared = Prepared::kept(scene(), &Budget::default());
        let of = (Style::default(), 0);
        let exact = prepared.exact(of.0, of.1).unwrap().get();
        let mut machine = (*exact).clone();
        assert_eq!(prepared.judge(of, &exact, &machine).unwrap(), judge(&exact, &machine).unwrap());
        let drawn = machine.covered.iter().position(|covered| *covered).unwrap();
        machine.rgb[drawn] = machine.rgb[drawn].map(|c| c ^ 64);
        let judged = prepared.judge(of, &exact, &machine).unwrap();
        assert_eq!(judged, judge(&exact, &machine).unwrap());
        assert_eq!(judged.1.largest, 64);
    }
}
