//! Rasterization of polygons in window coordinates: exact coverage, top-left rule, fixed pixel order.
//!
//! A polygon is a fan around its first vertex. Each triangle of the fan is [set up](Triangle) and [walked](Walk). Units that
//! [scan](Scan) the same polygon on the same [raster](Raster) visit the same pixels in the same order.

mod polygon;
mod spans;
mod triangle;
mod walk;

pub use polygon::{Scan, fan_triangles};
pub use spans::Spans;
pub use triangle::{Bounds, Edge, Edges, Point, Raster, Triangle, doubled_grid_area, snap};
pub use walk::Walk;

/// Largest side of a block of the traversal \[pixels\].
pub const MAX_BLOCK: usize = 8;
