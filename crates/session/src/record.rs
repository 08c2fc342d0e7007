//! What the geometry processor (102) hands on, without the rest of the machine.

use crate::machines::MachineConfig;
use basrelief_display_list::{Begin, CanonicalHash, Digest, TraceError};
use basrelief_geometry_processor::{GeometryProcessor, SceneDraws};
use basrelief_kernel::{Demand, Traffic, Unit};
use basrelief_machines::FrontConfig;
use basrelief_signals::{Control, Scene};
use std::sync::Arc;

/// The display list of a scene: every control token that the geometry processor emits, in order, with the arrival that
/// it would have had, had nothing blocked it.
pub fn display_list(scene: &Arc<Scene>, config: &MachineConfig) -> impl Iterator<Item = Control> + use<> {
    controls(scene, config.front())
}

fn controls(scene: &Arc<Scene>, front: FrontConfig) -> impl Iterator<Item = Control> + use<> {
    let mut geometry = GeometryProcessor::new(front.geometry, front.bump);
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

/// Hash of the scene's display list: the same as that of the trace recorded from it.
pub(crate) fn hash_of(scene: &Arc<Scene>, front: FrontConfig) -> Result<Digest, TraceError> {
    let mut hash = CanonicalHash::new(&begin_of(scene));
    controls(scene, front).try_for_each(|control| hash.update(&control))?;
    Ok(hash.finish())
}
