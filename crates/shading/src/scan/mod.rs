//! From a polygon in window coordinates to its pixels: exact coverage, top-left rule, in a fixed order.
//!
//! A polygon is a fan around its first vertex, each triangle of which is [set up](Triangle) and [walked](Walk). Units that
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
