//! The triangles of a draw call, with its matrix.

use crate::draw::{DrawCall, LEAVE_OUT};
use crate::fixed::{has_fixed_vertices, is_fixed, shows_vertex_colors};
use crate::mapping::MapKey;
use crate::matrix::matrix;
use crate::program::{self, MatrixProduct, ProgramNames};
use crate::reader::{DrawReader, unknown};
use crate::state::Parameters;
use crate::triangles::triangles;
use crate::vertices::{AttributeColumn, MOST_DUMPED, VertexColumns};
use basrelief_scene::SceneError;
use glam::DMat4;
use std::borrow::Cow;

/// Triangles in object space. Lists of attributes have one value per vertex.
#[derive(Debug, Default)]
pub(crate) struct GlMesh {
    pub positions: Vec<[f32; 3]>,
    pub normals: Option<Vec<[f32; 3]>>,
    pub tangents: Option<Vec<[f32; 4]>>,
    pub uv: Option<Vec<[f32; 2]>>,
    pub colors: Option<Vec<[f32; 4]>>,
    pub indices: Vec<u32>,
}

/// A matrix with its name.
pub(crate) type NamedMatrix = (DMat4, String);

/// Geometry of a draw call.
#[derive(Debug)]
pub(crate) struct GlGeometry {
    pub mesh: GlMesh,
    /// From object to clip space.
    pub mvp: DMat4,
    /// Last matrix of a product of several.
    pub last: Option<NamedMatrix>,
}

/// Memory of a vertex with all attributes, and of the copy without unused vertices \[bytes\].
const VERTEX: u64 = 2 * 64;

/// Reads the geometry of a draw call.
pub(crate) fn geometry(reader: &mut DrawReader<'_>) -> Result<GlGeometry, SceneError> {
    let dump = reader.dump;
    let own = dump.draw.as_ref().filter(|draw| !draw.attributes.is_empty());
    let (columns, _columns) = match own {
        Some(draw) => VertexColumns::of_draw(draw, reader.budget).map(|(columns, held)| (Cow::Owned(columns), held))?,
        None => (Cow::Borrowed(&dump.buffers.vertices), reader.budget.empty_reservation()),
    };
    if columns.count == 0 {
        return Err(SceneError::at("/buffers/vertices", "holds no vertices")
            .expected("vertex attributes in buffers; those of the fixed function and of instances are not in a dump")
            .cure("capture the application with `basrelief capture`, or leave out this draw call"));
    }
    let draw = draw_call(reader, columns.count)?;
    for name in &draw.left_out {
        reader
            .warn(format!("{name} between primitives of a display list is left out: all are drawn in the state behind the list"));
    }
    let restart = restart_index(reader);
    let indices = triangles(&draw, restart, columns.count)?;
    if indices.is_empty() {
        return Err(SceneError::at("/draw/count", "draws no triangle").expected("3 vertices or more").cure(LEAVE_OUT));
    }
    let names: Vec<String> = columns.columns.keys().cloned().collect();
    let product = product(reader, &names)?;
    let (mvp, last) = matrices(reader, &product)?;
    let held = reader.reserve(VERTEX * columns.count as u64 + 4 * indices.len() as u64, "/buffers/vertices", "vertices")?;
    let position = product.position.and_then(|name| columns.columns.get(&name)).cloned().unwrap_or_default();
    let positions = positions(&position)?;
    let mut mesh = GlMesh { positions, indices, ..GlMesh::default() };
    add_attributes(reader, &columns, &names, &mut mesh)?;
    reader.keep(held);
    compact(&mut mesh);
    Ok(GlGeometry { mesh, mvp, last })
}

/// Returns the draw call of a dump, or plain triangles of all its vertices.
fn draw_call(reader: &mut DrawReader<'_>, vertices: usize) -> Result<DrawCall, SceneError> {
    if let Some(draw) = &reader.dump.draw {
        return Ok(draw.clone());
    }
    if vertices >= MOST_DUMPED {
        return Err(SceneError::at("/buffers/vertices", format!("holds {vertices} vertices, the most that apitrace writes"))
            .expected("all vertices of the draw call")
            .cure("capture the application with `basrelief capture`, which reads them from the trace"));
    }
    reader.note(format!("draw = {vertices} vertices as GL_TRIANGLES (guessed: the dump does not state the draw call)"));
    Ok(DrawCall { call: reader.call, mode: "GL_TRIANGLES".into(), count: vertices as u64, ..DrawCall::default() })
}

fn restart_index(reader: &DrawReader<'_>) -> Option<u32> {
    let parameters = Parameters(reader.dump);
    if parameters.flag("GL_PRIMITIVE_RESTART_FIXED_INDEX") {
        return Some(u32::MAX);
    }
    let index = parameters.value("GL_PRIMITIVE_RESTART_INDEX").and_then(|value| value.as_i64());
    index.filter(|_| parameters.flag("GL_PRIMITIVE_RESTART")).map(|index| index as u32)
}

/// Returns the product that gives the position: of the mapping, or of the vertex program.
fn product(reader: &mut DrawReader<'_>, names: &[String]) -> Result<MatrixProduct, SceneError> {
    let mapped = reader.mapped(MapKey::Position).map(str::to_owned);
    if let Some(name) = mapped.as_ref().filter(|name| !names.contains(name)) {
        return Err(unknown(MapKey::Position, name, names));
    }
    let product = if let Some(name) = reader.mapped(MapKey::Mvp) {
        let matrices = reader.uniforms(|value| matrix(value).is_some());
        if !matrices.iter().any(|known| known == name) {
            return Err(unknown(MapKey::Mvp, name, &matrices));
        }
        let is_position = |name: &str| name.contains("pos") || name.contains("vert");
        MatrixProduct { matrices: vec![name.into()], position: reader.choose(MapKey::Position, names, is_position)? }
    } else {
        program_product(reader, names)?
    };
    let position = mapped.or(product.position).filter(|name| names.contains(name)).ok_or_else(|| {
        SceneError::at("/buffers/vertices", "the position is not among the vertex attributes")
            .expected(format!("one of {}", names.join(", ")))
            .cure("name it with --map position=NAME")
    })?;
    Ok(MatrixProduct { position: Some(position), ..product })
}

fn program_product(reader: &mut DrawReader<'_>, names: &[String]) -> Result<MatrixProduct, SceneError> {
    let dump = reader.dump;
    if has_fixed_vertices(dump) {
        reader.note("mvp = GL_PROJECTION_MATRIX * GL_MODELVIEW_MATRIX, position = gl_Vertex (fixed function)");
        return Ok(MatrixProduct::fixed_function());
    }
    let place = "/shaders/GL_VERTEX_SHADER";
    let source = dump.shaders.get("GL_VERTEX_SHADER").ok_or_else(|| {
        SceneError::at(place, "is missing")
            .expected("the source of a vertex program")
            .cure("name matrix and position with --map mvp=NAME,position=NAME")
    })?;
    let is_matrix = |name: &str| dump.uniforms.get(name).and_then(matrix).is_some();
    let is_attribute = |name: &str| names.iter().any(|known| known == name);
    let names = ProgramNames { is_matrix: &is_matrix, is_attribute: &is_attribute };
    let product = program::position_of(source, &names).map_err(|what| {
        SceneError::at(place, format!("the vertex program {what}"))
            .expected("a product of matrices with a vertex attribute")
            .cure("if the program is one, name matrix and position with --map mvp=NAME,position=NAME; else leave out this draw call")
    })?;
    let position = product.position.as_deref().unwrap_or_default();
    let mvp = if product.matrices.is_empty() { "identity".into() } else { product.matrices.join(" * ") };
    reader.note(format!("mvp = {mvp}, position = {position} (read from the vertex program)"));
    Ok(product)
}

/// Returns the product of the matrices, and the last one if there are several.
fn matrices(reader: &DrawReader<'_>, product: &MatrixProduct) -> Result<(DMat4, Option<NamedMatrix>), SceneError> {
    let parameters = Parameters(reader.dump);
    let mut factors = Vec::new();
    for name in &product.matrices {
        let (place, value) = match name.as_str() {
            "gl_ProjectionMatrix" => ("/parameters/GL_PROJECTION_MATRIX".into(), parameters.value("GL_PROJECTION_MATRIX")),
            "gl_ModelViewMatrix" => ("/parameters/GL_MODELVIEW_MATRIX".into(), parameters.value("GL_MODELVIEW_MATRIX")),
            _ => (format!("/uniforms/{name}"), reader.dump.uniforms.get(name)),
        };
        let found = value.and_then(matrix);
        let missing = || SceneError::at(place, "is no 4 x 4 matrix").expected("16 finite numbers");
        factors.push(found.ok_or_else(missing)?);
    }
    let mvp = factors.iter().fold(DMat4::IDENTITY, |product, factor| product * *factor);
    if !(mvp.is_finite() && mvp.determinant() != 0.0) {
        let place = format!("/uniforms/{}", product.matrices.join(" * "));
        return Err(SceneError::at(place, "flattens space").expected("a matrix that can be inverted"));
    }
    let last = (factors.len() > 1).then(|| factors.pop().zip(product.matrices.last().cloned())).flatten();
    Ok((mvp, last))
}

fn positions(column: &AttributeColumn) -> Result<Vec<[f32; 3]>, SceneError> {
    let place = "/buffers/vertices";
    let rows = column.rows([0.0, 0.0, 0.0, 1.0]);
    if let Some(at) = rows.iter().position(|row| row[3] != 1.0) {
        return Err(
            SceneError::at(format!("{place}/{at}"), format!("position {:?}", rows[at])).expected("1 as the fourth number")
        );
    }
    if let Some(at) = rows.iter().position(|row| row.iter().any(|c| !c.is_finite())) {
        return Err(SceneError::at(format!("{place}/{at}"), "its position is not finite").expected("finite numbers"));
    }
    Ok(rows.into_iter().map(|[x, y, z, _]| [x, y, z]).collect())
}

fn add_attributes(
    reader: &mut DrawReader<'_>,
    columns: &VertexColumns,
    names: &[String],
    mesh: &mut GlMesh,
) -> Result<(), SceneError> {
    let of_size = |sizes: std::ops::RangeInclusive<usize>| -> Vec<String> {
        let fits = |name: &&String| columns.columns.get(*name).is_some_and(|column| sizes.contains(&column.size));
        names.iter().filter(fits).cloned().collect()
    };
    let column = |name: Option<String>| name.and_then(|name| columns.columns.get(&name));
    let normal = reader.choose(MapKey::Normal, &of_size(3..=4), |name| name.contains("normal"))?;
    mesh.normals = column(normal).map(|column| column.rows([0.0; 3]));
    let sign = reader.mapped_number(MapKey::TangentSign).unwrap_or(1.0);
    let is_tangent = |name: &str| name.contains("tangent") && !name.contains("bitangent");
    let tangent = reader.choose(MapKey::Tangent, &of_size(3..=4), is_tangent)?;
    mesh.tangents = column(tangent).map(|column| column.rows([0.0, 0.0, 0.0, sign as f32]));
    let is_uv = |name: &str| ["texcoord", "tex_coord", "uv", "texture"].iter().any(|word| name.contains(word));
    let uv = reader.choose(MapKey::Uv, &of_size(2..=4), is_uv)?;
    // OpenGL counts rows of a texture upwards from v = 0, glTF counts them downwards.
    let turned = |column: &AttributeColumn| column.rows([0.0; 2]).into_iter().map(|[u, v]| [u, 1.0 - v]).collect();
    mesh.uv = column(uv).map(turned);
    let shows_colors = !is_fixed(reader.dump) || shows_vertex_colors(reader.dump);
    let is_color = |name: &str| shows_colors && (name.contains("color") || name.contains("colour"));
    let color = reader.choose(MapKey::Color, &of_size(3..=4), is_color)?;
    mesh.colors = column(color).map(|column| column.rows([1.0; 4]));
    Ok(())
}

/// Removes the vertices that no triangle uses.
fn compact(mesh: &mut GlMesh) {
    let mut used = vec![false; mesh.positions.len()];
    for index in &mesh.indices {
        if let Some(flag) = used.get_mut(*index as usize) {
            *flag = true;
        }
    }
    let mut next = 0;
    let numbers: Vec<u32> = used
        .iter()
        .map(|used| {
            next += u32::from(*used);
            next.saturating_sub(1)
        })
        .collect();
    for index in &mut mesh.indices {
        *index = numbers.get(*index as usize).copied().unwrap_or_default();
    }
    keep(&mut mesh.positions, &used);
    mesh.normals.iter_mut().for_each(|list| keep(list, &used));
    mesh.tangents.iter_mut().for_each(|list| keep(list, &used));
    mesh.uv.iter_mut().for_each(|list| keep(list, &used));
    mesh.colors.iter_mut().for_each(|list| keep(list, &used));
}

fn keep<T>(list: &mut Vec<T>, used: &[bool]) {
    let mut flags = used.iter();
    list.retain(|_| flags.next().copied().unwrap_or(false));
}
