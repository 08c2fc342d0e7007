//! Arithmetic and latency of a polygon, besides those of [`crate::transform`], [`crate::clip`] and the window.

use crate::clip::{DISTANCES, made_corner};
use crate::transform::ObjectTransform;
use crate::window::WindowTransform;
use basrelief_kernel::{OperatorCounts, Operators};
use basrelief_signals::{Lighting, LightingStage, Object, SentAttributes, VertexAttributes};

/// Arithmetic and fetched bytes that are charged to a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct StepCharge {
    /// Arithmetic.
    pub(crate) work: OperatorCounts,
    /// Bytes of vertices and indices fetched.
    pub(crate) fetched: u64,
}

impl StepCharge {
    /// Adds arithmetic.
    pub(crate) fn add(&mut self, work: OperatorCounts) {
        self.work = self.work.and(work);
    }
}

/// Returns the size of a vertex as fetched \[bytes\]: three numbers of its position, and these attributes.
pub(crate) fn vertex_bytes(of: SentAttributes) -> u64 {
    12 + of.bytes()
}

/// Returns the size of the indices of a triangle \[bytes\]. An index has 16 bits if they can number all vertices of the object.
pub(crate) fn index_bytes(object: &Object) -> u64 {
    3 * if object.mesh.positions.len() <= 1 << 16 { 2 } else { 4 }
}

/// Returns the arithmetic of transforming a vertex with these attributes.
pub(crate) fn vertex(of: SentAttributes) -> OperatorCounts {
    let directions = u32::from(of.normal) + u32::from(of.normal_map);
    ObjectTransform::POSITION.and(DISTANCES).and(WindowTransform::PLACE).and(ObjectTransform::DIRECTION.times(directions))
}

/// Returns the arithmetic of a vertex with these attributes at a cut edge.
pub(crate) fn cut_vertex(of: SentAttributes) -> OperatorCounts {
    let numbers = |there: bool, count: u32| if there { count } else { 0 };
    let all = numbers(of.normal, 3) + numbers(of.normal_map, 3 + 2) + numbers(of.texture, 2) + numbers(of.color, 4);
    made_corner(all, u32::from(of.normal) + u32::from(of.normal_map)).and(WindowTransform::PLACE)
}

/// Returns the arithmetic of twice the area of a polygon of this many corners, relative to the first. It decides whether the
/// polygon faces away.
pub(crate) fn area(corners: usize) -> OperatorCounts {
    let (edges, products) = (corners.saturating_sub(1) as u32, corners.saturating_sub(2) as u32);
    OperatorCounts { multiply: 2 * products, add: 2 * edges + 2 * products, ..OperatorCounts::NONE }
}

/// Returns the arithmetic of the LOD of such a polygon: its area in texels, and the ratio. Root and logarithm are the exponent of
/// the ratio and a table of the first bits of its fraction: a comparison with each of four bounds within an octave.
pub(crate) fn lod(corners: usize) -> OperatorCounts {
    area(corners).and(OperatorCounts { multiply: 2, add: 4, divide: 1, ..OperatorCounts::NONE })
}

/// Returns the arithmetic of the brightness of a vertex under this many lights. A term that the material lacks costs nothing.
pub(crate) fn lighting(of: &Lighting, lights: u32) -> OperatorCounts {
    // Per light: inner product, its sign, intensity, sum. Then the coefficient.
    let light = OperatorCounts::INNER_PRODUCT.and(OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE });
    let coefficient = OperatorCounts { multiply: 1, add: 1, ..OperatorCounts::NONE };
    let diffuse = if of.kd > 0.0 { light.times(lights).and(coefficient) } else { OperatorCounts::NONE };
    let highlight = light.and(OperatorCounts { power: 1, ..OperatorCounts::NONE }).times(lights).and(coefficient);
    if of.ks > 0.0 { diffuse.and(highlight) } else { diffuse }
}

/// Returns the arithmetic of the lights as seen from an object: direction and half-way vector, each made unit.
pub(crate) fn object(lights: u32) -> OperatorCounts {
    let light = OperatorCounts { add: 3 + 3, ..OperatorCounts::NONE }.and(OperatorCounts::NORMALIZE.times(2));
    ObjectTransform::OF_OBJECT.and(light.times(lights))
}

/// Returns all operations of the unit, each once: of a vertex with these attributes, of a cut edge, of a triangle, and where vertices are
/// lit, of a light.
pub(crate) fn program(of: SentAttributes, lit: LightingStage) -> OperatorCounts {
    let polygon = vertex(of).and(cut_vertex(of)).and(lod(3));
    if lit == LightingStage::Nowhere {
        return polygon;
    }
    polygon.and(object(1)).and(lighting(&Lighting { kd: 1.0, ks: 1.0, ..Lighting::default() }, 1))
}

/// Returns the cycles from the last operands of a polygon to its delivery: position, projection, area and LOD, in parallel with
/// transforming and lighting the normal.
pub(crate) fn latency(operators: &Operators, taken: VertexAttributes) -> u64 {
    let area = OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE };
    let lod = OperatorCounts { divide: 1, add: 1, ..OperatorCounts::NONE };
    let outline = ObjectTransform::POSITION_CHAIN.and(WindowTransform::PLACE_CHAIN).and(area);
    let outline = if taken.normal_maps { outline.and(lod) } else { outline };
    let lighting = OperatorCounts { multiply: 3, add: 4, power: 1, ..OperatorCounts::NONE };
    let normal = match taken.lit {
        LightingStage::Nowhere => OperatorCounts::NONE,
        LightingStage::InMachine => ObjectTransform::DIRECTION_CHAIN,
        LightingStage::AtVertices | LightingStage::Targets => ObjectTransform::DIRECTION_CHAIN.and(lighting),
    };
    operators.latency(outline).max(operators.latency(normal))
}
