//! Flow of origins through the FIFOs.
//!
//! A token has the origin that its own label states. Otherwise it inherits the origin of the token that it was made from.
//! A step belongs to the token that it takes. Its outputs belong to the same origin unless their labels say more: for example, the
//! addresses that a divider passes on belong to the pixels of its input point, although a quotient has no pixels. A step without an
//! input, for example of a rasterizer that continues a polygon, takes its origin from its outputs.

use super::origin::{TokenOrigin, TokenSample};
use super::polygon_index::PolygonIndex;
use basrelief_input::{MemoryPool, OverBudget};
use basrelief_kernel::{Label, StageTopology};
use basrelief_machines::CostPoints;
use basrelief_signals::Attribution;
use std::collections::VecDeque;

/// Receiver of the events of a flow, in the order of the work.
pub(crate) trait FlowEvents {
    /// A frame of this width and height begins.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    fn on_frame(&mut self, size: [u32; 2]) -> Result<(), OverBudget>;
    /// A polygon enters the machine.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    fn on_polygon(&mut self, origin: &TokenOrigin) -> Result<(), OverBudget>;
    /// Fragments are created.
    fn on_fragments(&mut self, origin: &TokenOrigin);
    /// Visible pixels are finished.
    fn on_visible_pixels(&mut self, origin: &TokenOrigin);
    /// A unit takes a token.
    fn on_token_taken(&mut self, origin: &TokenOrigin);
}

/// Numbers of the FIFOs of a stage.
struct StageFifos {
    inputs: Vec<usize>,
    outputs: Vec<usize>,
}

/// A step: its stage, the inputs from which it took a token (one bit each), and the outputs that it wrote, with labels.
pub(crate) struct StepTokens<'a> {
    pub(crate) stage: usize,
    pub(crate) taken: u32,
    pub(crate) given: &'a [(usize, Label)],
}

/// Origins of the tokens in all FIFOs.
pub(crate) struct TokenFlow {
    stages: Vec<StageFifos>,
    fifos: Vec<VecDeque<TokenOrigin>>,
    /// Origin of each stage's last step that took a token or emitted a control token.
    current: Vec<TokenOrigin>,
    /// FIFO by which polygons enter.
    enter: Option<usize>,
    /// FIFO that fragments enter first.
    drawn: Option<usize>,
    /// FIFO that visible pixels end in.
    shown: Option<usize>,
    polygons: PolygonIndex,
    sample: Option<TokenSample>,
    /// Number of tokens so far from which the sample is taken.
    lives: u64,
    /// Number of frames so far.
    frames: u32,
}

impl TokenFlow {
    pub(crate) fn new(stages: &[StageTopology], points: CostPoints, sample: Option<TokenSample>, budget: &MemoryPool) -> Self {
        let mut names: Vec<&str> = stages.iter().flat_map(|s| &s.outputs).map(String::as_str).collect();
        names.sort_unstable();
        let number = |name: &str| names.binary_search(&name).ok();
        let numbers = |list: &[String]| list.iter().filter_map(|name| number(name)).collect();
        Self {
            stages: stages.iter().map(|s| StageFifos { inputs: numbers(&s.inputs), outputs: numbers(&s.outputs) }).collect(),
            current: vec![TokenOrigin::default(); stages.len()],
            enter: number("polygons"),
            drawn: number(points.drawn),
            shown: points.shown.iter().find_map(|name| number(name)),
            fifos: vec![VecDeque::new(); names.len()],
            polygons: PolygonIndex::new(budget),
            sample,
            lives: 0,
            frames: 0,
        }
    }

    /// Moves the origins of a step's tokens, and returns the origin of the step.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    pub(crate) fn step(&mut self, step: &StepTokens<'_>, events: &mut dyn FlowEvents) -> Result<TokenOrigin, OverBudget> {
        let stage = step.stage;
        let taken = self.take(step, events);
        let mut owner = taken;
        for &(output, label) in step.given {
            let Some(&fifo) = self.stages[stage].outputs.get(output) else { continue };
            let about = Attribution::from(label.0);
            if let Attribution::Frame { index, size } = about {
                events.on_frame(size)?;
                self.frames = self.frames.max(index.saturating_add(1));
            }
            let current = self.current[stage];
            let mut origin = match about {
                Attribution::Polygon(address) if self.enter == Some(fifo) => {
                    let entered = self.polygons.enter(address, &current)?;
                    events.on_polygon(&entered)?;
                    // The polygon is created here; the input was a triangle of the object.
                    owner = Some(entered);
                    entered
                }
                about => labelled_origin(about, current, &self.polygons),
            };
            if taken.is_none() {
                owner = Some(owner.map_or(origin, |owner| owner.or_finer(origin)));
                if !matches!(about, Attribution::Inherited | Attribution::Pixels(_) | Attribution::Levels(_)) {
                    self.current[stage] = origin;
                }
            }
            if self.drawn == Some(fifo) {
                events.on_fragments(&origin);
            }
            self.sample(fifo, &mut origin);
            self.fifos[fifo].push_back(origin);
        }
        Ok(owner.unwrap_or(self.current[stage]))
    }

    /// Returns the number of frames so far.
    pub(crate) fn frames(&self) -> u64 {
        self.frames.into()
    }

    /// Starts to trace a token that enters a FIFO if it belongs to the sample.
    fn sample(&mut self, fifo: usize, origin: &mut TokenOrigin) {
        let Some(sample) = self.sample else { return };
        let begins = if sample.polygons { self.enter } else { self.drawn };
        if begins == Some(fifo) && origin.is_candidate(sample) {
            origin.life = self.lives.is_multiple_of(sample.every.get()).then_some(self.lives);
            self.lives += 1;
        } else if self.drawn == Some(fifo) {
            // The trace of a polygon ends where its fragments are created.
            origin.life = None;
        }
    }

    /// Removes the input tokens of a step, and returns their origin; `None` if there are none.
    fn take(&mut self, step: &StepTokens<'_>, events: &mut dyn FlowEvents) -> Option<TokenOrigin> {
        let Self { stages, fifos, current, shown, .. } = self;
        let inputs = stages[step.stage].inputs.iter().enumerate().filter(|(i, _)| step.taken >> i & 1 == 1);
        let mut owner: Option<TokenOrigin> = None;
        for (_, &fifo) in inputs {
            let origin = fifos[fifo].pop_front().unwrap_or_default();
            if *shown == Some(fifo) {
                events.on_visible_pixels(&origin);
            }
            owner = Some(owner.map_or(origin, |owner| owner.or_finer(origin)));
        }
        if let Some(owner) = &owner {
            events.on_token_taken(owner);
            current[step.stage] = *owner;
        }
        owner
    }
}

/// Returns the origin of a token with this label, made by a step of `owner`.
fn labelled_origin(label: Attribution, owner: TokenOrigin, polygons: &PolygonIndex) -> TokenOrigin {
    match label {
        Attribution::Inherited => owner,
        Attribution::Levels(levels) => TokenOrigin { levels: Some(levels), ..owner },
        Attribution::Pixels(pixels) => owner.at(pixels),
        Attribution::Frame { index, .. } => TokenOrigin::whole(Some(index)),
        Attribution::Whole => TokenOrigin::whole(owner.frame),
        Attribution::Object(object) => TokenOrigin { object: Some(object), ..TokenOrigin::whole(owner.frame) },
        // A polygon that is not in the list, for example a part of one, belongs to the origin that it was made from.
        Attribution::Polygon(address) => {
            let polygon = polygons.origin(address).unwrap_or(TokenOrigin { pixels: None, levels: None, ..owner });
            TokenOrigin { life: owner.life, ..polygon }
        }
    }
}
