//! From draw calls to lists of triangles.

use crate::draw::{DrawCall, LEAVE_OUT};
use basrelief_scene::SceneError;

/// Returns the vertex numbers of the triangles of a draw call, three each. `restart` is the index that ends a strip or fan.
pub(crate) fn triangles(draw: &DrawCall, restart: Option<u32>, vertices: usize) -> Result<Vec<u32>, SceneError> {
    let plain = || {
        let end = draw.first.checked_add(draw.count).and_then(|end| u32::try_from(end).ok());
        let end = end.filter(|end| *end as usize <= vertices).ok_or_else(|| {
            SceneError::at("/draw/count", format!("draws {} vertices from {}", draw.count, draw.first))
                .expected(format!("at most {vertices} vertices"))
                .cure("let `basrelief capture` read the vertices from the trace")
        })?;
        Ok((draw.first as u32..end).collect())
    };
    let numbers = draw.indices.as_ref().map_or_else(plain, |indices| Ok(indices.clone()))?;
    let mut result = Vec::new();
    for part in numbers.split(|index| Some(*index) == restart) {
        add_triangles(&draw.mode, part, &mut result)?;
    }
    if let Some(index) = result.iter().find(|index| **index as usize >= vertices) {
        return Err(SceneError::at("/draw/indices", format!("vertex {index} does not exist"))
            .expected(format!("numbers below {vertices}"))
            .cure("let `basrelief capture` read the vertices from the trace"));
    }
    Ok(result)
}

/// Adds the triangles of a primitive. The last vertex of each triangle is the one that flat shading takes its colour from.
pub(crate) fn add_triangles(mode: &str, numbers: &[u32], to: &mut Vec<u32>) -> Result<(), SceneError> {
    match mode {
        "GL_TRIANGLES" => to.extend(numbers.as_chunks::<3>().0.as_flattened()),
        "GL_TRIANGLE_STRIP" => {
            for (i, corners) in numbers.windows(3).enumerate() {
                let [a, b, c] = [corners[0], corners[1], corners[2]];
                to.extend(if i.is_multiple_of(2) { [a, b, c] } else { [b, a, c] });
            }
        }
        "GL_TRIANGLE_FAN" => {
            if let [centre, rim @ ..] = numbers {
                rim.windows(2).for_each(|pair| to.extend([*centre, pair[0], pair[1]]));
            }
        }
        "GL_QUADS" => numbers.as_chunks::<4>().0.iter().for_each(|[a, b, c, d]| to.extend([*a, *b, *d, *b, *c, *d])),
        "GL_QUAD_STRIP" => {
            for corners in numbers.windows(4).step_by(2) {
                let [a, b, d, c] = [corners[0], corners[1], corners[2], corners[3]];
                to.extend([a, b, c, d, a, c]);
            }
        }
        "GL_POLYGON" => {
            if let [first, rim @ ..] = numbers {
                rim.windows(2).for_each(|pair| to.extend([pair[0], pair[1], *first]));
            }
        }
        other => {
            return Err(SceneError::at("/draw/mode", format!("`{other}` cannot be drawn"))
                .expected("triangles, quadrilaterals or a polygon")
                .cure(LEAVE_OUT));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(mode: &str, indices: Option<Vec<u32>>, count: u64) -> Result<Vec<u32>, String> {
        let draw = DrawCall { call: 1, mode: mode.into(), first: 1, count, indices, ..DrawCall::default() };
        triangles(&draw, Some(9), 8).map_err(|e| e.to_string())
    }

    #[test]
    fn strips_keep_winding_and_fans_their_centre() {
        assert_eq!(drawn("GL_TRIANGLES", None, 7).unwrap(), [1, 2, 3, 4, 5, 6]);
        assert_eq!(drawn("GL_TRIANGLE_STRIP", None, 4).unwrap(), [1, 2, 3, 3, 2, 4]);
        assert_eq!(drawn("GL_TRIANGLE_FAN", None, 4).unwrap(), [1, 2, 3, 1, 3, 4]);
    }

    #[test]
    fn quads_and_polygons_keep_winding_and_flat_vertex() {
        assert_eq!(drawn("GL_QUADS", None, 7).unwrap(), [1, 2, 4, 2, 3, 4]);
        assert_eq!(drawn("GL_QUAD_STRIP", None, 7).unwrap(), [1, 2, 4, 3, 1, 4, 3, 4, 6, 5, 3, 6]);
        assert_eq!(drawn("GL_POLYGON", None, 4).unwrap(), [2, 3, 1, 3, 4, 1]);
    }

    #[test]
    fn restart_index_begins_another_strip() {
        let indices = vec![0, 1, 2, 3, 9, 4, 5, 6];
        assert_eq!(drawn("GL_TRIANGLE_STRIP", Some(indices), 8).unwrap(), [0, 1, 2, 2, 1, 3, 4, 5, 6]);
    }

    #[test]
    fn missing_vertices_and_other_modes_are_errors() {
        assert!(
            drawn("GL_TRIANGLES", None, 8).unwrap_err().starts_with("/draw/count: draws 8 vertices from 1; expected at most 8")
        );
        assert!(drawn("GL_TRIANGLES", None, u64::MAX).is_err());
        assert!(drawn("GL_TRIANGLES", Some(vec![0, 1, 8]), 3).unwrap_err().contains("vertex 8 does not exist"));
        assert!(drawn("GL_LINES", None, 2).unwrap_err().contains("`GL_LINES` cannot be drawn"));
    }
}
