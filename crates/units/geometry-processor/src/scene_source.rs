//! Scene source: the host that feeds a scene.

use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_signals::{Draw, Frame, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Draw commands of a scene, frame by frame. Its memory does not grow with their number.
#[derive(Clone, Debug)]
pub struct SceneDraws {
    scene: Arc<Scene>,
    frame: usize,
    begun: bool,
    object: usize,
    /// Next triangle of the object. `None` before the object's own command.
    triangle: Option<u32>,
}

impl SceneDraws {
    /// Creates the commands of all frames of the scene.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self { scene, frame: 0, begun: false, object: 0, triangle: None }
    }

    /// Returns the first frame, which declares all colour textures in order of their first object, including those of objects
    /// outside the view.
    fn first_frame(&self, frame: &Frame) -> Arc<Frame> {
        let mut known = BTreeSet::new();
        let all = self.scene.objects.iter().filter_map(|object| object.material.color_texture.as_ref());
        let textures = all.filter(|texture| known.insert(texture.id)).cloned().collect();
        Arc::new(Frame { textures, ..frame.clone() })
    }
}

impl Iterator for SceneDraws {
    type Item = Draw;

    fn next(&mut self) -> Option<Draw> {
        let frame = self.scene.frames.get(self.frame)?;
        if !self.begun {
            self.begun = true;
            return Some(Draw::Frame(if self.frame == 0 { self.first_frame(frame) } else { Arc::clone(frame) }));
        }
        while let Some(object) = self.scene.objects.get(self.object) {
            let Some(triangle) = self.triangle else {
                self.triangle = Some(0);
                return Some(Draw::Object(Arc::clone(object)));
            };
            if (triangle as usize) < object.mesh.indices.len() / 3 {
                self.triangle = Some(triangle + 1);
                return Some(Draw::Triangle(triangle));
            }
            self.object += 1;
            self.triangle = None;
        }
        self.frame += 1;
        self.begun = false;
        self.object = 0;
        Some(Draw::FrameEnd)
    }
}

/// Counters of the scene source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneSourceCounters {
    /// Commands delivered.
    pub commands: u64,
}

/// State of the scene source between steps. Its position in the scene is the number of commands delivered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneSourceState {
    /// Counters.
    pub counters: SceneSourceCounters,
}

/// Scene source: the host, which feeds one draw command per cycle.
#[derive(Clone, Debug)]
pub struct SceneSource<I> {
    /// State between steps.
    pub state: SceneSourceState,
    draws: I,
    /// Next command, fetched ahead, because a unit declares its end from its own state.
    next: Option<Draw>,
}

impl<I: Iterator<Item = Draw>> SceneSource<I> {
    /// Creates a source that feeds these commands.
    pub fn new(draws: I) -> Self {
        Self::resumed(draws, SceneSourceState::default())
    }

    /// Creates a source that continues from `state` with the same commands. It skips the delivered ones.
    pub fn resumed(mut draws: I, state: SceneSourceState) -> Self {
        let delivered = usize::try_from(state.counters.commands).unwrap_or(usize::MAX);
        let next = draws.by_ref().nth(delivered);
        Self { state, draws, next }
    }
}

impl<I: Iterator<Item = Draw>> Unit for SceneSource<I> {
    basrelief_kernel::unit_info!("feeds the scene, one draw command per cycle");
    type In = ();
    type Out = Option<Draw>;

    fn demand(&self) -> Demand {
        if self.next.is_some() { Demand::Nothing } else { Demand::Finished }
    }

    fn step(&mut self, (): (), _: &mut MemoryPorts) -> Step<Self::Out> {
        let next = self.draws.next();
        self.state.counters.commands += 1;
        Step::after(0, std::mem::replace(&mut self.next, next))
    }

    fn is_empty(&self) -> bool {
        self.next.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::{Mesh, Object};

    #[test]
    fn scene_is_drawn_by_frame_then_object() {
        let frame = |index| Arc::new(Frame { index, width: 1, height: 1, ..Frame::default() });
        let object = |id, triangles: u32| {
            let mesh = Arc::new(Mesh { indices: vec![0; 3 * triangles as usize], ..Mesh::default() });
            let name = String::new();
            Arc::new(Object {
                id,
                name,
                mesh,
                world: [0.0; 16],
                material: Arc::default(),
                entries: None,
                bias: None,
                bump: None,
                shading: Default::default(),
            })
        };
        let scene = Scene { frames: vec![frame(0), frame(1)], objects: vec![object(0, 2), object(1, 0)], ..Scene::default() };
        let mut source = SceneSource::new(SceneDraws::new(Arc::new(scene)));
        let mut seen = String::new();
        while source.demand() == Demand::Nothing {
            seen.push_str(&match source.step((), &mut MemoryPorts::default()).out {
                Some(Draw::Frame(f)) => format!("f{} ", f.index),
                Some(Draw::Object(o)) => format!("o{} ", o.id),
                Some(Draw::Triangle(t)) => format!("{t} "),
                Some(Draw::FrameEnd) => "end ".into(),
                None => "nothing ".into(),
            });
        }
        assert_eq!(seen, "f0 o0 0 1 o1 end f1 o0 0 1 o1 end ");
        assert_eq!(source.demand(), Demand::Finished);
    }
}
