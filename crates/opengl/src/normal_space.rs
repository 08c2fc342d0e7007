//! Space of a normal map.

use crate::geometry::GlMesh;
use crate::mapping::MapKey;
use crate::reader::DrawReader;
use crate::surface::GlSurface;

/// Prepares normals and tangents for the space of the normal map.
///
/// A map in object space is drawn as one in tangent space: with the normal +z, the tangent +x and so the bitangent +y at all vertices,
/// tangent space is object space.
pub(crate) fn use_normal_space(reader: &mut DrawReader<'_>, mesh: &mut GlMesh, surface: &GlSurface) {
    let Some(map) = &surface.normal_map else { return };
    let name = &map.name;
    let in_object_space = match reader.mapped(MapKey::NormalSpace) {
        Some(given) => given == "object",
        None => {
            let in_object_space = mesh.normals.is_none() && mesh.tangents.is_none();
            let space = if in_object_space { "object" } else { "tangent" };
            reader.note(format!("normal-space = {space} (guessed from the vertex attributes)"));
            in_object_space
        }
    };
    if in_object_space {
        let count = mesh.positions.len();
        mesh.normals = Some(vec![[0.0, 0.0, 1.0]; count]);
        mesh.tangents = Some(vec![[1.0, 0.0, 0.0, 1.0]; count]);
        reader.warn(format!("`{name}` is in object space: a device without normal maps lights the object by one normal"));
    } else if mesh.tangents.is_none() {
        reader.note("tangents are computed from the texture coordinates");
    }
}
