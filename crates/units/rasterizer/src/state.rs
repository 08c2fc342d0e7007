//! State of the rasterizer.

use basrelief_shading::Scan;
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What the rasterizer has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RasterizerCounters {
    /// Polygons taken.
    pub polygons: u64,
    /// Triangles of their fans.
    pub triangles: u64,
    /// Fragments emitted.
    pub fragments: u64,
    /// Of these, fragments of bump targets.
    pub bump_fragments: u64,
}

/// Everything the rasterizer remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RasterizerState {
    /// Width and height of the frame \[pixels\].
    pub screen: [u32; 2],
    /// The polygon that is part-way, if any; the scan stands on its next fragment.
    pub polygon: Option<Arc<Polygon>>,
    /// Its traversal.
    pub scan: Scan,
    /// What it has counted.
    pub counters: RasterizerCounters,
}
