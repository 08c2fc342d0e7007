//! Skins in their rest pose: vertices follow joints (glTF 2.0, section 3.7.3).

use super::accessor::AccessorReader;
use super::geometry::PrimitiveReader;
use super::json::{GltfDocument, GltfInteger, GltfPrimitive};
use super::nodes;
use super::semantic::AttributeSemantic;
use super::vertex_matrices::VertexMatrices;
use crate::SceneError;
use crate::error::ImportWarnings;
use glam::DMat4;

/// Allowed distance of the sum of a vertex's weights from 1. Three weights of 8 bits are each rounded.
const SUM_TOLERANCE: f64 = 0.01;

/// The skins of a document.
pub(crate) struct SkinReader<'a> {
    document: &'a GltfDocument,
    accessors: &'a AccessorReader<'a>,
    /// World matrix of each node; empty if the document has no skin.
    worlds: Vec<DMat4>,
}

impl<'a> SkinReader<'a> {
    pub fn new(
        document: &'a GltfDocument,
        accessors: &'a AccessorReader<'a>,
        warnings: &mut ImportWarnings,
    ) -> Result<Self, SceneError> {
        let worlds = if document.skins.is_empty() { Vec::new() } else { nodes::worlds(document, warnings)? };
        Ok(Self { document, accessors, worlds })
    }

    /// Matrices of a primitive's vertices. `None` if it has no joints or no weights: it is then drawn where it is defined.
    pub fn influences(
        &self,
        geometry: &PrimitiveReader<'_>,
        skin: GltfInteger,
        primitive: &GltfPrimitive,
        vertices: u64,
        place: &str,
        warnings: &mut ImportWarnings,
    ) -> Result<Option<VertexMatrices>, SceneError> {
        let joints = self.joint_matrices(skin, warnings)?;
        let mut matrices: Vec<DMat4> = Vec::new();
        let mut sums: Vec<f64> = Vec::new();
        for set in 0.. {
            let Some([numbers, weights]) = influence_set(geometry, primitive, set, vertices, place, warnings)? else { break };
            self.accessors.charge((size_of::<DMat4>() + size_of::<f64>()) as u64 * numbers.len() as u64, place)?;
            matrices.resize(numbers.len().max(matrices.len()), DMat4::ZERO);
            sums.resize(matrices.len(), 0.0);
            for (i, (numbers, weights)) in numbers.iter().zip(&weights).enumerate() {
                for (number, weight) in numbers.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
                    let joint = joints.get(*number as usize).ok_or_else(|| {
                        SceneError::at(format!("{place}/attributes/JOINTS_{set}"), format!("vertex {i} follows joint {number}"))
                            .expected(format!("a joint below {}, the number of joints of /skins/{}", joints.len(), skin.0))
                    })?;
                    matrices[i] += *joint * f64::from(*weight);
                    sums[i] += f64::from(*weight);
                }
            }
        }
        if matrices.is_empty() {
            warnings.add(format!("{place} has no JOINTS_0 and WEIGHTS_0, which its skin asks for: drawn without the skin"));
            return Ok(None);
        }
        normalize(&mut matrices, &sums, place, warnings);
        Ok(Some(VertexMatrices { matrices }))
    }

    /// Returns the world matrix of each joint times its inverse bind matrix.
    fn joint_matrices(&self, skin: GltfInteger, warnings: &mut ImportWarnings) -> Result<Vec<DMat4>, SceneError> {
        let place = format!("/skins/{}", skin.0);
        let Some(definition) = self.document.skins.get(skin.index()) else { return Ok(Vec::new()) };
        let inverse = match definition.inverse_bind_matrices {
            None => vec![DMat4::IDENTITY; definition.joints.len()],
            Some(index) => {
                let place = format!("{place}/inverseBindMatrices");
                let (format, _) = self.accessors.describe(index, &place)?;
                if format.name() != "MAT4 of float" {
                    return Err(
                        SceneError::at(place, format!("accessor {} is {}", index.0, format.name())).expected("MAT4 of float")
                    );
                }
                let elements = self.accessors.floats::<16>(index, &place, warnings)?;
                elements.iter().map(|m| DMat4::from_cols_array(&m.map(f64::from))).collect()
            }
        };
        if inverse.len() < definition.joints.len() {
            return Err(SceneError::at(place, format!("{} inverse bind matrices", inverse.len()))
                .expected(format!("{}, the number of joints", definition.joints.len())));
        }
        let world = |joint: &GltfInteger| self.worlds.get(joint.index()).copied().unwrap_or_default();
        Ok(definition.joints.iter().zip(inverse).map(|(joint, inverse)| world(joint) * inverse).collect())
    }
}

/// Reads the joint numbers and the weights of a set; `None` if the primitive lacks one of them.
fn influence_set(
    geometry: &PrimitiveReader<'_>,
    primitive: &GltfPrimitive,
    set: usize,
    vertices: u64,
    place: &str,
    warnings: &mut ImportWarnings,
) -> Result<Option<[Vec<[f32; 4]>; 2]>, SceneError> {
    let attributes = &primitive.attributes;
    let [joints, weights] = ["JOINTS", "WEIGHTS"].map(|name| format!("{name}_{set}"));
    if !attributes.contains_key(&joints) || !attributes.contains_key(&weights) {
        return Ok(None);
    }
    let mut read = |name: &str, semantic| {
        let place = format!("{place}/attributes/{name}");
        geometry.elements::<4>(attributes, name, Some(vertices), semantic, &place, warnings)
    };
    let numbers = read(&joints, AttributeSemantic::Joints)?.unwrap_or_default();
    let weights = read(&weights, AttributeSemantic::Weights)?.unwrap_or_default();
    Ok(Some([numbers, weights]))
}

/// Divides matrices by the sums of their weights.
fn normalize(matrices: &mut [DMat4], sums: &[f64], place: &str, warnings: &mut ImportWarnings) {
    for (matrix, sum) in matrices.iter_mut().zip(sums) {
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            warnings.add(format!(
                "{place}: weights of vertices do not add up to 1: scaled, and vertices without weights stay in place"
            ));
        }
        if *sum == 0.0 {
            *matrix = DMat4::IDENTITY;
        } else if *sum != 1.0 {
            *matrix *= 1.0 / sum;
        }
    }
}
