//! Formats of accessor elements.

use super::json::{GltfAccessor, GltfInteger};
use crate::SceneError;

/// Type of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ComponentType {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl ComponentType {
    /// The type with this number in glTF.
    pub(crate) fn parse(code: GltfInteger, place: impl FnOnce() -> String) -> Result<Self, SceneError> {
        Ok(match code.0 {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => {
                return Err(
                    SceneError::at(place(), format!("component type {other}")).expected("5120, 5121, 5122, 5123, 5125 or 5126")
                );
            }
        })
    }

    /// Size \[bytes\].
    pub(crate) fn bytes(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// For messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::I8 => "signed byte",
            Self::U8 => "unsigned byte",
            Self::I16 => "signed short",
            Self::U16 => "unsigned short",
            Self::U32 => "unsigned int",
            Self::F32 => "float",
        }
    }
}

/// Format of the elements of an accessor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ElementFormat {
    pub component: ComponentType,
    pub normalized: bool,
    /// Components per column: 1..=4.
    pub rows: usize,
    /// 1, or more for a matrix.
    pub columns: usize,
}

impl ElementFormat {
    /// For messages.
    pub(crate) fn name(self) -> String {
        let kind = match (self.columns, self.rows) {
            (1, 1) => "SCALAR".into(),
            (1, rows) => format!("VEC{rows}"),
            (columns, _) => format!("MAT{columns}"),
        };
        format!("{kind} of {}{}", if self.normalized { "normalized " } else { "" }, self.component.name())
    }

    /// Returns true for a vector (or scalar) of this width.
    pub(crate) fn is_vector(self, width: usize) -> bool {
        self.columns == 1 && self.rows == width
    }

    /// Bytes that an element has at least: the last column of a matrix needs no padding.
    pub(crate) fn used_bytes(self) -> u64 {
        let column = self.component.bytes() * self.rows as u64;
        self.element_bytes() - if self.columns == 1 { 0 } else { column.next_multiple_of(4) - column }
    }

    /// Bytes from one element to the next; columns of matrices begin at multiples of four bytes.
    pub(crate) fn element_bytes(self) -> u64 {
        let column = self.component.bytes() * self.rows as u64;
        if self.columns == 1 { column } else { self.columns as u64 * column.next_multiple_of(4) }
    }
}

/// The format of accessor `i`, checked.
pub(crate) fn format_of(accessor: &GltfAccessor, i: usize) -> Result<ElementFormat, SceneError> {
    let component = ComponentType::parse(accessor.component_type, || format!("/accessors/{i}/componentType"))?;
    let (columns, rows) = match accessor.kind.as_str() {
        "SCALAR" => (1, 1),
        "VEC2" => (1, 2),
        "VEC3" => (1, 3),
        "VEC4" => (1, 4),
        "MAT2" => (2, 2),
        "MAT3" => (3, 3),
        "MAT4" => (4, 4),
        other => {
            return Err(SceneError::at(format!("/accessors/{i}/type"), format!("type `{other}`"))
                .expected("SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4"));
        }
    };
    if accessor.normalized && matches!(component, ComponentType::U32 | ComponentType::F32) {
        return Err(SceneError::at(format!("/accessors/{i}/normalized"), format!("true for {}", component.name()))
            .expected("true only for bytes and shorts"));
    }
    if accessor.count.0 == 0 {
        return Err(SceneError::at(format!("/accessors/{i}/count"), "is 0").expected("at least 1"));
    }
    Ok(ElementFormat { component, normalized: accessor.normalized, rows, columns })
}

/// Numbers of an unsigned type.
pub(crate) fn unsigned_numbers(bytes: &[u8], component: ComponentType) -> Vec<u32> {
    match component {
        ComponentType::U8 => bytes.iter().map(|b| u32::from(*b)).collect(),
        ComponentType::U16 => bytes.as_chunks().0.iter().map(|b| u32::from(u16::from_le_bytes(*b))).collect(),
        _ => bytes.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect(),
    }
}

/// A component as a float; normalized integers to 0..=1 or -1..=1 (glTF 2.0, section 3.11).
pub(crate) fn decode(raw: &[u8], format: ElementFormat) -> f32 {
    let scaled = |value: f32, most: f32| if format.normalized { (value / most).max(-1.0) } else { value };
    match (format.component, raw) {
        (ComponentType::I8, [a]) => scaled(f32::from(*a as i8), 127.0),
        (ComponentType::U8, [a]) => scaled(f32::from(*a), 255.0),
        (ComponentType::I16, [a, b]) => scaled(f32::from(i16::from_le_bytes([*a, *b])), 32767.0),
        (ComponentType::U16, [a, b]) => scaled(f32::from(u16::from_le_bytes([*a, *b])), 65535.0),
        (ComponentType::U32, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
        (ComponentType::F32, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
        _ => 0.0,
    }
}
