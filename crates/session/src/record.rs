//! What the geometry processor (102) hands on, without the rest of the machine.

use crate::machines::MachineConfig;
use basrelief_display_list::{Begin, CanonicalHash, Digest, TraceError};
use basrelief_geometry_processor::{GeometryProcessor, SceneDraws};
use basrelief_kernel::{Demand, Traffic, Unit};
use basrelief_machines::FrontConfig;
use basrelief_signals::{Control, Draw, Scene};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// The display list of a scene: every control token that the geometry processor emits, in order, with the arrival that
/// it would have had, had nothing blocked it.
pub fn display_list(scene: &Arc<Scene>, config: &MachineConfig) -> impl Iterator<Item = Control> + use<> {
    controls(scene, config.front())
}

fn controls(scene: &Arc<Scene>, front: FrontConfig) -> impl Iterator<Item = Control> + use<> {
    let mut geometry = front.geometry_processor();
    let mut traffic = Traffic::muted();
    SceneDraws::new(Arc::clone(scene)).filter_map(move |draw| {
        debug_assert_eq!(geometry.demand(), Demand::All, "one draw command, at most one control token");
        geometry.step(Some(draw), &mut traffic).out
    })
}

/// How a trace of this scene begins.
pub fn begin_of(scene: &Scene) -> Begin {
    scene.frames.first().map_or_else(|| Begin::new(1, 1), |f| Begin::new(f.width, f.height))
}

/// What is learnt from the draw commands of a scene as they pass.
#[derive(Default)]
pub(crate) struct Drawn {
    /// Draw commands passed.
    pub(crate) commands: u64,
    /// Hash of the scene's display list, once all have passed: the same as that of the trace recorded from it.
    pub(crate) digest: Option<Digest>,
    /// What cannot be hashed.
    pub(crate) error: Option<TraceError>,
    /// Time spent here \[s\]: hashing is no part of the simulation.
    pub(crate) seconds: f64,
}

/// Draw commands of a scene, hashed as they pass: hashed ahead of the run, many frames would hold up the first cycle, and
/// `max_cycles` would not limit them. What has passed goes through a geometry processor of its own, since what the machine's
/// hands on depends on what holds it up.
pub(crate) struct HashedDraws {
    draws: SceneDraws,
    geometry: GeometryProcessor,
    hash: Option<CanonicalHash>,
    drawn: Rc<RefCell<Drawn>>,
    clock: fn() -> f64,
}

impl HashedDraws {
    pub(crate) fn new(scene: &Arc<Scene>, front: FrontConfig, drawn: Rc<RefCell<Drawn>>, clock: fn() -> f64) -> Self {
        let hash = Some(CanonicalHash::new(&begin_of(scene)));
        let geometry = front.geometry_processor();
        Self { draws: SceneDraws::new(Arc::clone(scene)), geometry, hash, drawn, clock }
    }

    fn pass(&mut self, draw: &Draw, drawn: &mut Drawn) -> Result<(), TraceError> {
        drawn.commands += 1;
        let control = self.geometry.step(Some(draw.clone()), &mut Traffic::muted()).out;
        control.iter().zip(&mut self.hash).try_for_each(|(control, hash)| hash.update(control))
    }
}

impl Iterator for HashedDraws {
    type Item = Draw;

    fn next(&mut self) -> Option<Draw> {
        let began = (self.clock)();
        let drawn = Rc::clone(&self.drawn);
        let mut drawn = drawn.borrow_mut();
        let mut draw = self.draws.next();
        match &draw {
            Some(passing) => {
                if let Err(error) = self.pass(passing, &mut drawn) {
                    drawn.error = Some(error);
                    draw = None;
                }
            }
            None => drawn.digest = self.hash.take().map(CanonicalHash::finish),
        }
        drawn.seconds += (self.clock)() - began;
        draw
    }
}
