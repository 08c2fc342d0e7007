//! State of the geometry processor (102).

use crate::transform::{Corner, Transform};
use basrelief_shading::LightVector;
use basrelief_signals::{Frame, Object};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What the geometry processor has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GeometryProcessorCounters {
    /// Triangles taken; each is outside, culled, degenerate or becomes a polygon.
    pub triangles: u64,
    /// Outside the view volume.
    pub outside: u64,
    /// Facing away.
    pub culled: u64,
    /// Dropped by the rule of [`crate::GeometryProcessor`].
    pub degenerate: u64,
    /// Cut by the view volume or the guard band.
    pub clipped: u64,
    /// Polygons handed on.
    pub polygons: u64,
    /// Of these, bump targets.
    pub bump_polygons: u64,
    /// Vertices transformed.
    pub vertices: u64,
    /// Vertices found in the vertex cache.
    pub vertex_cache_hits: u64,
    /// Lit for a polygon that is no bump target; a vertex stays lit in the vertex cache.
    pub vertices_lit: u64,
    /// Fetched of vertices and indices \[bytes\].
    pub vertex_bytes: u64,
    /// Polygons on the link \[bytes\].
    pub polygon_bytes: u64,
}

/// Transformed vertices of the current object, first in, first out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VertexCache {
    indices: Vec<u32>,
    corners: Vec<Corner>,
    /// Which have their brightness, too.
    lit: Vec<bool>,
    /// The entry that goes next, once all are taken.
    oldest: usize,
}

impl VertexCache {
    /// The transformed vertex, if it is there.
    pub fn get(&self, index: u32) -> Option<&Corner> {
        self.corners.get(self.place(index)?)
    }

    /// Where a vertex is, looked for among the newest first: neighbours in a mesh share them.
    fn place(&self, index: u32) -> Option<usize> {
        let (newer, older) = self.indices.split_at(self.oldest);
        let place = |of: &[u32]| of.iter().rposition(|i| *i == index);
        place(newer).or_else(|| Some(newer.len() + place(older)?))
    }

    /// Takes in a vertex that is not there; `entries` is the size of the cache.
    pub fn insert(&mut self, index: u32, corner: &Corner, entries: usize) {
        if self.indices.len() < entries {
            self.indices.push(index);
            self.corners.push(*corner);
            self.lit.push(false);
        } else if let (Some(i), Some(c)) = (self.indices.get_mut(self.oldest), self.corners.get_mut(self.oldest)) {
            *i = index;
            *c = *corner;
            self.lit[self.oldest] = false;
            self.oldest = (self.oldest + 1) % entries;
        }
    }

    /// Lights a vertex that is there; whether its brightness was known.
    pub fn light(&mut self, index: u32) -> bool {
        self.place(index).and_then(|place| self.lit.get_mut(place)).is_some_and(|lit| std::mem::replace(lit, true))
    }

    /// Empties it: indices are the object's.
    pub fn clear(&mut self) {
        self.indices.clear();
        self.corners.clear();
        self.lit.clear();
        self.oldest = 0;
    }
}

/// Everything the geometry processor remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GeometryProcessorState {
    /// The current frame.
    pub frame: Option<Arc<Frame>>,
    /// The current object.
    pub object: Option<Arc<Object>>,
    /// Its matrices in this frame.
    pub transform: Transform,
    /// Its LOD, where all its polygons have one.
    pub object_lod: Option<u8>,
    /// The lights as seen from its centre.
    pub lights: Vec<LightVector>,
    /// Its vertices that are kept.
    pub cache: VertexCache,
    /// Cycles that the steps so far have kept the unit: where the next would start, had nothing ever blocked or starved it.
    pub elapsed: u64,
    /// Cycle at which the last step would have delivered then.
    pub arrival: u64,
    /// What it has counted.
    pub counters: GeometryProcessorCounters,
}
