//! Link for polygons.

use basrelief_signals::{Control, VertexAttributes};

/// Link that sends polygons to a machine: its bandwidth, and the attributes sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolygonLink {
    /// `geometry.link_bytes`.
    pub bytes_per_cycle: u32,
    /// Vertex attributes that the machine accepts.
    pub taken: VertexAttributes,
}

impl PolygonLink {
    /// Returns the bytes of a polygon. Other commands take one cycle and count no bytes.
    pub(crate) fn bytes(&self, control: &Control) -> u64 {
        if let Control::Polygon(polygon) = control { polygon.bytes(self.taken) } else { 0 }
    }

    /// Returns the cycles for this many bytes, at least one.
    pub(crate) fn cycles(&self, bytes: u64) -> u64 {
        bytes.div_ceil(u64::from(self.bytes_per_cycle.max(1))).max(1)
    }
}

/// Description of the figure `polygon_bytes`.
pub(crate) const POLYGON_BYTES: &str = "Polygons on the link from the geometry processor";
