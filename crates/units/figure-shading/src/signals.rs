//! Tokens between the circuits.

use crate::{ObjectIllumination, PolygonRoute, RegisterWrite, ShadingRegisters};
use basrelief_shading::RasterGrid;
use basrelief_signals::{Frame, Polygon};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A polygon, decided and shaded at its sample points. It travels once, ahead of its dots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolygonFigure {
    /// Polygon with the sample points.
    pub polygon: Arc<Polygon>,
    /// Raster of its scan.
    pub raster: RasterGrid,
    /// Registers (14), (16), (18), as they were when the polygon passed them.
    pub registers: ShadingRegisters,
    /// Route of the polygon.
    pub route: PolygonRoute,
    /// Brightness of each sample point, which process 23 loads into circuit (21). Empty if process 24 draws.
    pub brightness: Vec<[f32; 3]>,
}

/// Data that process 20 loads into circuit (50).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NormalLoad {
    /// Polygon with the sample points.
    pub polygon: Arc<Polygon>,
    /// Raster of its scan.
    pub raster: RasterGrid,
    /// Normal of each sample point.
    pub normals: Vec<Vec3>,
    /// H, Is, Ks, n.
    pub illumination: Arc<ObjectIllumination>,
    /// Specular register (18), for gate (51).
    pub open: bool,
}

/// Token from the microcomputer (10) to the registers (14), (16), (18), and through them to the circuits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum RegisterOrder {
    /// A register write.
    Write(RegisterWrite),
    /// A token that passes through. A polygon token carries the values of the registers.
    Pass(FigureFlow),
}

/// Control, dots and their end, from (10) through (21), (52) and (53) to (28).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FigureFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// The following dots, up to the end, belong to this polygon.
    Figure(Arc<PolygonFigure>),
    /// A dot.
    Dot(ShadedDot),
    /// The polygon has no further dots.
    End,
    /// The frame is complete.
    FrameEnd,
}

/// Brightness and screen address of a dot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShadedDot {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// Depth, which the patent does not have.
    pub z: u32,
    /// Red, green, blue. 1 is full scale, not saturated.
    pub brightness: [f32; 3],
}

/// Token from circuit (50) to gate (51) and adder (52).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SpecularFlow {
    /// A polygon begins, with the gate open or closed. The token ends at the gate.
    Start {
        /// Specular register (18): true if the gate is open.
        open: bool,
    },
    /// A dot.
    Dot(SpecularDot),
    /// The polygon has no further dots.
    End,
}

/// Specular brightness and screen address of a dot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpecularDot {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// Specular brightness, equal for red, green and blue. 1 is full scale, not saturated.
    pub brightness: f32,
}

/// Token from selector (28) to the host interface: a polygon has left the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FinishedPolygon;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dot_is_a_small_token() {
        assert_eq!([size_of::<FigureFlow>(), size_of::<SpecularFlow>()], [24, 12]);
    }
}
