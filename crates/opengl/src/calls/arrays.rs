//! Draw calls from arrays: indices and vertices in buffers, or in memory of the application.

use super::line::TraceCall;
use super::memory::{AttributePointer, TraceMemory};
use super::mesh::{ArrayMesh, AttributeColumns};
use crate::draw::NAME_OTHERS;
use crate::vertices::AttributeColumn;
use basrelief_input::MemoryReservation;
use basrelief_scene::SceneError;

/// Error of a draw call that is not read.
pub(crate) fn unsupported(call: &TraceCall<'_>, what: &str) -> SceneError {
    SceneError::at(call.name, what)
        .expected("glDrawArrays, glDrawElements, glDrawRangeElements, glDrawElementsBaseVertex, glBegin or glCallList, with one instance")
        .cure(NAME_OTHERS)
}

/// Reads a draw call. The reservation has room for its attributes and their base64.
pub(crate) fn array_mesh(
    call: &TraceCall<'_>,
    memory: &mut TraceMemory<'_>,
) -> Result<(ArrayMesh, MemoryReservation), SceneError> {
    let plain = matches!(call.name, "glDrawArrays" | "glDrawArraysInstanced");
    let indexed =
        matches!(call.name, "glDrawElements" | "glDrawElementsInstanced" | "glDrawRangeElements" | "glDrawElementsBaseVertex");
    if !plain && !indexed {
        return Err(unsupported(call, "this kind of draw call is not read"));
    }
    if call.number("instancecount").is_some_and(|count| count != 1) {
        return Err(unsupported(call, "draws several instances"));
    }
    let count = call.number("count").unwrap_or_default();
    let first = call.number("first").unwrap_or_default();
    // Numbers and their text.
    let mut held = memory.reserve(if indexed { count.saturating_mul(4 + 11) } else { 0 }, "indices")?;
    let indices = if indexed { Some(indices(call, count, memory)?) } else { None };
    let restart = u32::MAX;
    let largest = match &indices {
        Some(indices) => indices.iter().filter(|index| **index != restart).max().map_or(0, |index| u64::from(*index) + 1),
        None => first.saturating_add(count),
    };
    let columns = attributes(memory, largest, &mut held)?;
    Ok((ArrayMesh { mode: call.text("mode").unwrap_or_default().into(), first, count, indices, columns }, held))
}

/// Reads the indices of a draw call, and adds the base vertex.
fn indices(call: &TraceCall<'_>, count: u64, memory: &mut TraceMemory<'_>) -> Result<Vec<u32>, SceneError> {
    let size = match call.text("type") {
        Some("GL_UNSIGNED_BYTE") => 1,
        Some("GL_UNSIGNED_SHORT") => 2,
        Some("GL_UNSIGNED_INT") => 4,
        other => return Err(unsupported(call, &format!("has indices of type {}", other.unwrap_or("unknown")))),
    };
    let client = call.blob("indices").map(|name| memory.blob(name)).transpose()?;
    let offset = call.number("indices").unwrap_or_default();
    let elements = memory.vertex_array().elements;
    let buffer = client.as_ref().or_else(|| memory.buffers.get(&elements));
    let range = usize::try_from(offset).ok().zip(count.checked_mul(size).and_then(|length| usize::try_from(length).ok()));
    let bytes = buffer.zip(range).and_then(|(buffer, (from, length))| buffer.bytes.get(from..)?.get(..length));
    let bytes =
        bytes.ok_or_else(|| SceneError::at(call.name, "its indices are not in the trace").expected("a buffer of indices"))?;
    let base = call.text("basevertex").and_then(|text| text.parse::<i64>().ok()).unwrap_or_default();
    let all_ones = u32::MAX >> (32 - 8 * size);
    let index = |bytes: &[u8]| {
        let index = bytes.iter().rev().fold(0, |index, byte| index << 8 | u32::from(*byte));
        // The index that usually restarts a strip keeps its meaning.
        if index == all_ones && size == 4 { Some(index) } else { u32::try_from(i64::from(index) + base).ok() }
    };
    let indices: Option<Vec<u32>> = bytes.chunks_exact(size as usize).map(index).collect();
    indices.ok_or_else(|| SceneError::at(call.name, "an index with its base vertex is out of range").expected("0..=4294967295"))
}

/// Reads the enabled attributes of the current program and of the fixed function.
fn attributes(memory: &TraceMemory<'_>, count: u64, held: &mut MemoryReservation) -> Result<AttributeColumns, SceneError> {
    let mut result = AttributeColumns::new();
    for (name, pointer) in memory.attributes() {
        // Four components, then their base64 in a draw call and in its text.
        held.join(memory.reserve(count.saturating_mul(16 + 2 * 22), "a vertex attribute")?);
        let buffer = pointer.client.as_deref().or_else(|| memory.buffers.get(&pointer.buffer));
        match column(pointer, buffer.map_or(&[], |buffer| &buffer.bytes), count) {
            Ok(column) => drop(result.insert(name.into(), column)),
            // A program need not use the arrays of the fixed function, which may be stale.
            Err(_) if memory.has_program() && name.starts_with("gl_") => {}
            Err(error) => return Err(SceneError { place: format!("attribute {name}"), ..error }),
        }
    }
    Ok(result)
}

fn column(pointer: &AttributePointer, bytes: &[u8], count: u64) -> Result<AttributeColumn, SceneError> {
    let fault = |what: &str| SceneError::at("", what).expected("a vertex attribute of numbers in a buffer").cure(NAME_OTHERS);
    let width: usize = match pointer.kind.as_str() {
        "GL_DOUBLE" => 8,
        "GL_FLOAT" | "GL_INT" | "GL_UNSIGNED_INT" => 4,
        "GL_SHORT" | "GL_UNSIGNED_SHORT" => 2,
        "GL_BYTE" | "GL_UNSIGNED_BYTE" => 1,
        _ => return Err(fault(&format!("has components of type `{}`", pointer.kind))),
    };
    if pointer.divisor != 0 || !(1..=4).contains(&pointer.size) {
        return Err(fault("advances per instance, or has no 1 to 4 components"));
    }
    let size = pointer.size as usize;
    let stride = if pointer.stride == 0 { (size * width) as u64 } else { pointer.stride };
    let mut values = Vec::new();
    for vertex in 0..count {
        let from =
            vertex.checked_mul(stride).and_then(|at| at.checked_add(pointer.offset)).and_then(|at| usize::try_from(at).ok());
        let components = from.and_then(|from| bytes.get(from..)?.get(..size * width));
        let components = components.ok_or_else(|| fault(&format!("its vertex {vertex} is not in the trace")))?;
        values.extend(components.chunks_exact(width).map(|component| number(component, pointer)));
    }
    Ok(AttributeColumn { size, values })
}

/// Converts a component. Normalized integers become -1..=1 or 0..=1, as in OpenGL 4.2 and later.
fn number(bytes: &[u8], pointer: &AttributePointer) -> f32 {
    let (value, largest) = match (pointer.kind.as_str(), bytes) {
        ("GL_DOUBLE", [a, b, c, d, e, f, g, h]) => return f64::from_le_bytes([*a, *b, *c, *d, *e, *f, *g, *h]) as f32,
        ("GL_FLOAT", [a, b, c, d]) => return f32::from_le_bytes([*a, *b, *c, *d]),
        ("GL_INT", [a, b, c, d]) => (i64::from(i32::from_le_bytes([*a, *b, *c, *d])), 2_147_483_647),
        ("GL_UNSIGNED_INT", [a, b, c, d]) => (i64::from(u32::from_le_bytes([*a, *b, *c, *d])), 4_294_967_295),
        ("GL_SHORT", [a, b]) => (i64::from(i16::from_le_bytes([*a, *b])), 32_767),
        ("GL_UNSIGNED_SHORT", [a, b]) => (i64::from(u16::from_le_bytes([*a, *b])), 65_535),
        ("GL_BYTE", [a]) => (i64::from(i8::from_le_bytes([*a])), 127),
        ("GL_UNSIGNED_BYTE", [a]) => (i64::from(*a), 255_i64),
        _ => return f32::NAN,
    };
    if pointer.normalized { (value as f32 / largest as f32).max(-1.0) } else { value as f32 }
}
