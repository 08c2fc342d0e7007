//! Traces written by hand.

use super::*;
use crate::draw::DrawCall;
use std::io;

/// Bytes 0 to 15 as four indices of 32 bits; six numbers; six shorts.
fn files(name: &str) -> io::Result<(Vec<u8>, basrelief_input::MemoryReservation)> {
    let bytes = match name {
        "indices" => [0_u32, 1, 2, 1].iter().flat_map(|index| index.to_le_bytes()).collect(),
        "bytes" => vec![0, 1, 2],
        "floats" => (1_u8..=8).flat_map(|n| f32::from(n).to_le_bytes()).collect(),
        "two" => [7.0_f32, 9.0].iter().flat_map(|n| n.to_le_bytes()).collect(),
        "shorts" => [32_767_i16, -32_768, 0, 1].iter().flat_map(|n| n.to_le_bytes()).collect(),
        _ => return Err(io::ErrorKind::NotFound.into()),
    };
    Ok((bytes, MemoryPool::default().empty_reservation()))
}

const SETUP: &str = r#"1 glBindAttribLocation(program = 3, index = 0, name = "p") // fake
2 glUseProgram(program = 3)
3 glBindVertexArray(array = 1)
4 glBindBuffer(target = GL_ARRAY_BUFFER, buffer = 5)
5 glBufferData(target = GL_ARRAY_BUFFER, size = 32, data = blob("floats"), usage = GL_STATIC_DRAW)
6 glVertexAttribPointer(index = 0, size = 2, type = GL_FLOAT, normalized = GL_FALSE, stride = 8, pointer = 0x8)
7 glEnableVertexAttribArray(index = 0)
8 glEnableVertexAttribArray(index = 1)
"#;

fn drawn(lines: &str) -> Result<DrawCall, String> {
    let text = format!("{SETUP}{lines}");
    let dumps =
        with_draws(&text, &files, &[(20, b"{\"uniforms\": {}}".to_vec())], &MemoryPool::default()).map_err(|e| e.to_string())?;
    let dump: crate::dump::GlDump = serde_json::from_slice(&dumps[0]).unwrap();
    Ok(dump.draw.unwrap())
}

fn values(draw: &DrawCall) -> Vec<f32> {
    let (columns, _held) = crate::vertices::VertexColumns::of_draw(draw, &MemoryPool::default()).unwrap();
    columns.columns["p"].values.clone()
}

#[test]
fn vertices_come_from_bound_buffers() {
    let draw = drawn("20 glDrawArrays(mode = GL_TRIANGLES, first = 0, count = 3)").unwrap();
    assert_eq!((draw.mode.as_str(), draw.count, &draw.indices), ("GL_TRIANGLES", 3, &None));
    assert_eq!(values(&draw), [3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
}

#[test]
fn later_writes_change_buffers() {
    let lines = "9 glBufferSubData(target = GL_ARRAY_BUFFER, offset = 8, size = 8, data = blob(\"two\"))
10 glMapBufferRange(target = GL_ARRAY_BUFFER, offset = 16, length = 16, access = GL_MAP_WRITE_BIT) = 0x1000
11 memcpy(dest = 0x1008, src = blob(\"two\"), n = 8)
12 glUnmapBuffer(target = GL_ARRAY_BUFFER) = GL_TRUE
13 memcpy(dest = 0x1000, src = blob(\"two\"), n = 8)
20 glDrawArrays(mode = GL_TRIANGLES, first = 0, count = 3)";
    assert_eq!(values(&drawn(lines).unwrap()), [7.0, 9.0, 5.0, 6.0, 7.0, 9.0]);
}

#[test]
fn indices_come_from_the_vertex_array_with_their_base() {
    let lines = "9 glBindBuffer(target = GL_ELEMENT_ARRAY_BUFFER, buffer = 6)
10 glBufferData(target = GL_ELEMENT_ARRAY_BUFFER, size = 16, data = blob(\"indices\"), usage = GL_STATIC_DRAW)
11 glBindVertexArray(array = 2)
12 glBindBuffer(target = GL_ELEMENT_ARRAY_BUFFER, buffer = 7)
13 glBindVertexArray(array = 1)
20 glDrawElementsBaseVertex(mode = GL_TRIANGLES, count = 3, type = GL_UNSIGNED_INT, indices = 0x4, basevertex = -1)";
    let draw = drawn(lines).unwrap();
    assert_eq!(draw.indices, Some(vec![0, 1, 0]));
    assert_eq!(values(&draw), [3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn memory_of_the_application_is_read() {
    let lines = "9 glVertexAttribPointer(index = 0, size = 1, type = GL_SHORT, normalized = GL_TRUE, stride = 0, pointer = blob(\"shorts\"))
20 glDrawElements(mode = GL_TRIANGLES, count = 3, type = GL_UNSIGNED_BYTE, indices = blob(\"bytes\"))";
    assert_eq!(values(&drawn(lines).unwrap()), [1.0, -1.0, 0.0]);
}

#[test]
fn unsupported_draw_calls_are_named() {
    let says = |line: &str, part: &str| {
        let text = drawn(line).unwrap_err();
        assert!(text.starts_with("call 20: ") && text.contains(part), "{text}");
    };
    says("20 glDrawArraysInstanced(mode = GL_TRIANGLES, first = 0, count = 3, instancecount = 2)", "several instances");
    says("20 glDrawArraysIndirect(mode = GL_TRIANGLES, indirect = NULL)", "glDrawArraysIndirect: this kind");
    says("20 glDrawArrays(mode = GL_TRIANGLES, first = 0, count = 9)", "attribute p: its vertex 3 is not in the trace");
    says(
        "20 glDrawElements(mode = GL_TRIANGLES, count = 3, type = GL_UNSIGNED_INT, indices = NULL)",
        "indices are not in the trace",
    );
    assert!(drawn("21 glFinish()").unwrap_err().contains("call 20: is not in the trace"));
    let huge = "9 glBufferData(target = GL_ARRAY_BUFFER, size = 99999999999999, data = NULL)";
    assert!(drawn(huge).unwrap_err().starts_with("call 9: glBufferData: would hold"));
    assert!(
        drawn("9 glBufferData(target = A, size = 1, data = blob(\"none\"))")
            .unwrap_err()
            .contains("call 9: none: cannot be read")
    );
}

#[test]
fn frames_end_at_swaps() {
    let text = "1 glDrawBuffers(n = 1)\n2 glDrawArrays()\n3 glXSwapBuffers(dpy = 0x1)\n4 glClear()\n5 eglSwapBuffers()\n6 glDrawElements()\n7 glFinish()";
    let frame = |draws: &[u64], last, is_complete| FrameCalls { draws: draws.into(), last, is_complete };
    assert_eq!(frames(text), [frame(&[2], 3, true), frame(&[6], 7, false)]);
}
