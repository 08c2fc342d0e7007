//! Who is behind each token: what it says itself, and otherwise what the token said that it was made of.
//!
//! A step is for the token that it takes. What it gives is for the same, unless the token given says more: so the addresses that a
//! divider hands on are for the pixels of the point that it took, though a quotient does not know them. Of a step that takes nothing,
//! as when a rasterizer goes on with its polygon, what it gives says for whom it is.

use super::CostPoints;
use super::drawing::Drawing;
use super::origin::Origin;
use super::polygons::Polygons;
use basrelief_input::{Held, OverBudget};
use basrelief_kernel::{Label, StageTopology};
use basrelief_signals::About;
use std::collections::VecDeque;

/// Numbers of the FIFOs of a stage.
struct Ends {
    inputs: Vec<usize>,
    outputs: Vec<usize>,
}

/// Who is behind each token in each FIFO.
pub(super) struct Flow {
    stages: Vec<Ends>,
    fifos: Vec<VecDeque<Origin>>,
    /// Of each stage, whom its last step was for that took a token, or gave control.
    current: Vec<Origin>,
    /// FIFOs that polygons enter by, in which fragments come into being, and that end in the picture.
    enter: Option<usize>,
    drawn: Option<usize>,
    shown: Option<usize>,
    /// Frames begun.
    frames: u32,
}

impl Flow {
    pub(super) fn new(stages: &[StageTopology], points: CostPoints) -> Self {
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
            frames: 0,
        }
    }

    /// Whom a step is for that takes a token from each of these inputs, one bit each, and gives tokens of these labels.
    ///
    /// # Errors
    /// More than may be held.
    pub(super) fn step(
        &mut self,
        (stage, taken): (usize, u32),
        given: &[(usize, Label)],
        (drawing, polygons): (&mut Drawing, &mut Polygons),
        held: &mut Held,
    ) -> Result<Origin, OverBudget> {
        let taken = self.take(stage, taken, drawing);
        let mut whose = taken;
        for &(output, label) in given {
            let Some(&fifo) = self.stages[stage].outputs.get(output) else { continue };
            let about = About::from(label.0);
            if let About::Frame { index, size } = about {
                drawing.begin(size, held)?;
                self.frames = self.frames.max(index.saturating_add(1));
            }
            let current = self.current[stage];
            let origin = match about {
                About::Polygon(place) if self.enter == Some(fifo) => {
                    let entered = polygons.enter(place, &current, held)?;
                    // It is here that there is a polygon: what was taken is a triangle of the object.
                    whose = Some(entered);
                    entered
                }
                about => about_whom(about, current, polygons),
            };
            if taken.is_none() {
                whose = Some(whose.map_or(origin, |whose| whose.or_finer(origin)));
                if !matches!(about, About::Made | About::Pixels(_) | About::Levels(_)) {
                    self.current[stage] = origin;
                }
            }
            if self.drawn == Some(fifo) {
                drawing.draw(&origin);
                polygons.draw(&origin);
            }
            self.fifos[fifo].push_back(origin);
        }
        Ok(whose.unwrap_or(self.current[stage]))
    }

    /// Frames begun so far.
    pub(super) fn frames(&self) -> u64 {
        self.frames.into()
    }

    /// Takes tokens out; whom they are for, if there are any.
    fn take(&mut self, stage: usize, taken: u32, drawing: &mut Drawing) -> Option<Origin> {
        let Self { stages, fifos, current, shown, .. } = self;
        let inputs = stages[stage].inputs.iter().enumerate().filter(|(i, _)| taken >> i & 1 == 1);
        let mut whose: Option<Origin> = None;
        for (_, &fifo) in inputs {
            let origin = fifos[fifo].pop_front().unwrap_or_default();
            if *shown == Some(fifo) {
                drawing.show(&origin);
            }
            whose = Some(whose.map_or(origin, |whose| whose.or_finer(origin)));
        }
        if let Some(whose) = &whose {
            drawing.note(whose);
            current[stage] = *whose;
        }
        whose
    }
}

/// Whom a token is for that says this and is given by a step for `whom`.
fn about_whom(about: About, whom: Origin, polygons: &Polygons) -> Origin {
    match about {
        About::Made => whom,
        About::Levels(levels) => Origin { levels: Some(levels), ..whom },
        About::Pixels(pixels) => whom.at(pixels),
        About::Frame { index, .. } => Origin::whole(Some(index)),
        About::Whole => Origin::whole(whom.frame),
        About::Object(object) => Origin { object: Some(object), ..Origin::whole(whom.frame) },
        // One that is none of the list's own is for that which it was made of.
        About::Polygon(place) => polygons.origin(place).unwrap_or(Origin { pixels: None, levels: None, ..whom }),
    }
}
