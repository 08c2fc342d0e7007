//! State of the graphics processor (104).

use basrelief_shading::LevelPlace;
use basrelief_signals::{Control, Fragment, Polygon, ShadedFragment, Stamp};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Which input the next step takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// No fragments can come: the next control token, from input 0.
    #[default]
    Control,
    /// Fragments of a polygon, or the control token that ends them, from this input.
    Fragments(usize),
    /// The twin, from this input, of a control token.
    Twin(usize),
}

/// What waits to be drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Held {
    /// Control; costs no room, as the display list is kept by the host.
    Control(Control),
    /// Fragments of a bump target, with their brightness: an entry each.
    Bump(Stamp<ShadedFragment>),
    /// Fragments of another polygon; cost no room, as they are found in the display list when that is drawn.
    Plain(Stamp<Fragment>),
}

/// What the graphics processor has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphicsProcessorCounters {
    /// Pixels drawn.
    pub pixels: u64,
    /// Of these, with a colour texture.
    pub textured: u64,
    /// Fragments of which an entry waited for the end of their list.
    pub held: u64,
}

/// Everything the graphics processor remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GraphicsProcessorState {
    /// What is taken next.
    pub phase: Phase,
    /// The control token whose twin is awaited.
    pub pending: Option<Control>,
    /// The polygon that is being drawn.
    pub polygon: Option<Arc<Polygon>>,
    /// MIP level of its colour texture.
    pub level: usize,
    /// Where that level lies, from the start of the colour textures.
    pub place: LevelPlace,
    /// What waits for the end of the list, in order.
    pub held: VecDeque<Held>,
    /// The end has come: what is held is being drawn.
    pub drawing: bool,
    /// Cycles from one pixel of the polygon to the next.
    pub pace: u64,
    /// Fragments that wait.
    pub waiting: u64,
    /// What of their entries came since the list began \[bytes\].
    pub bytes_held: u64,
    /// What of that was drawn \[bytes\].
    pub bytes_drawn: u64,
    /// What it has counted.
    pub counters: GraphicsProcessorCounters,
}

impl Held {
    /// Fragments in it.
    pub fn fragments(&self) -> usize {
        match self {
            Self::Control(_) => 0,
            Self::Bump(stamp) => stamp.len(),
            Self::Plain(stamp) => stamp.len(),
        }
    }
}
