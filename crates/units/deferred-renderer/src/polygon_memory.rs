//! Polygon memory (112): bytes of meshes and commands on the path (451, 453).
//!
//! A mesh travels once for all its instances, indexed and in model space, as geometry processing (453) accepts it. Later frames send only their
//! commands. In the wiring, the display list comes out of the geometry processor in all machines, and the server follows it. So
//! an object's command describes its mesh, and the mesh is charged with that command, ahead of its polygons.

use crate::config::{LightingMode, PathConfig};
use basrelief_signals::{Frame, MeshInfo, ObjectInfo, Polygon};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Numbers of a position, of a normal, and of texture coordinates.
const POSITION: u64 = 3;
const NORMAL: u64 = 3;
const UV: u64 = 2;
/// Colour of a vertex: R, G, B, A, 8 bits each \[numbers\].
const COLOR: u64 = 1;
/// Surface: colour (4), lighting coefficients (4), number of its texture, and the two-sided flag \[numbers\].
const MATERIAL: u64 = 10;
/// Frame: matrix (16), direction to the viewer (3), width and height \[numbers\].
const FRAME: u64 = 21;
/// Light: kind, direction or position (3), intensity \[numbers\].
const LIGHT: u64 = 5;
/// Object: its number, and a transform of three rows \[numbers\].
const OBJECT: u64 = 13;
/// Maximum number of vertices with indices of two bytes.
const SHORT_INDEX: u32 = 1 << 16;

/// Counters of polygon data on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PolygonMemoryCounters {
    /// Bytes of meshes, with their surfaces.
    pub mesh_bytes: u64,
    /// Bytes of the commands of frames and objects.
    pub command_bytes: u64,
}

/// Record of the meshes that the device has.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PolygonMemory {
    /// Objects that were sent.
    sent: BTreeSet<u32>,
    /// Meshes of known contents that were sent.
    meshes: BTreeSet<MeshInfo>,
    /// True if the current object's mesh is unknown. Its polygons are charged instead.
    untold: bool,
    /// Counters.
    pub counters: PolygonMemoryCounters,
}

impl PolygonMemory {
    /// Returns the bytes of the command of a frame.
    pub fn frame(&mut self, frame: &Frame, config: &PathConfig) -> u64 {
        self.command(FRAME + LIGHT * frame.lights.len() as u64, config)
    }

    /// Returns the bytes of the command of an object, with its surface and its mesh if the device does not have them.
    pub fn object(&mut self, object: &ObjectInfo, config: &PathConfig, lighting: LightingMode) -> u64 {
        let is_new = self.sent.insert(object.id);
        self.untold = is_new && object.mesh.is_none();
        let bytes = object.mesh.filter(|_| is_new).map_or(0, |mesh| self.new_object(mesh, config, lighting));
        self.counters.mesh_bytes += bytes;
        bytes + self.command(OBJECT, config)
    }

    /// Returns the bytes of the surface of a new object, and of its mesh if no earlier object has the same one.
    fn new_object(&mut self, mesh: MeshInfo, config: &PathConfig, lighting: LightingMode) -> u64 {
        let is_instance = mesh.digest != 0 && !self.meshes.insert(mesh);
        let surface = MATERIAL * u64::from(config.number_bytes);
        surface + if is_instance { 0 } else { mesh_bytes(&mesh, config, lighting) }
    }

    /// Returns the bytes of a polygon: 0 if its mesh is known. Otherwise its vertices count, because their sharing is unknown.
    pub fn polygon(&mut self, polygon: &Polygon, config: &PathConfig, lighting: LightingMode) -> u64 {
        if !self.untold {
            return 0;
        }
        let mesh = MeshInfo {
            vertices: polygon.vertices.len() as u32,
            indices: 0,
            uv: polygon.material.color_texture.is_some(),
            colors: polygon.vertices.iter().any(|v| v.color != [1.0; 4]),
            digest: 0,
        };
        let bytes = vertices_bytes(&mesh, config, lighting);
        self.counters.mesh_bytes += bytes;
        bytes
    }

    fn command(&mut self, numbers: u64, config: &PathConfig) -> u64 {
        let bytes = numbers * u64::from(config.number_bytes);
        self.counters.command_bytes += bytes;
        bytes
    }
}

/// Returns the bytes of the vertex attributes that the picture needs.
fn vertices_bytes(mesh: &MeshInfo, config: &PathConfig, lighting: LightingMode) -> u64 {
    let wanted = |is: bool, numbers: u64| if is { numbers } else { 0 };
    let numbers = POSITION + wanted(lighting == LightingMode::Gouraud, NORMAL) + wanted(mesh.uv, UV) + wanted(mesh.colors, COLOR);
    u64::from(mesh.vertices) * numbers * u64::from(config.number_bytes)
}

/// Returns the bytes of a mesh. Indices take half a number if there are few vertices.
fn mesh_bytes(mesh: &MeshInfo, config: &PathConfig, lighting: LightingMode) -> u64 {
    let number = u64::from(config.number_bytes);
    let indices = u64::from(mesh.indices) * number;
    let indices = if mesh.vertices <= SHORT_INDEX { indices.div_ceil(2) } else { indices };
    vertices_bytes(mesh, config, lighting) + indices
}
