//! Display list of a scene: the output of the geometry processor (102) without the rest of the machine.

use super::memory_estimates;
use super::result::RunError;
use crate::options::RunInput;
use crate::prepared::PreparedScene;
use basrelief_geometry_processor::SceneDraws;
use basrelief_input::MemoryPool;
use basrelief_kernel::{Demand, MemoryPorts, Unit};
use basrelief_machines::{FrontConfig, MachineConfig};
use basrelief_signals::{Control, Draw, Scene};
use basrelief_threads::Deferred;
use basrelief_trace::{BeginCommand, CanonicalHash, Digest, TextureFiles, TraceError, TraceResolver};
use std::cell::Cell;
use std::io::Read;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Returns the display list of a scene: every control token that the geometry processor emits, in order.
pub fn display_list(scene: &Arc<Scene>, config: &MachineConfig) -> impl Iterator<Item = Control> + use<> {
    controls(scene, config.front())
}

fn controls(scene: &Arc<Scene>, front: FrontConfig) -> impl Iterator<Item = Control> + use<> {
    let mut geometry = front.geometry_processor();
    let mut traffic = MemoryPorts::discarding();
    SceneDraws::new(Arc::clone(scene)).filter_map(move |draw| {
        debug_assert_eq!(geometry.demand(), Demand::All, "one draw command, at most one control token");
        geometry.step(Some(draw), &mut traffic).out
    })
}

/// Returns the hash of an input without a run, as in [`Input::sha256`](basrelief_report::model::Input). For a scene, it is the hash of the
/// display list that the machine's front end makes.
///
/// # Errors
/// A trace that cannot be read or hashed, and an exceeded memory limit.
pub fn input_sha256(source: RunInput, config: &MachineConfig, budget: &MemoryPool) -> Result<String, RunError> {
    let digest = match source {
        RunInput::Scene(prepared) | RunInput::Remote { scene: prepared, .. } => {
            let _textures = memory_estimates::reserve_textures(prepared.scene(), 0, budget)?;
            SceneHash::start(&prepared, config.front()).get()?
        }
        RunInput::Trace { reader, files, .. } => Some(trace_hash(reader, files, budget)?),
    };
    Ok(digest.map(|digest| digest.to_string()).unwrap_or_default())
}

fn trace_hash(reader: Box<dyn Read>, files: Box<dyn TextureFiles>, budget: &MemoryPool) -> Result<Digest, TraceError> {
    let mut resolver = TraceResolver::new(reader, files, budget)?;
    let mut hash = CanonicalHash::new(resolver.begin());
    for command in &mut resolver {
        hash.update(&command?.0)?;
    }
    Ok(hash.finish())
}

/// Returns the header of a trace of this scene.
pub fn trace_header(scene: &Scene) -> BeginCommand {
    scene.frames.first().map_or_else(|| BeginCommand::new(1, 1), |f| BeginCommand::new(f.width, f.height))
}

/// Number of draw commands that have entered the machine.
#[derive(Clone, Copy, Default)]
pub(crate) struct DrawProgress {
    pub(crate) commands: u64,
    /// True if no more commands follow.
    pub(crate) all: bool,
}

/// Returns the draw commands of a scene, and counts them as they enter the machine.
pub(crate) fn counted_draws(scene: &Arc<Scene>, progress: &Rc<Cell<DrawProgress>>) -> impl Iterator<Item = Draw> + use<> {
    let (mut draws, progress) = (SceneDraws::new(Arc::clone(scene)), Rc::clone(progress));
    std::iter::from_fn(move || {
        let draw = draws.next();
        let commands = progress.get().commands + u64::from(draw.is_some());
        progress.set(DrawProgress { commands, all: draw.is_none() });
        draw
    })
}

/// Hash of a scene's display list, equal to the hash of a trace of the scene. A second geometry processor computes it in the background,
/// because the output of the machine's own one depends on backpressure. Dropping this value cancels the computation, so that a run with
/// `max_cycles` does not wait for frames that it never reaches.
pub(crate) struct SceneHash {
    hash: Deferred<Result<Option<Digest>, TraceError>>,
    cancel: CancelOnDrop,
}

impl SceneHash {
    pub(crate) fn start(prepared: &PreparedScene, front: FrontConfig) -> Self {
        let cancel = CancelOnDrop(Arc::default());
        if let Some(known) = prepared.hash(&front) {
            return Self { hash: Deferred::on_demand(move || Ok(Some(known))), cancel };
        }
        let (prepared, flag) = (prepared.clone(), Arc::clone(&cancel.0));
        let hash = Deferred::start(move || {
            let scene = prepared.scene();
            let mut hash = CanonicalHash::new(&trace_header(scene));
            for control in controls(scene, front.clone()) {
                if flag.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                hash.update(&control)?;
            }
            let digest = hash.finish();
            prepared.keep_hash(front, digest);
            Ok(Some(digest))
        });
        Self { hash, cancel }
    }

    /// Waits for the hash. Returns `None` if it was cancelled.
    ///
    /// # Errors
    /// A scene that cannot be hashed.
    pub(crate) fn get(self) -> Result<Option<Digest>, TraceError> {
        let Self { hash, cancel } = self;
        let digest = hash.get();
        drop(cancel);
        digest
    }
}

/// Sets a flag on drop.
struct CancelOnDrop(Arc<AtomicBool>);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
