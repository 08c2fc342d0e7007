//! A draw call with the data that state dumps lack.

use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Cure of a draw call that cannot be imported.
pub(crate) const LEAVE_OUT: &str = "leave out this draw call: give the dumps of the others to `basrelief import-gl`";

/// Cure of a draw call that `basrelief capture` cannot read.
pub(crate) const NAME_OTHERS: &str = "leave out this draw call: name a frame with --frame and its other draw calls with --calls";

/// The draw call itself, and the data that state dumps lack.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DrawCall {
    /// Number of the call in the trace.
    pub call: u64,
    /// Kind of primitives, such as `GL_TRIANGLES`.
    pub mode: String,
    /// First vertex of a draw call without indices.
    #[serde(default)]
    pub first: u64,
    /// Number of vertices or indices.
    pub count: u64,
    /// Vertex numbers, with the base vertex added.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub indices: Option<Vec<u32>>,
    /// Vertex attributes by name, in place of the dump's own.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub attributes: BTreeMap<String, AttributeData>,
    /// Names of calls in a display list that change state between its primitives.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub left_out: BTreeSet<String>,
}

/// A vertex attribute: all vertices, one after the other.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AttributeData {
    /// Components, 1..=4.
    pub size: usize,
    /// Single-precision numbers, little-endian, in base64.
    pub data: String,
}
