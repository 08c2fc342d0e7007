//! What the geometry processor (102) hands on, without the rest of the machine.

use crate::held;
use crate::machines::MachineConfig;
use crate::outcome::SessionError;
use crate::prepared::Prepared;
use crate::settings::RunInput;
use basrelief_geometry_processor::SceneDraws;
use basrelief_input::Budget;
use basrelief_kernel::{Demand, MemoryPorts, Unit};
use basrelief_machines::FrontConfig;
use basrelief_signals::{Control, Draw, Scene};
use basrelief_threads::Later;
use basrelief_trace::{Begin, CanonicalHash, Digest, Files, Resolver, TraceError};
use std::cell::Cell;
use std::io::Read;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The display list of a scene: every control token that the geometry processor emits, in order, with the arrival that
/// it would have had, had nothing blocked it.
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

/// The hash of an input as reports have it, [`Input::sha256`](basrelief_report::model::Input), without a run: of the display list that
/// the machine's front end makes of a scene, or of a display list itself.
///
/// # Errors
/// A display list that cannot be read or hashed, and what is over the budget.
pub fn input_sha256(source: RunInput, config: &MachineConfig, budget: &Budget) -> Result<String, SessionError> {
    let digest = match source {
        RunInput::Scene(prepared) | RunInput::Remote { scene: prepared, .. } => {
            let _textures = held::textures(prepared.scene(), 0, budget)?;
            SceneHash::start(&prepared, config.front()).get()?
        }
        RunInput::Trace { reader, mut files, .. } => Some(trace_hash(reader, move |name: &str| files.open(name), budget)?),
    };
    Ok(digest.map(|digest| digest.to_string()).unwrap_or_default())
}

fn trace_hash(reader: Box<dyn Read>, files: impl Files, budget: &Budget) -> Result<Digest, TraceError> {
    let mut resolver = Resolver::within(reader, files, budget)?;
    let mut hash = CanonicalHash::new(resolver.begin());
    for command in &mut resolver {
        hash.update(&command?.0)?;
    }
    Ok(hash.finish())
}

/// How a trace of this scene begins.
pub fn begin_of(scene: &Scene) -> Begin {
    scene.frames.first().map_or_else(|| Begin::new(1, 1), |f| Begin::new(f.width, f.height))
}

/// How far the draw commands of a scene have passed.
#[derive(Clone, Copy, Default)]
pub(crate) struct Passed {
    pub(crate) commands: u64,
    /// Whether that is all of them.
    pub(crate) all: bool,
}

/// Draw commands of a scene, counted as they pass.
pub(crate) struct CountedDraws {
    draws: Option<SceneDraws>,
    passed: Rc<Cell<Passed>>,
}

impl CountedDraws {
    pub(crate) fn new(scene: &Arc<Scene>, passed: &Rc<Cell<Passed>>) -> Self {
        Self { draws: Some(SceneDraws::new(Arc::clone(scene))), passed: Rc::clone(passed) }
    }

    /// Of no scene.
    pub(crate) fn none() -> Self {
        Self { draws: None, passed: Rc::default() }
    }
}

impl Iterator for CountedDraws {
    type Item = Draw;

    fn next(&mut self) -> Option<Draw> {
        let draw = self.draws.as_mut()?.next();
        let Passed { commands, .. } = self.passed.get();
        self.passed.set(Passed { commands: commands + u64::from(draw.is_some()), all: draw.is_none() });
        draw
    }
}

/// Hash of a scene's display list, the same as that of the trace recorded from it. It is computed while the machine draws, from a
/// geometry processor of its own, since what the machine's hands on depends on what holds it up; and it is given up with this: many
/// frames must not hold up a run that `max_cycles` ends in the first of them.
pub(crate) struct SceneHash {
    hash: Later<Result<Option<Digest>, TraceError>>,
    given_up: GivenUp,
}

impl SceneHash {
    pub(crate) fn start(prepared: &Prepared, front: FrontConfig) -> Self {
        let given_up = GivenUp(Arc::default());
        if let Some(known) = prepared.hash(&front) {
            return Self { hash: Later::on_demand(move || Ok(Some(known))), given_up };
        }
        let (prepared, flag) = (prepared.clone(), Arc::clone(&given_up.0));
        let hash = Later::start(move || {
            let scene = prepared.scene();
            let mut hash = CanonicalHash::new(&begin_of(scene));
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
        Self { hash, given_up }
    }

    /// The hash.
    ///
    /// # Errors
    /// What cannot be hashed.
    pub(crate) fn get(self) -> Result<Option<Digest>, TraceError> {
        let Self { hash, given_up } = self;
        let digest = hash.get();
        drop(given_up);
        digest
    }
}

/// Says when it is dropped that nobody waits any more.
struct GivenUp(Arc<AtomicBool>);

impl Drop for GivenUp {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
