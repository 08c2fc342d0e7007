//! State of the rasterizer.

use basrelief_shading::PolygonScan;
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Counters of the rasterizer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RasterizerCounters {
    /// Polygons received.
    pub polygons: u64,
    /// Triangles of their fans.
    pub triangles: u64,
    /// Fragments emitted.
    pub fragments: u64,
    /// Of these, fragments of bump targets.
    pub bump_fragments: u64,
}

/// State of the rasterizer between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RasterizerState {
    /// Width and height of the frame \[pixels\].
    pub screen: [u32; 2],
    /// Polygon in progress, if any. The scan stands on its next fragment.
    pub polygon: Option<Arc<Polygon>>,
    /// Traversal of the polygon.
    pub scan: PolygonScan,
    /// Counters.
    pub counters: RasterizerCounters,
}
