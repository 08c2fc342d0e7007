//! State of the geometry processor (102) between steps.

use crate::transform::{ClipCorner, ObjectTransform};
use basrelief_shading::LightVector;
use basrelief_signals::{Frame, Object};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Counters of the geometry processor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GeometryProcessorCounters {
    /// Triangles received. Each is outside, culled, degenerate or becomes a polygon.
    pub triangles: u64,
    /// Triangles outside the view volume.
    pub outside: u64,
    /// Triangles facing away.
    pub culled: u64,
    /// Triangles dropped by the rule of [`crate::GeometryProcessor`].
    pub degenerate: u64,
    /// Triangles cut by the view volume or the guard band.
    pub clipped: u64,
    /// Polygons sent.
    pub polygons: u64,
    /// Polygons sent that are bump targets.
    pub bump_polygons: u64,
    /// Vertices transformed.
    pub vertices: u64,
    /// Vertices found in the vertex cache.
    pub vertex_cache_hits: u64,
    /// Vertices lit for polygons that are not bump targets. A vertex stays lit in the vertex cache.
    pub vertices_lit: u64,
    /// Bytes of vertices and indices fetched.
    pub vertex_bytes: u64,
    /// Bytes of polygons on the link.
    pub polygon_bytes: u64,
}

/// Cache of transformed vertices of the current object, first in, first out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VertexCache {
    indices: Vec<u32>,
    corners: Vec<ClipCorner>,
    /// True for entries that have their brightness.
    lit: Vec<bool>,
    /// Position of the entry to be replaced next in a full cache.
    oldest: usize,
}

impl VertexCache {
    /// Returns the transformed vertex on a hit.
    #[inline]
    pub fn get(&self, index: u32) -> Option<&ClipCorner> {
        self.corners.get(self.place(index)?)
    }

    /// Returns the position of a vertex. The search starts at the newest entry, because neighbours in a mesh share vertices.
    fn place(&self, index: u32) -> Option<usize> {
        let (newer, older) = self.indices.split_at(self.oldest);
        let place = |of: &[u32]| of.iter().rposition(|i| *i == index);
        place(newer).or_else(|| Some(newer.len() + place(older)?))
    }

    /// Inserts a vertex that is not present. `entries` is the size of the cache.
    #[inline]
    pub fn insert(&mut self, index: u32, corner: &ClipCorner, entries: usize) {
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

    /// Marks a present vertex as lit. Returns true if it was lit already.
    pub fn light(&mut self, index: u32) -> bool {
        self.place(index).and_then(|place| self.lit.get_mut(place)).is_some_and(|lit| std::mem::replace(lit, true))
    }

    /// Empties the cache, because indices belong to one object.
    pub fn clear(&mut self) {
        self.indices.clear();
        self.corners.clear();
        self.lit.clear();
        self.oldest = 0;
    }
}

/// State of the geometry processor between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GeometryProcessorState {
    /// The current frame.
    pub frame: Option<Arc<Frame>>,
    /// The current object.
    pub object: Option<Arc<Object>>,
    /// Matrices of the object in this frame.
    pub transform: ObjectTransform,
    /// LOD of the object if all its polygons share one.
    pub object_lod: Option<u8>,
    /// Lights as seen from the object's centre.
    pub lights: Vec<LightVector>,
    /// Cache of the object's vertices.
    pub cache: VertexCache,
    /// Cycles of occupancy of all steps so far: the start of the next step if nothing had ever blocked or starved the unit.
    pub elapsed: u64,
    /// Cycle at which the last step would then have delivered its result.
    pub arrival: u64,
    /// Counters.
    pub counters: GeometryProcessorCounters,
}
