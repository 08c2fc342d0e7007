//! State of the graphics processor (104).

use basrelief_shading::LevelPlace;
use basrelief_signals::{Control, Fragment, Polygon, ShadedFragment, Stamp};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Input of the next step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum InputPhase {
    /// No fragments can come: the next control token, from input 0.
    #[default]
    Control,
    /// Fragments of a polygon, or the control token that ends them, from this input.
    Fragments(usize),
    /// The duplicate of a control token, from this input.
    Twin(usize),
}

/// An item that waits to be drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum HeldItem {
    /// Control. It needs no memory, because the host keeps the display list.
    Control(Control),
    /// Fragments of a bump target with their brightness, one entry each.
    Bump(Stamp<ShadedFragment>),
    /// Fragments of another polygon. They need no memory, because they are found again in the display list when it is drawn.
    Plain(Stamp<Fragment>),
}

/// Counters of the graphics processor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphicsProcessorCounters {
    /// Pixels drawn.
    pub pixels: u64,
    /// Pixels drawn with a colour texture.
    pub textured: u64,
    /// Fragments with an entry that waited for the end of their list.
    pub held: u64,
}

/// State of the graphics processor between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GraphicsProcessorState {
    /// Next input.
    pub phase: InputPhase,
    /// Control token whose duplicate is awaited.
    pub pending: Option<Control>,
    /// Polygon being drawn.
    pub polygon: Option<Arc<Polygon>>,
    /// MIP level of the polygon's colour texture.
    pub level: usize,
    /// Position of that level, from the start of the colour textures.
    pub place: LevelPlace,
    /// Items that wait for the end of the list, in order.
    pub held: VecDeque<HeldItem>,
    /// True after the end of the list: waiting items are being drawn.
    pub drawing: bool,
    /// Cycles from one pixel of the polygon to the next.
    pub pace: u64,
    /// Number of waiting fragments.
    pub waiting: u64,
    /// Bytes of entries stored since the list began.
    pub bytes_held: u64,
    /// Bytes of entries drawn since the list began.
    pub bytes_drawn: u64,
    /// Counters.
    pub counters: GraphicsProcessorCounters,
}

impl HeldItem {
    /// Returns the number of fragments.
    pub fn fragments(&self) -> usize {
        match self {
            Self::Control(_) => 0,
            Self::Bump(stamp) => stamp.len(),
            Self::Plain(stamp) => stamp.len(),
        }
    }
}
