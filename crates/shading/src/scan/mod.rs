//! Rasterization of polygons in window coordinates: exact coverage, top-left rule, fixed pixel order.
//!
//! A polygon is a fan around its first vertex. Each triangle of the fan is [set up](RasterTriangle) and [walked](TriangleWalk). Units that
//! [scan](PolygonScan) the same polygon on the same [raster](RasterGrid) visit the same pixels in the same order.

mod polygon;
mod spans;
mod triangle;
mod walk;

pub use polygon::{PolygonScan, fan_triangles};
pub use spans::PolygonSpans;
pub use triangle::{EdgeFunction, GridPoint, PixelBounds, RasterGrid, RasterTriangle, TriangleEdges, doubled_grid_area, snap};
pub use walk::TriangleWalk;

/// Largest side of a block of the traversal \[pixels\].
pub const MAX_BLOCK: usize = 8;
