//! The node hierarchy.

use super::json::{GltfDocument, GltfInteger, GltfNode};
use crate::SceneError;
use crate::error::ImportWarnings;
use glam::{DMat4, DQuat, DVec3, DVec4};

/// A node in the world.
pub(crate) struct PlacedNode {
    /// Number in the document.
    pub index: usize,
    /// Object to world.
    pub world: DMat4,
    /// False if `KHR_node_visibility` hides the node or an ancestor. The extension hides meshes and lights, but not cameras.
    pub visible: bool,
}

impl PlacedNode {
    /// A node without a parent, before its own transform.
    fn root(index: usize) -> Self {
        Self { index, world: DMat4::IDENTITY, visible: true }
    }
}

/// The nodes of the scene to draw, parents before children, siblings in order, with their world matrices.
///
/// The walk keeps its own stack, so that a chain of a million nodes is no danger.
pub(crate) fn place(document: &GltfDocument, warnings: &mut ImportWarnings) -> Result<Vec<PlacedNode>, SceneError> {
    let has_parent = check_tree(document)?;
    let mut stack: Vec<PlacedNode> = roots(document, &has_parent, warnings)?.into_iter().rev().map(PlacedNode::root).collect();
    let mut placed = Vec::new();
    while let Some(PlacedNode { index, world: parent, visible }) = stack.pop() {
        let Some(node) = document.nodes.get(index) else { continue };
        let visible = visible && is_visible(node);
        let world = parent * local(node, index, warnings)?;
        if !world.is_finite() {
            return Err(
                SceneError::at(format!("/nodes/{index}"), "its world matrix overflows").expected("transforms of ordinary size")
            );
        }
        stack.extend(node.children.iter().rev().map(|child| PlacedNode { index: child.index(), world, visible }));
        placed.push(PlacedNode { index, world, visible });
    }
    Ok(placed)
}

/// World matrix of every node, whether it is in the scene or not. [`place`] has checked that nodes are trees.
pub(crate) fn worlds(document: &GltfDocument, warnings: &mut ImportWarnings) -> Result<Vec<DMat4>, SceneError> {
    let mut worlds = vec![DMat4::IDENTITY; document.nodes.len()];
    let mut stack: Vec<PlacedNode> = check_tree(document)?
        .iter()
        .enumerate()
        .filter(|(_, has_parent)| !**has_parent)
        .map(|(index, _)| PlacedNode::root(index))
        .collect();
    while let Some(PlacedNode { index, world: parent, .. }) = stack.pop() {
        let (Some(node), Some(slot)) = (document.nodes.get(index), worlds.get_mut(index)) else { continue };
        *slot = parent * local(node, index, warnings)?;
        let world = *slot;
        stack.extend(node.children.iter().map(|child| PlacedNode { world, ..PlacedNode::root(child.index()) }));
    }
    Ok(worlds)
}

fn is_visible(node: &GltfNode) -> bool {
    node.extensions.as_ref().and_then(|e| e.visibility.as_ref()).is_none_or(|v| v.visible)
}

/// Checks that the nodes are trees; whether each has a parent.
fn check_tree(document: &GltfDocument) -> Result<Vec<bool>, SceneError> {
    let mut has_parent = vec![false; document.nodes.len()];
    for (i, node) in document.nodes.iter().enumerate() {
        for (j, child) in node.children.iter().enumerate() {
            if let Some(seen) = has_parent.get_mut(child.index()) {
                if *seen {
                    return Err(SceneError::at(
                        format!("/nodes/{i}/children/{j}"),
                        format!("node {} has a parent already", child.0),
                    )
                    .expected("one parent per node at most")
                    .cure("copy the node for its second place"));
                }
                *seen = true;
            }
        }
    }
    // One parent at most, so a node that no root leads to lies on a loop or below one.
    let mut reached: Vec<bool> = has_parent.iter().map(|p| !p).collect();
    let mut stack: Vec<usize> = (0..reached.len()).filter(|i| reached.get(*i) == Some(&true)).collect();
    while let Some(i) = stack.pop() {
        for child in document.nodes.get(i).map_or(&[][..], |n| &n.children) {
            if let Some(seen) = reached.get_mut(child.index()) {
                *seen = true;
                stack.push(child.index());
            }
        }
    }
    match reached.iter().position(|r| !r) {
        Some(i) => Err(SceneError::at(format!("/nodes/{i}"), "is its own ancestor, or a descendant of one that is")
            .expected("trees of nodes")
            .cure("remove the loop from `children`")),
        None => Ok(has_parent),
    }
}

/// Roots of the default scene, else of the first scene, else all nodes without a parent.
fn roots(document: &GltfDocument, has_parent: &[bool], warnings: &mut ImportWarnings) -> Result<Vec<usize>, SceneError> {
    if document.scenes.is_empty() && document.scene.is_none() {
        if !document.nodes.is_empty() {
            warnings.add("the file has no scene: all its nodes are drawn");
        }
        return Ok((0..has_parent.len()).filter(|i| has_parent.get(*i) == Some(&false)).collect());
    }
    let number = document.scene.unwrap_or(GltfInteger(0));
    let scene = super::check::resolve(&document.scenes, "scenes", number, || "/scene".into())?;
    if document.scenes.len() > 1 {
        warnings.add(format!("the file has {} scenes: number {} is drawn", document.scenes.len(), number.0));
    }
    let mut taken = has_parent.to_vec();
    let mut roots = Vec::new();
    for (j, root) in scene.nodes.iter().enumerate() {
        match taken.get_mut(root.index()) {
            Some(seen) if !*seen => {
                *seen = true;
                roots.push(root.index());
            }
            _ => {
                return Err(SceneError::at(
                    format!("/scenes/{}/nodes/{j}", number.0),
                    format!("node {} is a child of another node, or listed twice", root.0),
                )
                .expected("root nodes, each once"));
            }
        }
    }
    Ok(roots)
}

/// Deviation of the length of a rotation from 1 without a warning: the error of four components of 8 bits, as in the validator.
const LENGTH_TOLERANCE: f64 = 0.00769;

fn local(node: &GltfNode, index: usize, warnings: &mut ImportWarnings) -> Result<DMat4, SceneError> {
    let place = |field: &str| format!("/nodes/{index}/{field}");
    if let Some(matrix) = &node.matrix {
        let mut matrix = DMat4::from_cols_array(matrix);
        // Exporters multiply in single precision.
        if (matrix.row(3) - DVec4::W).abs().max_element() > 1e-4 {
            return Err(SceneError::at(place("matrix"), "its bottom row is not 0 0 0 1")
                .expected("an affine transform, in column-major order"));
        }
        for (i, bottom) in DVec4::W.to_array().into_iter().enumerate() {
            matrix.col_mut(i).w = bottom;
        }
        return Ok(matrix);
    }
    let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let length = rotation.length();
    if !(length.is_finite() && length > 0.0) {
        return Err(SceneError::at(place("rotation"), format!("quaternion of length {length}")).expected("length 1"));
    }
    if (length - 1.0).abs() > LENGTH_TOLERANCE {
        warnings.add(format!("{}: quaternion of length {length}, expected 1: drawn with it made unit", place("rotation")));
    }
    let scale = DVec3::from_array(node.scale.unwrap_or([1.0; 3]));
    let translation = DVec3::from_array(node.translation.unwrap_or_default());
    Ok(DMat4::from_scale_rotation_translation(scale, rotation.normalize(), translation))
}
