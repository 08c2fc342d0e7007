//! Speed of the host.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Speed of the host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Host {
    /// Time of the whole run \[s\].
    pub wall_s: f64,
    /// Time of the simulation, without import, reference, metrics and writing \[s\].
    pub simulate_s: f64,
    /// Simulated cycles per second of `simulate_s`. Absent for a functional run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles_per_s: Option<f64>,
    /// Fragments or dots per second of `simulate_s`.
    pub fragments_per_s: f64,
    /// Traffic and picture times of the real network path. Absent if no scene came from a server.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<RealPath>,
}

/// Measurements of a real network path. The figures `first_picture_ms`, `final_picture_ms`, `picture_ms` and `path_bytes` have the
/// modelled values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RealPath {
    /// Time from the request for the scene to the first picture \[ms\].
    pub first_picture_ms: f64,
    /// Time from the request for the scene to the last picture of the first frame \[ms\].
    pub final_picture_ms: f64,
    /// Time to each picture from the end of the frame before \[ms\].
    pub picture_ms: Vec<f64>,
    /// Time to each picture from the request for the scene \[ms\].
    pub picture_at_ms: Vec<f64>,
    /// Part of `first_picture_ms` in which the path was idle because the host computed \[ms\].
    pub first_picture_idle_ms: f64,
    /// Part of `final_picture_ms` in which the path was idle \[ms\].
    pub final_picture_idle_ms: f64,
    /// Opened connections.
    pub connections: u64,
    /// Requests.
    pub requests: u64,
    /// Bytes of requests.
    pub request_bytes: u64,
    /// Bytes of the scene, compressed.
    pub scene_bytes: u64,
    /// Received tiles.
    pub tiles: u64,
    /// Bytes of the received tiles.
    pub tile_bytes: u64,
    /// Received bytes of lists of tile hashes.
    #[serde(default)]
    pub hash_bytes: u64,
    /// Tiles that were never requested because their view ended.
    pub abandoned_tiles: u64,
    /// Received bytes of headers and of unused responses. With the bytes of scene, tiles and hashes, all received bytes.
    pub head_bytes: u64,
}
