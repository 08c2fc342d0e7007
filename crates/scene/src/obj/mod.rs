//! Wavefront OBJ and MTL.
//!
//! Read with a parser of this crate: the error messages of the known library have no line numbers, and it takes
//! non-finite numbers and unknown text for granted.

mod map;
mod material;
mod mesh;
mod mtl;
mod parse;
mod polygon;
#[cfg(test)]
mod tests;
mod text;

use crate::SceneError;
use crate::camera::rows;
use crate::error::ImportWarnings;
use crate::model::{ImportedModel, bounds};
use crate::outside::{ImportContext, mesh_bytes};
use crate::tangents;
use basrelief_signals::{Object, ShadingSettings};
use glam::DMat4;
use material::{MaterialBuilder, OBJECT, PlacedMaterial};
use mesh::{CORNER, MeshParts, OffsetPositions, SmoothNormals, TRIANGLES};
use parse::ObjGroup;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Imports an OBJ file.
pub(crate) fn import(
    bytes: &[u8],
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<ImportedModel, SceneError> {
    let (obj, _held) = parse::parse(bytes, outside, warnings)?;
    if obj.groups.is_empty() {
        return Err(SceneError::at("", "nothing to draw")
            .expected("at least one face (`f`)")
            .cure("export the model with its faces")
            .with_notes(warnings.sentences()));
    }
    let mut materials = MaterialBuilder::new(outside);
    let definitions = materials.libraries(&obj.libraries, warnings)?;
    let library = material::by_name(&definitions, warnings);
    let _local = outside.take((size_of::<[f32; 3]>() * obj.positions.len()) as u64, "", "positions")?;
    let positions = OffsetPositions::new(&obj);
    let (smooth, _smooth) = SmoothNormals::new(&obj, &positions, outside, warnings)?;
    let shape = MeshParts { obj: &obj, positions: &positions, smooth: &smooth };
    let mut surfaces: BTreeMap<&[u8], PlacedMaterial> = BTreeMap::new();
    let mut objects = Vec::new();
    for group in &obj.groups {
        let surface = match surfaces.get(group.material.as_slice()) {
            Some(surface) => surface.clone(),
            None => materials.build(surfaces.len() as u32, &group.material, &library, warnings)?,
        };
        surfaces.insert(&group.material, surface.clone());
        objects.push(Arc::new(object(objects.len() as u32, group, surface, &shape, outside, warnings)?));
    }
    let (bounds, shading) = (bounds(&objects), ShadingSettings::default());
    Ok(ImportedModel { bounds, objects, camera: None, camera_ratio: None, lamps: Vec::new(), shading })
}

/// The object of a group; its matrix holds the offset of the positions.
fn object(
    id: u32,
    group: &ObjGroup,
    surface: PlacedMaterial,
    shape: &MeshParts<'_>,
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<Object, SceneError> {
    let corners = 3 * group.triangles() as u64;
    let tangents = if surface.material.normal_map.is_some() { tangents::BYTES_PER_CORNER } else { 0 };
    let mut held = outside.take((CORNER + tangents) * corners, "", TRIANGLES)?;
    let mesh = shape.mesh(group, &surface, &mut held, warnings)?;
    let name = group.name();
    held.shrink_to(mesh_bytes(&mesh));
    outside.keep(held);
    outside.hold(OBJECT + name.len() as u64, "", "objects and their names")?;
    Ok(Object {
        id,
        name,
        mesh: Arc::new(mesh),
        world: rows(DMat4::from_translation(shape.positions.offset)),
        material: surface.material,
        entries: None,
        bias: None,
        bump: None,
        shading: ShadingSettings::default(),
    })
}
