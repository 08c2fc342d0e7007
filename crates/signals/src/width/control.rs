//! Widths of control tokens and draw commands.

use super::{CONTROL, COORDINATE, LOD};
use crate::wire_fields::{BitWidth, SignalWidths, WireFields};
use crate::{Attribution, Control, Draw, Frame, Polygon};
use std::sync::Arc;

/// Kind of a control token \[bits\].
const KIND: u32 = 3;

/// Lists kind and number of a control token.
pub(super) fn kind_and_number(wire: &mut WireFields, values: Option<(u64, u64)>) {
    wire.number("kind", KIND, values.map(|(kind, _)| kind));
    wire.number("number", CONTROL - KIND, values.map(|(_, number)| number));
}

impl BitWidth for Control {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        kind_and_number(
            wire,
            token.map(|control| match control {
                Self::Frame(frame) => (0, frame.index.into()),
                Self::Object(object) => (1, object.id.into()),
                Self::Polygon(polygon) => (2, polygon.object.into()),
                Self::CodeBook(_) => (3, 0),
                Self::FrameEnd => (4, 0),
                Self::Criterion(_) => (5, 0),
            }),
        );
        let frame = |of: fn(&Frame) -> u32| match token {
            Some(Self::Frame(frame)) => Some(of(frame)),
            _ => None,
        };
        wire.setup("width", COORDINATE, frame(|frame| frame.width));
        wire.setup("height", COORDINATE, frame(|frame| frame.height));
        let polygon = match token {
            Some(Self::Polygon(polygon)) => Some(polygon),
            _ => None,
        };
        wire.setup("bump", 1, polygon.map(|polygon| polygon.bump));
        wire.setup("lod", LOD, polygon.map(|polygon| polygon.lod));
        wire.setup("mapped", 1, polygon.map(|polygon| polygon.material.normal_map.is_some()));
        wire.setup("textured", 1, polygon.map(|polygon| polygon.material.color_texture.is_some()));
        wire.setup("triangles", COORDINATE, polygon.map(|polygon| triangles(polygon)));
        let criterion = match token {
            Some(Self::Criterion(error_bound)) => Some(error_bound.to_bits()),
            _ => None,
        };
        wire.setup("criterion", u64::BITS, criterion);
    }

    fn bits(widths: &SignalWidths) -> u32 {
        CONTROL + widths.polygon
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Object(object) => Attribution::Object(object.id),
            Self::Polygon(polygon) => Attribution::polygon(polygon),
            Self::CodeBook(_) | Self::Criterion(_) => Attribution::Inherited,
            Self::FrameEnd => Attribution::Whole,
        }
    }
}

/// Returns the number of triangles of a polygon's fan.
pub fn triangles(polygon: &Polygon) -> u64 {
    polygon.vertices.len().saturating_sub(2) as u64
}

impl Attribution {
    /// Returns the attribution of a token that begins this frame.
    pub fn frame(&Frame { index, width, height, .. }: &Frame) -> Self {
        Self::Frame { index, size: [width, height] }
    }

    /// Returns the attribution of a token that begins this polygon.
    pub fn polygon(polygon: &Arc<Polygon>) -> Self {
        Self::Polygon(Arc::as_ptr(polygon) as usize as u64)
    }
}

impl BitWidth for Draw {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        kind_and_number(
            wire,
            token.map(|draw| match draw {
                Self::Frame(frame) => (0, frame.index.into()),
                Self::Object(object) => (1, object.id.into()),
                Self::Triangle(_) => (2, 0),
                Self::FrameEnd => (4, 0),
            }),
        );
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Object(object) => Attribution::Object(object.id),
            Self::Triangle(_) => Attribution::Inherited,
            Self::FrameEnd => Attribution::Whole,
        }
    }
}
