//! Sources: the host that feeds a scene, and the replay of a recorded display list.

use crate::config::{Arrival, DisplayListConfig};
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_signals::{Control, Draw, Frame, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::sync::Arc;

/// The draw commands of a scene, frame by frame; memory does not grow with their number.
#[derive(Clone, Debug)]
pub struct SceneDraws {
    scene: Arc<Scene>,
    frame: usize,
    begun: bool,
    object: usize,
    /// The triangle of the object that comes next; none before the object's own command.
    triangle: Option<u32>,
}

impl SceneDraws {
    /// All frames of the scene.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self { scene, frame: 0, begun: false, object: 0, triangle: None }
    }

    /// It declares all colour textures, in order of their first object: those of objects outside the view too.
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

/// The host: feeds draw commands, one per cycle.
#[derive(Clone, Debug)]
pub struct SceneSource<I> {
    draws: I,
    /// Held ahead, since a unit declares its end from its own state.
    next: Option<Draw>,
}

impl<I: Iterator<Item = Draw>> SceneSource<I> {
    /// Feeds these.
    pub fn new(mut draws: I) -> Self {
        let next = draws.next();
        Self { draws, next }
    }
}

impl<I: Iterator<Item = Draw>> Unit for SceneSource<I> {
    type In = ();
    type Out = Option<Draw>;

    fn demand(&self) -> Demand {
        if self.next.is_some() { Demand::Nothing } else { Demand::Finished }
    }

    fn step(&mut self, (): (), _: &mut Traffic) -> Step<Self::Out> {
        let next = self.draws.next();
        Step::after(0, std::mem::replace(&mut self.next, next))
    }

    fn is_empty(&self) -> bool {
        self.next.is_none()
    }
}

/// Everything the display-list source remembers, beside its place in the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DisplayListState {
    /// Commands delivered.
    pub commands: u64,
    /// Start of the next step, had nothing ever blocked the source.
    pub elapsed: u64,
}

/// Latest recorded cycle that is believed; a damaged list must not overflow the time of a run.
const LATEST: u64 = 1 << 62;

/// A command, and the cycle at which it is due.
type Due = (Control, u64);

/// Replays a display list in place of the geometry processor (102): an iterator of commands, each with the cycle at which
/// it was delivered unblocked, where the list knows it.
///
/// With `arrival = recorded`, commands are delivered at these cycles as long as nothing blocks; what blocks delays all
/// that follow, as it would delay the geometry processor. A command without a cycle, or with one that is already past,
/// is due one cycle after the one before it. With `asap`, one command is delivered per cycle. An error in the list ends
/// the run with its message.
#[derive(Clone, Debug)]
pub struct DisplayListSource<I> {
    /// Parameters.
    pub config: DisplayListConfig,
    /// Everything it remembers.
    pub state: DisplayListState,
    commands: I,
    /// Held ahead, since a unit declares its end from its own state and a step's occupancy depends on the next command.
    next: Option<Result<Due, String>>,
}

impl<I, E> DisplayListSource<I>
where
    I: Iterator<Item = Result<(Control, Option<u64>), E>>,
    E: Display,
{
    /// Replays these.
    pub fn new(config: DisplayListConfig, mut commands: I) -> Self {
        let next = commands.next().map(|command| due(command, 0));
        Self { config, state: DisplayListState::default(), commands, next }
    }
}

fn due<E: Display>(command: Result<(Control, Option<u64>), E>, earliest: u64) -> Result<Due, String> {
    let (control, arrival) = command.map_err(|e| e.to_string())?;
    Ok((control, arrival.unwrap_or(0).min(LATEST).max(earliest)))
}

impl<I, E> Unit for DisplayListSource<I>
where
    I: Iterator<Item = Result<(Control, Option<u64>), E>>,
    E: Display,
{
    type In = ();
    type Out = Option<Control>;

    fn demand(&self) -> Demand {
        if self.next.is_some() { Demand::Nothing } else { Demand::Finished }
    }

    fn step(&mut self, (): (), traffic: &mut Traffic) -> Step<Self::Out> {
        let (control, now) = match self.next.take() {
            Some(Ok(command)) => command,
            Some(Err(message)) => {
                traffic.fault(message);
                return Step::after(0, None);
            }
            None => return Step::after(0, None),
        };
        self.next = self.commands.next().map(|command| due(command, now + 1));
        self.state.commands += 1;
        if self.config.arrival == Arrival::Asap {
            return Step::after(0, Some(control));
        }
        // Each step starts when its command is due; only the first starts at 0, and makes up for it by latency.
        let start = self.state.elapsed;
        let end = if let Some(Ok((_, next))) = &self.next { *next } else { now + 1 };
        self.state.elapsed = end;
        Step::after(now - start, Some(control)).busy(end - start)
    }

    fn is_empty(&self) -> bool {
        self.next.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::{Camera, Mesh, Object};

    #[test]
    fn a_scene_is_drawn_frame_by_frame_object_by_object() {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0; 3], to_viewer: [0.0; 3] };
        let frame = |index| Arc::new(Frame { index, width: 1, height: 1, camera, lights: Vec::new(), textures: Vec::new() });
        let object = |id, triangles: u32| {
            let mesh = Arc::new(Mesh { indices: vec![0; 3 * triangles as usize], ..Mesh::default() });
            let name = String::new();
            Arc::new(Object { id, name, mesh, world: [0.0; 16], material: Arc::default(), entries: None, bump: None })
        };
        let scene = Scene { frames: vec![frame(0), frame(1)], objects: vec![object(0, 2), object(1, 0)], ..Scene::default() };
        let mut source = SceneSource::new(SceneDraws::new(Arc::new(scene)));
        let mut seen = String::new();
        while source.demand() == Demand::Nothing {
            seen.push_str(&match source.step((), &mut Traffic::default()).out {
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

    /// Unblocked delivery cycles of commands with these recorded ones.
    fn delivered(arrival: Arrival, recorded: &[Option<u64>]) -> Vec<u64> {
        let commands = recorded.iter().map(|a| Ok::<_, String>((Control::FrameEnd, *a)));
        let mut source = DisplayListSource::new(DisplayListConfig { arrival }, commands);
        let (mut free, mut all) = (0, Vec::new());
        while source.demand() == Demand::Nothing {
            let step = source.step((), &mut Traffic::default());
            assert!(step.out.is_some() && step.occupancy >= 1);
            all.push(free + step.latency);
            free += step.occupancy;
        }
        all
    }

    #[test]
    fn recorded_commands_come_at_their_cycles() {
        let at = |recorded: &[Option<u64>]| delivered(Arrival::Recorded, recorded);
        assert_eq!(at(&[Some(32), Some(33), Some(50), Some(1000)]), [32, 33, 50, 1000]);
        assert_eq!(at(&[None, None, Some(50), None, Some(52)]), [0, 1, 50, 51, 52]);
        assert_eq!(at(&[Some(9), Some(3), Some(9), Some(20)]), [9, 10, 11, 20]);
        assert_eq!(at(&[Some(7)]), [7]);
        assert_eq!(delivered(Arrival::Asap, &[Some(32), None, Some(1000)]), [0, 1, 2]);
    }

    #[test]
    fn an_error_in_the_list_ends_the_run_with_its_message() {
        for good in 0..3 {
            let list = (0..good).map(|_| Ok((Control::FrameEnd, None))).chain([Err("line 7: truncated")]);
            let mut source = DisplayListSource::new(DisplayListConfig::default(), list);
            for _ in 0..good {
                assert!(source.step((), &mut Traffic::default()).out.is_some());
            }
            assert_eq!(source.demand(), Demand::Nothing);
            let mut traffic = Traffic::default();
            assert_eq!(source.step((), &mut traffic).out, None);
            assert!(format!("{traffic:?}").contains("line 7: truncated"));
            assert_eq!(source.demand(), Demand::Finished);
            assert!(source.is_empty());
        }
    }

    #[test]
    fn absurd_cycles_do_not_overflow() {
        let absurd = [Some(u64::MAX), Some(u64::MAX), None];
        assert_eq!(delivered(Arrival::Recorded, &absurd), [LATEST, LATEST + 1, LATEST + 2]);
    }
}
