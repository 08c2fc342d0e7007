//! Triangles of the fixed function, collected from immediate mode, arrays and display lists.

use crate::draw::{AttributeData, DrawCall, NAME_OTHERS};
use crate::triangles::add_triangles;
use crate::vertices::AttributeColumn;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use basrelief_scene::SceneError;
use std::collections::{BTreeMap, BTreeSet};

/// Names of the attributes of the fixed function in the language of programs.
pub(crate) const POSITION: &str = "gl_Vertex";
pub(crate) const NORMAL: &str = "gl_Normal";
pub(crate) const COLOR: &str = "gl_Color";
pub(crate) const UV: &str = "gl_MultiTexCoord0";

/// Attributes by name.
pub(crate) type AttributeColumns = BTreeMap<String, AttributeColumn>;

/// A vertex of the fixed function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FixedVertex {
    pub position: [f32; 4],
    pub normal: [f32; 3],
    pub color: [f32; 4],
    pub uv: [f32; 4],
}

impl Default for FixedVertex {
    /// Returns the initial values of OpenGL.
    fn default() -> Self {
        Self { position: [0.0, 0.0, 0.0, 1.0], normal: [0.0, 0.0, 1.0], color: [1.0; 4], uv: [0.0, 0.0, 0.0, 1.0] }
    }
}

impl FixedVertex {
    /// Returns the attributes with their names, each with its components.
    fn attributes(&self) -> [(&'static str, &[f32]); 4] {
        [(POSITION, &self.position), (NORMAL, &self.normal), (COLOR, &self.color), (UV, &self.uv)]
    }
}

/// A draw call from arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ArrayMesh {
    pub mode: String,
    pub first: u64,
    pub count: u64,
    pub indices: Option<Vec<u32>>,
    pub columns: AttributeColumns,
}

impl ArrayMesh {
    /// Returns the largest memory of vertices and vertex numbers \[bytes\].
    pub fn bytes(&self) -> u64 {
        let columns: usize = self.columns.values().map(|column| column.values.len()).sum();
        FixedMesh::size_of(self.count).saturating_add(4 * columns as u64)
    }

    /// Returns true if the positions come from the fixed function.
    pub fn is_fixed(&self) -> bool {
        self.columns.contains_key(POSITION)
    }

    /// Returns the numbers of the vertices, in the order of drawing.
    pub fn numbers(&self) -> Vec<u32> {
        let range = || (self.first as u32..(self.first + self.count) as u32).collect();
        self.indices.clone().unwrap_or_else(range)
    }

    /// Adds columns of current values for the attributes without an array.
    pub fn fill(&mut self, current: &FixedVertex) {
        let count = self.columns.get(POSITION).map_or(0, |column| column.values.len() / column.size.max(1));
        for (name, value) in current.attributes() {
            let constant = || AttributeColumn { size: value.len(), values: value.repeat(count) };
            self.columns.entry(name.into()).or_insert_with(constant);
        }
    }

    /// Returns the vertices, after [`ArrayMesh::fill`].
    pub fn vertices(&self) -> Vec<FixedVertex> {
        let usual = FixedVertex::default();
        fn rows<const N: usize>(mesh: &ArrayMesh, name: &str, missing: [f32; N]) -> Vec<[f32; N]> {
            mesh.columns.get(name).map_or_else(Vec::new, |column| column.rows(missing))
        }
        let rest = rows(self, NORMAL, usual.normal).into_iter().zip(rows(self, COLOR, usual.color)).zip(rows(self, UV, usual.uv));
        let vertices = rows(self, POSITION, usual.position).into_iter().zip(rest);
        vertices.map(|(position, ((normal, color), uv))| FixedVertex { position, normal, color, uv }).collect()
    }

    /// Returns the draw call.
    pub fn into_draw(self, call: u64) -> DrawCall {
        let Self { mode, first, count, indices, columns } = self;
        DrawCall { call, mode, first, count, indices, attributes: encoded(columns), left_out: BTreeSet::new() }
    }
}

/// Triangles of one draw call.
#[derive(Debug, Default)]
pub(crate) struct FixedMesh {
    pub vertices: Vec<FixedVertex>,
    indices: Vec<u32>,
    /// Names of calls in a display list that change state behind its first vertex.
    pub left_out: BTreeSet<String>,
}

impl FixedMesh {
    /// Returns the largest memory of a primitive with this many vertices or indices, up to its draw call \[bytes\].
    pub fn size_of(vertices: u64) -> u64 {
        // Each vertex ends at most two triangles; flat ones have three vertices each. Vertices also become base64, and indices text.
        vertices.saturating_mul(6 * (size_of::<FixedVertex>() as u64 * 3 + 16))
    }

    /// Adds a primitive. Flat triangles take normal and colour from their last vertex.
    pub fn add(&mut self, mode: &str, vertices: &[FixedVertex], numbers: &[u32], flat: bool) -> Result<(), SceneError> {
        let mut triangles = Vec::new();
        add_triangles(mode, numbers, &mut triangles).map_err(|e| e.cure(NAME_OTHERS))?;
        if let Some(index) = triangles.iter().find(|index| **index as usize >= vertices.len()) {
            let what = format!("vertex {index} does not exist");
            return Err(SceneError::at(mode, what).expected(format!("numbers below {}", vertices.len())).cure(NAME_OTHERS));
        }
        let first = self.vertices.len() as u32;
        if !flat {
            self.vertices.extend(vertices);
            self.indices.extend(triangles.iter().map(|index| first + index));
            return Ok(());
        }
        for [a, b, c] in triangles.as_chunks::<3>().0 {
            let corners = [a, b, c].map(|corner| vertices[*corner as usize]);
            let FixedVertex { normal, color, .. } = corners[2];
            self.vertices.extend(corners.map(|corner| FixedVertex { normal, color, ..corner }));
        }
        self.indices.extend(first..self.vertices.len() as u32);
        Ok(())
    }

    /// Returns the draw call of the triangles.
    pub fn into_draw(self, call: u64) -> DrawCall {
        let mut columns = AttributeColumns::new();
        for vertex in &self.vertices {
            for (name, components) in vertex.attributes() {
                let column = columns.entry(name.into()).or_default();
                column.size = components.len();
                column.values.extend(components);
            }
        }
        DrawCall {
            call,
            mode: "GL_TRIANGLES".into(),
            first: 0,
            count: self.indices.len() as u64,
            indices: Some(self.indices),
            attributes: encoded(columns),
            left_out: self.left_out,
        }
    }
}

/// Returns attributes as a draw call holds them.
fn encoded(columns: AttributeColumns) -> BTreeMap<String, AttributeData> {
    let data = |column: AttributeColumn| {
        let bytes: Vec<u8> = column.values.iter().flat_map(|number| number.to_le_bytes()).collect();
        AttributeData { size: column.size, data: STANDARD.encode(bytes) }
    };
    columns.into_iter().map(|(name, column)| (name, data(column))).collect()
}
