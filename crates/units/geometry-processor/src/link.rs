//! The link that polygons go by.

use basrelief_signals::{Control, VertexAttributes};

/// What hands polygons on to a machine: so many bytes per cycle, of what the machine takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolygonLink {
    /// `geometry.link_bytes`.
    pub bytes_per_cycle: u32,
    /// What the machine takes of vertices.
    pub taken: VertexAttributes,
}

impl PolygonLink {
    /// Bytes of a polygon; other commands take a cycle, and no bytes are counted for them.
    pub(crate) fn bytes(&self, control: &Control) -> u64 {
        if let Control::Polygon(polygon) = control { polygon.bytes(self.taken) } else { 0 }
    }

    /// Cycles that so many bytes keep it, and at least one.
    pub(crate) fn cycles(&self, bytes: u64) -> u64 {
        bytes.div_ceil(u64::from(self.bytes_per_cycle.max(1))).max(1)
    }
}

/// What figure `polygon_bytes` is.
pub(crate) const POLYGON_BYTES: &str = "Polygons on the link from the geometry processor";
