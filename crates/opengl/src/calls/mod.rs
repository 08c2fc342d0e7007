//! Draw calls of a trace, from the text of `apitrace dump --multiline=no --blobs`: arguments, indices and vertices, which state dumps lack.

mod line;
mod memory;
#[cfg(test)]
mod tests;

pub use memory::BlobFiles;

use crate::draw::{AttributeData, DrawCall};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use basrelief_input::MemoryPool;
use basrelief_scene::SceneError;
use line::TraceCall;
use memory::{AttributePointer, TraceMemory};
use std::collections::BTreeMap;

/// The calls of one frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameCalls {
    /// Numbers of the draw calls.
    pub draws: Vec<u64>,
    /// Number of the last call.
    pub last: u64,
    /// The application has shown the frame.
    pub is_complete: bool,
}

/// Cure of a draw call that has no dump yet.
const OTHERS: &str = "leave out this draw call: name a frame with --frame and its other draw calls with --calls";

/// Returns the frames of a trace that draw. The calls after the last swap of buffers form a frame that is not complete.
pub fn frames(text: &str) -> Vec<FrameCalls> {
    let mut frames = vec![FrameCalls::default()];
    for call in text.lines().filter_map(TraceCall::parse) {
        let Some(frame) = frames.last_mut() else { break };
        frame.last = call.number;
        if is_draw(call.name) {
            frame.draws.push(call.number);
        }
        if is_swap(call.name) {
            frame.is_complete = true;
            frames.push(FrameCalls::default());
        }
    }
    frames.retain(|frame| !frame.draws.is_empty());
    frames
}

fn is_swap(name: &str) -> bool {
    name.ends_with("SwapBuffers")
        || name.contains("SwapBuffersWithDamage")
        || matches!(name, "glFrameTerminatorGREMEDY" | "CGLFlushDrawable")
}

fn is_draw(name: &str) -> bool {
    let is_other = name.starts_with("glDrawBuffer") || name.starts_with("glDrawPixels");
    (name.starts_with("glDraw") && !is_other)
        || name.starts_with("glMultiDraw")
        || matches!(name, "glBegin" | "glCallList" | "glCallLists")
}

/// Adds the arguments, indices and vertices of draw calls to their state dumps, as the member `draw`.
///
/// `text` is the output of `apitrace dump`, `files` reads its blobs, and `dumps` are pairs of a call number and a state dump. Returns
/// the dumps in order of `dumps`.
///
/// # Errors
/// A draw call of a kind that is not supported, or that is not in the text; a blob that cannot be read; too much memory.
pub fn with_draws(
    text: &str,
    files: BlobFiles<'_>,
    dumps: &[(u64, Vec<u8>)],
    budget: &MemoryPool,
) -> Result<Vec<Vec<u8>>, SceneError> {
    let mut memory = TraceMemory::new(files, budget);
    let mut found = BTreeMap::new();
    for call in text.lines().filter_map(TraceCall::parse) {
        let at_call = |e: SceneError| SceneError { place: format!("call {}: {}", call.number, e.place), ..e };
        if dumps.iter().any(|(number, _)| *number == call.number) {
            found.insert(call.number, draw_call(&call, &mut memory).map_err(at_call)?);
        }
        memory.follow(&call).map_err(at_call)?;
    }
    let with_draw = |(number, dump): &(u64, Vec<u8>)| {
        let missing = || SceneError::at(format!("call {number}"), "is not in the trace").expected("the number of a draw call");
        let draw = found.get(number).ok_or_else(missing)?;
        let text = serde_json::to_string(draw).map_err(|e| SceneError::at(format!("call {number}"), e.to_string()))?;
        let start = dump.iter().position(|byte| *byte == b'{').map_or(dump.len(), |at| at + 1);
        Ok([&dump[..start], b"\n  \"draw\": ", text.as_bytes(), b",", &dump[start..]].concat())
    };
    dumps.iter().map(with_draw).collect()
}

fn unsupported(call: &TraceCall<'_>, what: &str) -> SceneError {
    SceneError::at(call.name, what)
        .expected("glDrawArrays, glDrawElements, glDrawRangeElements or glDrawElementsBaseVertex, with one instance")
        .cure(OTHERS)
}

fn draw_call(call: &TraceCall<'_>, memory: &mut TraceMemory<'_>) -> Result<DrawCall, SceneError> {
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
    let indices = if indexed { Some(indices(call, count, memory)?) } else { None };
    let restart = u32::MAX;
    let largest = match &indices {
        Some(indices) => indices.iter().filter(|index| **index != restart).max().map_or(0, |index| u64::from(*index) + 1),
        None => first.saturating_add(count),
    };
    let attributes = attributes(memory, largest)?;
    Ok(DrawCall { call: call.number, mode: call.text("mode").unwrap_or_default().into(), first, count, indices, attributes })
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

/// Reads the enabled attributes of the current program.
fn attributes(memory: &mut TraceMemory<'_>, count: u64) -> Result<BTreeMap<String, AttributeData>, SceneError> {
    let enabled: Vec<u64> = memory.vertex_array().attributes.iter().filter(|(_, a)| a.enabled).map(|(index, _)| *index).collect();
    let mut result = BTreeMap::new();
    for location in enabled {
        let Some(name) = memory.name(location).cloned() else { continue };
        // Four components, then their base64.
        let _work = memory.reserve(count.saturating_mul(2 * 16), "a vertex attribute")?;
        let buffers = std::mem::take(&mut memory.buffers);
        let attribute = memory.vertex_array().attributes.get(&location);
        let data = attribute.map(|attribute| {
            let buffer = attribute.client.as_ref().or_else(|| buffers.get(&attribute.buffer));
            attribute_data(attribute, buffer.map_or(&[], |buffer| &buffer.bytes), count)
        });
        memory.buffers = buffers;
        let named = |e: SceneError| SceneError { place: format!("attribute {name}"), ..e };
        if let Some(data) = data.transpose().map_err(named)? {
            result.insert(name, data);
        }
    }
    Ok(result)
}

fn attribute_data(attribute: &AttributePointer, bytes: &[u8], count: u64) -> Result<AttributeData, SceneError> {
    let fault = |what: &str| SceneError::at("", what).expected("a vertex attribute of numbers in a buffer").cure(OTHERS);
    let width: usize = match attribute.kind.as_str() {
        "GL_FLOAT" => 4,
        "GL_SHORT" | "GL_UNSIGNED_SHORT" => 2,
        "GL_BYTE" | "GL_UNSIGNED_BYTE" => 1,
        _ => return Err(fault(&format!("has components of type `{}`", attribute.kind))),
    };
    if attribute.divisor != 0 || !(1..=4).contains(&attribute.size) {
        return Err(fault("advances per instance, or has no 1 to 4 components"));
    }
    let size = attribute.size as usize;
    let stride = if attribute.stride == 0 { (size * width) as u64 } else { attribute.stride };
    let mut data = Vec::new();
    for vertex in 0..count {
        let from =
            vertex.checked_mul(stride).and_then(|at| at.checked_add(attribute.offset)).and_then(|at| usize::try_from(at).ok());
        let components = from.and_then(|from| bytes.get(from..)?.get(..size * width));
        let components = components.ok_or_else(|| fault(&format!("its vertex {vertex} is not in the trace")))?;
        for component in components.chunks_exact(width) {
            data.extend(number(component, attribute).to_le_bytes());
        }
    }
    Ok(AttributeData { size, data: STANDARD.encode(data) })
}

/// Converts a component. Normalized integers become -1..=1 or 0..=1, as in OpenGL 4.2 and later.
fn number(bytes: &[u8], attribute: &AttributePointer) -> f32 {
    let (value, largest) = match (attribute.kind.as_str(), bytes) {
        ("GL_FLOAT", [a, b, c, d]) => return f32::from_le_bytes([*a, *b, *c, *d]),
        ("GL_SHORT", [a, b]) => (i32::from(i16::from_le_bytes([*a, *b])), 32_767),
        ("GL_UNSIGNED_SHORT", [a, b]) => (i32::from(u16::from_le_bytes([*a, *b])), 65_535),
        ("GL_BYTE", [a]) => (i32::from(i8::from_le_bytes([*a])), 127),
        ("GL_UNSIGNED_BYTE", [a]) => (i32::from(*a), 255),
        _ => return f32::NAN,
    };
    if attribute.normalized { (value as f32 / largest as f32).max(-1.0) } else { value as f32 }
}
