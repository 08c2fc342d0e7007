//! Speed of the host.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How fast the host was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Host {
    /// From start to end \[s\].
    pub wall_s: f64,
    /// From the first to the last simulated step, without import, reference, metrics or writing \[s\].
    pub simulate_s: f64,
    /// Simulated cycles per second of `simulate_s`; absent from a functional run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles_per_s: Option<f64>,
    /// Fragments, or dots, per second of `simulate_s`.
    pub fragments_per_s: f64,
    /// What a real path has carried, and when pictures were there; absent where nothing came from a server.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<RealPath>,
}

/// A real path, as the host has measured it; beside `first_picture_ms`, `final_picture_ms`, `picture_ms` and `path_bytes` of the
/// modelled one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RealPath {
    /// From the request for the scene to the first picture \[ms\].
    pub first_picture_ms: f64,
    /// From there to the last picture of the first frame \[ms\].
    pub final_picture_ms: f64,
    /// To each picture, from the end of the frame before \[ms\].
    pub picture_ms: Vec<f64>,
    /// To each picture, from the request for the scene \[ms\].
    pub picture_at_ms: Vec<f64>,
    /// Of `first_picture_ms`, how long the path had nothing to do, since the host was at work \[ms\]: the rest is what the path took.
    pub first_picture_idle_ms: f64,
    /// The same of `final_picture_ms` \[ms\].
    pub final_picture_idle_ms: f64,
    /// Connections opened.
    pub connections: u64,
    /// Requests made.
    pub requests: u64,
    /// Bytes of requests.
    pub request_bytes: u64,
    /// Bytes of the scene, compressed.
    pub scene_bytes: u64,
    /// Tiles that have come.
    pub tiles: u64,
    /// Their bytes.
    pub tile_bytes: u64,
    /// Tiles that were to be asked for and were not, since their view was left for the next.
    pub abandoned_tiles: u64,
    /// Bytes received beside scene and tiles: heads of answers, and answers that were of no use.
    pub head_bytes: u64,
}
