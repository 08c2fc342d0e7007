//! Formats of vertex attributes by their meaning.

use super::format::{ComponentType, ElementFormat};

/// Which formats a vertex attribute may have.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum AttributeSemantic {
    Position,
    Direction,
    TexCoord,
    Color,
    Joints,
    Weights,
}

impl AttributeSemantic {
    pub(super) fn allows(self, format: ElementFormat, quantized: bool) -> bool {
        use ComponentType::{F32, I8, I16, U8, U16, U32};
        let narrow = matches!(format.component, I8 | U8 | I16 | U16);
        match (self, format.component) {
            (Self::Joints, component) => matches!(component, U8 | U16) && !format.normalized,
            (_, F32) => true,
            (_, U32) => false,
            (Self::Position, _) => quantized && narrow,
            (Self::Direction, I8 | I16) => quantized && format.normalized,
            (Self::Direction, _) => false,
            (Self::TexCoord, U8 | U16) => quantized || format.normalized,
            (Self::TexCoord, _) => quantized,
            (Self::Color | Self::Weights, U8 | U16) => format.normalized,
            (Self::Color | Self::Weights, _) => false,
        }
    }

    pub(super) fn expected(self) -> &'static str {
        match self {
            Self::Position => "float (with KHR_mesh_quantization also bytes and shorts)",
            Self::Direction => "float (with KHR_mesh_quantization also normalized signed bytes and shorts)",
            Self::TexCoord => "float, normalized unsigned byte or short (with KHR_mesh_quantization any byte or short)",
            Self::Color | Self::Weights => "float, normalized unsigned byte or short",
            Self::Joints => "unsigned byte or short",
        }
    }
}
