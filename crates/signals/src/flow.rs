//! Control tokens in band (law 7).

use crate::{Frame, ObjectInfo, Polygon};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A control token. It takes effect when a unit pops it, and then travels on to the next unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Control {
    /// A frame begins: size, camera, lights.
    Frame(Arc<Frame>),
    /// The following polygons belong to this object. The previous object is complete.
    Object(Arc<ObjectInfo>),
    /// The following fragments, up to the next control token, belong to this polygon.
    Polygon(Arc<Polygon>),
    /// The following fragments are indexed with these reference normals. There is one list per MIP level of unit vectors in steps
    /// of 1/32767 (code books `per_polygon` and `per_object`).
    CodeBook(Arc<Vec<Vec<[i16; 3]>>>),
    /// The frame is complete. Units that gather lines flush them.
    FrameEnd,
    /// Accuracy criterion e of the texel value generator \[pixels\]. It applies to all spans until the next criterion. Other
    /// machines ignore it.
    Criterion(f64),
}

/// A token on a wire behind the geometry processor: control, or an item of the wire's own type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Flow<T> {
    /// An in-band control token.
    Control(Control),
    /// The item.
    Item(T),
}
