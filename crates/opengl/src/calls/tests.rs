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
        "normals" => (1_u8..=12).flat_map(|n| f32::from(n).to_le_bytes()).collect(),
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
    drawn_within(&text, &MemoryPool::default())
}

fn drawn_within(text: &str, budget: &MemoryPool) -> Result<DrawCall, String> {
    let bytes = b"{\"uniforms\": {}}".to_vec();
    let held = budget.try_reserve(bytes.len() as u64, "a dump").unwrap();
    let dumps = with_draws(text, &files, vec![StateDump { call: 20, bytes, held }], budget).map_err(|e| e.to_string())?;
    assert_eq!(budget.left() + dumps[0].bytes.len() as u64, limit_of(budget), "the dump and nothing else is held");
    let dump: crate::dump::GlDump = serde_json::from_slice(&dumps[0].bytes).unwrap();
    Ok(dump.draw.unwrap())
}

/// Returns the limit of a pool of these tests.
fn limit_of(budget: &MemoryPool) -> u64 {
    if budget.left() > SMALL { MemoryPool::DEFAULT } else { SMALL }
}

/// A small memory limit.
const SMALL: u64 = 20_000;

fn values(draw: &DrawCall) -> Vec<f32> {
    attribute(draw, "p")
}

fn attribute(draw: &DrawCall, name: &str) -> Vec<f32> {
    let (columns, _held) = crate::vertices::VertexColumns::of_draw(draw, &MemoryPool::default()).unwrap();
    columns.columns[name].values.clone()
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
12 glBufferData(target = GL_ELEMENT_ARRAY_BUFFER, size = 3, data = blob(\"bytes\"), usage = GL_STATIC_DRAW)
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
    assert!(drawn(huge).unwrap_err().starts_with("call 9: glBufferData: needs"));
    assert!(
        drawn("9 glBufferData(target = A, size = 1, data = blob(\"none\"))")
            .unwrap_err()
            .contains("call 9: none: cannot be read")
    );
}

#[test]
fn frames_end_at_swaps() {
    let text = "1 glDrawBuffers(n = 1)\n2 glDrawArrays()\n3 glXSwapBuffers(dpy = 0x1)\n4 glClear()\n5 eglSwapBuffers()\n6 glDrawElements()\n7 glFinish()\n8 eglSwapBuffers()\n9 glDrawArrays()";
    let frame = |draws: &[u64], last, is_complete| FrameCalls { draws: draws.into(), last, is_complete };
    assert_eq!(frames(text), [frame(&[2], 3, true), frame(&[6], 8, true), frame(&[9], 9, false)]);
}

/// Positions and normals of the fixed function, drawn by call 20 or a list in it.
const TRIANGLE: &str = "11 glBegin(mode = GL_TRIANGLES)
12 glNormal3b(nx = 127, ny = 0, nz = 0)
13 glVertex2f(x = 1, y = 2)
14 glColor4ubv(v = {255, 0, 51, 255})
15 glVertex3dv(v = {3, 4, 5})
16 glNormal3f(nx = 0, ny = 1, nz = 0)
17 glTexCoord2f(s = 0.5, t = 0.25)
18 glMultiTexCoord2f(target = GL_TEXTURE1, s = 9, t = 9)
19 glVertex4f(x = 6, y = 7, z = 8, w = 1)
";

fn fixed(lines: &str) -> Result<DrawCall, String> {
    drawn_within(lines, &MemoryPool::default())
}

#[test]
fn vertices_of_immediate_mode_have_current_values() {
    let draw = fixed(&format!("1 glColor3f(red = 0.5, green = 0.5, blue = 0.5)\n{TRIANGLE}20 glEnd()")).unwrap();
    assert_eq!((draw.mode.as_str(), draw.count, draw.indices.clone().unwrap()), ("GL_TRIANGLES", 3, vec![0, 1, 2]));
    assert_eq!(attribute(&draw, "gl_Vertex"), [1., 2., 0., 1., 3., 4., 5., 1., 6., 7., 8., 1.]);
    assert_eq!(attribute(&draw, "gl_Normal"), [1., 0., 0., 1., 0., 0., 0., 1., 0.]);
    assert_eq!(attribute(&draw, "gl_Color"), [0.5, 0.5, 0.5, 1., 1., 0., 0.2, 1., 1., 0., 0.2, 1.]);
    assert_eq!(attribute(&draw, "gl_MultiTexCoord0"), [0., 0., 0., 1., 0., 0., 0., 1., 0.5, 0.25, 0., 1.]);
}

#[test]
fn flat_triangles_take_normal_and_color_of_their_last_vertex() {
    let flat = "1 glShadeModel(mode = GL_FLAT)\n";
    let draw = fixed(&format!("{flat}{TRIANGLE}20 glEnd()")).unwrap();
    assert_eq!(attribute(&draw, "gl_Normal"), [0., 1., 0.].repeat(3));
    assert_eq!(attribute(&draw, "gl_Color"), [1., 0., 0.2, 1.].repeat(3));
    // A program computes its own colours.
    let draw = fixed(&format!("{flat}2 glUseProgram(program = 3)\n{TRIANGLE}20 glEnd()")).unwrap();
    assert_eq!(attribute(&draw, "gl_Normal")[..3], [1., 0., 0.]);
}

const LIST: &str = "9 glNewList(list = 4, mode = GL_COMPILE)\n10 glShadeModel(mode = GL_FLAT)\n";

#[test]
fn display_list_draws_when_it_is_called() {
    let rest = "20 glEnd()
21 glShadeModel(mode = GL_SMOOTH)
22 glBegin(mode = GL_QUADS)
23 glVertex2i(x = 0, y = 0)
24 glVertex2i(x = 1, y = 0)
25 glNormal3f(nx = 1, ny = 0, nz = 0)
26 glVertex2i(x = 1, y = 1)
27 glVertex2i(x = 0, y = 1)
28 glEnd()
29 glEndList()
30 glNormal3f(nx = 0, ny = 0, nz = -1)
";
    let list = format!("{LIST}{TRIANGLE}{rest}").replace("20 glEnd", "19 glEnd");
    let draw = fixed(&format!("{list}20 glCallList(list = 4)")).unwrap();
    assert_eq!(draw.indices, Some(vec![0, 1, 2, 3, 4, 6, 4, 5, 6]));
    let normals = attribute(&draw, "gl_Normal");
    assert_eq!(normals[..9], [0., 1., 0.].repeat(3), "flat");
    assert_eq!(normals[9..], [0., 1., 0., 0., 1., 0., 1., 0., 0., 1., 0., 0.], "smooth");
    assert_eq!(draw.left_out, [].into());
    // A list within a list.
    let outer = "31 glNewList(list = 5, mode = GL_COMPILE)\n32 glCallList(list = 4)\n33 glEndList()\n";
    let nested = fixed(&format!("{list}{outer}20 glCallList(list = 5)")).unwrap();
    assert_eq!(nested.indices, draw.indices);
    // Compilation alone changes no current value.
    let line = "31 glBegin(mode = GL_TRIANGLES)\n32 glVertex2i(x = 0, y = 0)\n20 glEnd()";
    assert_eq!(attribute(&fixed(&format!("{list}{line}")).unwrap(), "gl_Color"), [1.0; 4]);
}

#[test]
fn state_between_primitives_of_a_list_is_named() {
    let list = |line: &str| {
        fixed(&format!("{LIST}8 glMaterialf()\n{TRIANGLE}19 glEnd()\n19 {line}\n19 glEndList()\n20 glCallList(list = 4)"))
    };
    assert_eq!(list("glMaterialfv(face = GL_FRONT)").unwrap().left_out, ["glMaterialfv".to_owned()].into());
    assert_eq!(list("glFlush()").unwrap().left_out, [].into());
    let text = list("glTranslatef(x = 1, y = 0, z = 0)").unwrap_err();
    assert!(text.starts_with("call 20: glTranslatef: is not followed within a display list"), "{text}");
    let text = list("glRectf(x1 = 0, y1 = 0, x2 = 1, y2 = 1)").unwrap_err();
    assert!(text.starts_with("call 20: glRectf: "), "{text}");
}

#[test]
fn client_arrays_are_filled_with_current_values() {
    let lines = "1 glColor3f(red = 0, green = 0.5, blue = 0)
2 glEnableClientState(array = GL_VERTEX_ARRAY)
3 glEnableClientState(array = GL_NORMAL_ARRAY)
4 glVertexPointer(size = 2, type = GL_FLOAT, stride = 0, pointer = blob(\"floats\"))
5 glNormalPointer(type = GL_FLOAT, stride = 0, pointer = blob(\"normals\"))
6 glClientActiveTexture(texture = GL_TEXTURE1)
7 glEnableClientState(array = GL_TEXTURE_COORD_ARRAY)
8 glPushClientAttrib(mask = GL_CLIENT_VERTEX_ARRAY_BIT)
9 glDisableClientState(array = GL_VERTEX_ARRAY)
10 glPopClientAttrib()
";
    let strip = "20 glDrawArrays(mode = GL_TRIANGLE_STRIP, first = 0, count = 4)";
    let draw = fixed(&format!("{lines}{strip}")).unwrap();
    assert_eq!((draw.mode.as_str(), draw.count, draw.indices.clone()), ("GL_TRIANGLE_STRIP", 4, None));
    assert_eq!(attribute(&draw, "gl_Vertex"), (1_u8..=8).map(f32::from).collect::<Vec<_>>());
    assert_eq!(attribute(&draw, "gl_Color"), [0.0, 0.5, 0.0, 1.0].repeat(4));
    assert_eq!(attribute(&draw, "gl_MultiTexCoord0"), [0.0, 0.0, 0.0, 1.0].repeat(4));
    let unit = "11 glClientActiveTexture(texture = GL_TEXTURE0)
12 glEnableClientState(array = GL_TEXTURE_COORD_ARRAY)
13 glTexCoordPointer(size = 2, type = GL_FLOAT, stride = 0, pointer = blob(\"floats\"))
14 glClientActiveTexture(texture = GL_TEXTURE1)
15 glTexCoordPointer(size = 2, type = GL_FLOAT, stride = 0, pointer = blob(\"two\"))
";
    let textured = fixed(&format!("{lines}{unit}{strip}")).unwrap();
    assert_eq!(attribute(&textured, "gl_MultiTexCoord0"), attribute(&draw, "gl_Vertex"));
    let flat = fixed(&format!("{lines}11 glShadeModel(mode = GL_FLAT)\n{strip}")).unwrap();
    let normals = attribute(&flat, "gl_Normal");
    assert_eq!((flat.count, &normals[..9], &normals[9..]), (6, &[7., 8., 9.].repeat(3)[..], &[10., 11., 12.].repeat(3)[..]));
    // A list holds the arrays of its compilation.
    let list = format!("{lines}11 glNewList(list = 4, mode = GL_COMPILE)\n12 {}\n13 glEndList()\n", &strip[3..]);
    let later = "14 glVertexPointer(size = 2, type = GL_FLOAT, stride = 0, pointer = blob(\"two\"))\n20 glCallList(list = 4)";
    let draw = fixed(&format!("{list}{later}")).unwrap();
    assert_eq!(draw.indices, Some(vec![0, 1, 2, 2, 1, 3]));
    assert_eq!(attribute(&draw, "gl_Vertex")[4..8], [3.0, 4.0, 0.0, 1.0]);
}

#[test]
fn vertices_and_lists_over_the_memory_limit_are_errors() {
    let vertices = |count: usize| "19 glVertex2i(x = 0, y = 0)\n".repeat(count);
    let draw = |text: &str| drawn_within(text, &MemoryPool::new(SMALL));
    assert!(draw(&format!("1 glBegin(mode = GL_TRIANGLES)\n{}20 glEnd()", vertices(3))).is_ok());
    let text = draw(&format!("1 glBegin(mode = GL_TRIANGLES)\n{}20 glEnd()", vertices(60))).unwrap_err();
    assert!(text.contains("vertices of a draw call"), "{text}");
    let text = draw(&format!("1 glNewList(list = 1, mode = GL_COMPILE)\n{}", vertices(500))).unwrap_err();
    assert!(text.contains("a display list"), "{text}");
}

#[test]
fn lists_that_multiply_are_an_error() {
    let mut text = "0 glNewList(list = 0, mode = GL_COMPILE)\n0 glEndList()\n".to_owned();
    for list in 1..=40 {
        let inner = list - 1;
        text += &format!(
            "1 glNewList(list = {list}, mode = GL_COMPILE)\n2 glCallList(list = {inner})\n3 glCallList(list = {inner})\n4 glEndList()\n"
        );
    }
    let error = fixed(&format!("{text}20 glCallList(list = 40)")).unwrap_err();
    assert!(error.contains("call 20: glCallList: executes more than"), "{error}");
    // A list that calls itself ends.
    let own = "1 glNewList(list = 1, mode = GL_COMPILE)\n2 glCallList(list = 1)\n3 glEndList()\n20 glCallList(list = 1)";
    assert_eq!(fixed(own).unwrap().count, 0);
}

#[test]
fn draw_calls_of_the_fixed_function_are_found() {
    let text = "1 glNewList(list = 1, mode = GL_COMPILE)
2 glBegin(mode = GL_TRIANGLES)
3 glEnd()
4 glEndList()
5 glNewList(list = 2, mode = GL_COMPILE)
6 glColor3f(red = 1, green = 1, blue = 1)
7 glEndList()
8 glNewList(list = 3, mode = GL_COMPILE_AND_EXECUTE)
9 glCallList(list = 1)
10 glEndList()
11 glCallList(list = 2)
12 glCallList(list = 3)
13 glBegin(mode = GL_TRIANGLES)
14 glCallList(list = 3)
15 glEnd()
16 glRectf()
17 glXSwapBuffers()";
    assert_eq!(frames(text)[0].draws, [9, 12, 15, 16]);
}

#[test]
fn damaged_trace_never_panics() {
    let list = format!("9 glNewList(list = 4, mode = GL_COMPILE_AND_EXECUTE)\n{TRIANGLE}19 glEnd()\n19 glEndList()\n");
    let arrays = "2 glEnableClientState(array = GL_VERTEX_ARRAY)
3 glVertexPointer(size = 2, type = GL_FLOAT, stride = 0, pointer = blob(\"floats\"))
4 glShadeModel(mode = GL_FLAT)
5 glUseProgram(program = 0)
6 glDrawElements(mode = GL_TRIANGLES, count = 3, type = GL_UNSIGNED_BYTE, indices = blob(\"bytes\"))
7 glMapBufferRange(target = GL_ARRAY_BUFFER, offset = 16, length = 16, access = GL_MAP_WRITE_BIT) = 0x1000
8 memcpy(dest = 0x1008, src = blob(\"two\"), n = 8)
";
    let ends = ["20 glCallList(list = 4)", "20 glDrawArrays(mode = GL_TRIANGLE_STRIP, first = 0, count = 4)"];
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut drawn, mut refused) = (0, 0);
    for round in 0..1000 {
        let text = format!("{SETUP}{arrays}{list}{}", ends[round % 2]);
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for _ in 0..3 {
            let (from, to) = (next(lines.len()), next(lines.len()));
            match next(3) {
                0 => lines.swap(from, to),
                1 => lines[from] = lines[to].clone(),
                _ => {
                    let at = next(lines[from].len());
                    lines[from].replace_range(at..=at, ["9999999999", "0", "-", "(", "\"", "{", ","][next(7)]);
                }
            }
        }
        match drawn_within(&lines.join("\n"), &MemoryPool::default()) {
            Ok(_) => drawn += 1,
            Err(error) => refused += usize::from(!error.is_empty()),
        }
    }
    assert!(drawn > 100 && refused > 100, "{drawn} {refused}");
}
