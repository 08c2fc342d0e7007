//! What travels between the circuits.

use crate::{Illumination, RegisterWrite, Registers, Route};
use basrelief_shading::Raster;
use basrelief_signals::{Frame, Polygon};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A polygon, decided and shaded at its sample points: travels once, ahead of its dots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// The sample points.
    pub polygon: Arc<Polygon>,
    /// Where it is scanned.
    pub raster: Raster,
    /// Registers (14), (16), (18), as they stood when the polygon passed them.
    pub registers: Registers,
    /// Its route.
    pub route: Route,
    /// What process 23 loads into circuit (21): brightness of each sample point; empty where process 24 draws.
    pub brightness: Vec<[f32; 3]>,
}

/// What process 20 loads into circuit (50).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NormalLoad {
    /// The sample points.
    pub polygon: Arc<Polygon>,
    /// Where it is scanned.
    pub raster: Raster,
    /// Normal of each sample point.
    pub normals: Vec<Vec3>,
    /// H, Is, Ks, n.
    pub illumination: Arc<Illumination>,
    /// Specular register (18), for gate (51).
    pub open: bool,
}

/// From the microcomputer (10) to the registers (14), (16), (18), and through them to the circuits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Order {
    /// A register is written.
    Write(RegisterWrite),
    /// Passes; a polygon takes the registers' values with it.
    Pass(FigureFlow),
}

/// Control, dots and their end, from (10) by way of (21), (52) and (53) to (28).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FigureFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// The dots that follow, up to the end, are of this polygon.
    Figure(Arc<Figure>),
    /// A dot.
    Dot(Dot),
    /// The polygon has no further dots.
    End,
    /// The frame is complete.
    FrameEnd,
}

/// Brightness and screen address of a dot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dot {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// Depth; the patent has none.
    pub z: u32,
    /// Red, green, blue; 1 is full scale, not saturated.
    pub brightness: [f32; 3],
}

/// From circuit (50) to gate (51) and adder (52).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Highlights {
    /// A polygon begins; the gate is open for it or not. Goes as far as the gate.
    Start {
        /// Specular register (18).
        open: bool,
    },
    /// A dot.
    Dot(Highlight),
    /// The polygon has no further dots.
    End,
}

/// Specular brightness and screen address of a dot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Highlight {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// The same for red, green and blue; 1 is full scale, not saturated.
    pub brightness: f32,
}

/// A polygon has left the device: from selector (28) to the host interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finished;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dot_is_a_small_token() {
        assert_eq!([size_of::<FigureFlow>(), size_of::<Highlights>()], [24, 12]);
    }
}
