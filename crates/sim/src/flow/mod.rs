//! Who is behind each token: what it says itself, and otherwise what the token said that it was made of.
//!
//! A step is for the token that it takes. What it gives is for the same, unless the token given says more: so the addresses that a
//! divider hands on are for the pixels of the point that it took, though a quotient does not know them. Of a step that takes nothing,
//! as when a rasterizer goes on with its polygon, what it gives says for whom it is.

mod entered;
mod origin;

pub(crate) use origin::{Origin, Polygon};

use crate::costs::CostPoints;
use crate::following::Sample;
use basrelief_input::{Budget, OverBudget};
use basrelief_kernel::{Label, StageTopology};
use basrelief_signals::Attribution;
use entered::Entered;
use std::collections::VecDeque;

/// Follows tokens: told in the order of the work.
pub(crate) trait Follower {
    /// A frame of this width and height begins.
    ///
    /// # Errors
    /// More than may be held.
    fn frame(&mut self, size: [u32; 2]) -> Result<(), OverBudget>;
    /// A polygon enters.
    ///
    /// # Errors
    /// More than may be held.
    fn entered(&mut self, origin: &Origin) -> Result<(), OverBudget>;
    /// Fragments come into being.
    fn drawn(&mut self, origin: &Origin);
    /// Pixels come to where the visible ones end.
    fn shown(&mut self, origin: &Origin);
    /// A unit takes a token.
    fn taken(&mut self, origin: &Origin);
}

/// Numbers of the FIFOs of a stage.
struct Ends {
    inputs: Vec<usize>,
    outputs: Vec<usize>,
}

/// Who is behind each token in each FIFO.
pub(crate) struct Flow {
    stages: Vec<Ends>,
    fifos: Vec<VecDeque<Origin>>,
    /// Of each stage, whom its last step was for that took a token, or gave control.
    current: Vec<Origin>,
    /// FIFOs that polygons enter by, in which fragments come into being, and that end in the picture.
    enter: Option<usize>,
    drawn: Option<usize>,
    shown: Option<usize>,
    entered: Entered,
    /// Tokens of which the life is told one by one, and how many there were to choose from so far.
    sample: Option<Sample>,
    lives: u64,
    /// Frames begun.
    frames: u32,
}

impl Flow {
    pub(crate) fn new(stages: &[StageTopology], points: CostPoints, sample: Option<Sample>, budget: &Budget) -> Self {
        let mut names: Vec<&str> = stages.iter().flat_map(|s| &s.outputs).map(String::as_str).collect();
        names.sort_unstable();
        let number = |name: &str| names.binary_search(&name).ok();
        let numbers = |list: &[String]| list.iter().filter_map(|name| number(name)).collect();
        Self {
            stages: stages.iter().map(|s| Ends { inputs: numbers(&s.inputs), outputs: numbers(&s.outputs) }).collect(),
            current: vec![Origin::default(); stages.len()],
            enter: number("polygons"),
            drawn: number(points.drawn),
            shown: points.shown.iter().find_map(|name| number(name)),
            fifos: vec![VecDeque::new(); names.len()],
            entered: Entered::new(budget),
            sample,
            lives: 0,
            frames: 0,
        }
    }

    /// Whom a step is for that takes a token from each of these inputs, one bit each, and gives tokens of these labels.
    ///
    /// # Errors
    /// More than may be held.
    pub(crate) fn step(
        &mut self,
        (stage, taken): (usize, u32),
        given: &[(usize, Label)],
        follower: &mut impl Follower,
    ) -> Result<Origin, OverBudget> {
        let taken = self.take(stage, taken, follower);
        let mut whose = taken;
        for &(output, label) in given {
            let Some(&fifo) = self.stages[stage].outputs.get(output) else { continue };
            let about = Attribution::from(label.0);
            if let Attribution::Frame { index, size } = about {
                follower.frame(size)?;
                self.frames = self.frames.max(index.saturating_add(1));
            }
            let current = self.current[stage];
            let mut origin = match about {
                Attribution::Polygon(place) if self.enter == Some(fifo) => {
                    let entered = self.entered.enter(place, &current)?;
                    follower.entered(&entered)?;
                    // It is here that there is a polygon: what was taken is a triangle of the object.
                    whose = Some(entered);
                    entered
                }
                about => about_whom(about, current, &self.entered),
            };
            if taken.is_none() {
                whose = Some(whose.map_or(origin, |whose| whose.or_finer(origin)));
                if !matches!(about, Attribution::Inherited | Attribution::Pixels(_) | Attribution::Levels(_)) {
                    self.current[stage] = origin;
                }
            }
            if self.drawn == Some(fifo) {
                follower.drawn(&origin);
            }
            self.follow(fifo, &mut origin);
            self.fifos[fifo].push_back(origin);
        }
        Ok(whose.unwrap_or(self.current[stage]))
    }

    /// Frames begun so far.
    pub(crate) fn frames(&self) -> u64 {
        self.frames.into()
    }

    /// A token comes into a FIFO: where lives begin, one in so many is followed from now on.
    fn follow(&mut self, fifo: usize, origin: &mut Origin) {
        let Some(sample) = self.sample else { return };
        let begins = if sample.polygons { self.enter } else { self.drawn };
        if begins == Some(fifo) && origin.is_of(sample) {
            origin.life = self.lives.is_multiple_of(sample.every.get()).then_some(self.lives);
            self.lives += 1;
        } else if self.drawn == Some(fifo) {
            // What is drawn of a polygon has a life of its own.
            origin.life = None;
        }
    }

    /// Takes tokens out; whom they are for, if there are any.
    fn take(&mut self, stage: usize, taken: u32, follower: &mut impl Follower) -> Option<Origin> {
        let Self { stages, fifos, current, shown, .. } = self;
        let inputs = stages[stage].inputs.iter().enumerate().filter(|(i, _)| taken >> i & 1 == 1);
        let mut whose: Option<Origin> = None;
        for (_, &fifo) in inputs {
            let origin = fifos[fifo].pop_front().unwrap_or_default();
            if *shown == Some(fifo) {
                follower.shown(&origin);
            }
            whose = Some(whose.map_or(origin, |whose| whose.or_finer(origin)));
        }
        if let Some(whose) = &whose {
            follower.taken(whose);
            current[stage] = *whose;
        }
        whose
    }
}

/// Whom a token is for that says this and is given by a step for `whom`.
fn about_whom(about: Attribution, whom: Origin, entered: &Entered) -> Origin {
    match about {
        Attribution::Inherited => whom,
        Attribution::Levels(levels) => Origin { levels: Some(levels), ..whom },
        Attribution::Pixels(pixels) => whom.at(pixels),
        Attribution::Frame { index, .. } => Origin::whole(Some(index)),
        Attribution::Whole => Origin::whole(whom.frame),
        Attribution::Object(object) => Origin { object: Some(object), ..Origin::whole(whom.frame) },
        // One that is none of the list's own is for that which it was made of.
        Attribution::Polygon(place) => {
            let polygon = entered.origin(place).unwrap_or(Origin { pixels: None, levels: None, ..whom });
            Origin { life: whom.life, ..polygon }
        }
    }
}
