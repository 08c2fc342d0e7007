//! Control in band (law 7).

use crate::{Frame, ObjectInfo, Polygon};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A control token: takes effect when popped, travels on to the next unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Control {
    /// A frame begins: size, camera, lights.
    Frame(Arc<Frame>),
    /// The polygons that follow belong to this object; the object before it is complete.
    Object(Arc<ObjectInfo>),
    /// The fragments that follow, up to the next control token, are of this polygon.
    Polygon(Arc<Polygon>),
    /// The fragments that follow are indexed with these reference normals, one list per MIP level, unit vectors in
    /// steps of 1/32767 (code books `per_polygon` and `per_object`).
    CodeBook(Arc<Vec<Vec<[i16; 3]>>>),
    /// The frame is complete; who gathers, flushes.
    FrameEnd,
    /// Accuracy criterion e of the texel value generator \[pixels\], for spans until another is selected. Other machines do not
    /// ask.
    Criterion(f64),
}

/// What a wire carries behind the geometry processor: control, or an item of its own kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Flow<T> {
    /// Control, in band.
    Control(Control),
    /// The item.
    Item(T),
}
