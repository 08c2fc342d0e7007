//! Every malformed trace ends with an error that names the place and the field.

use crate::common::*;
use basrelief_input::MemoryPool;
use basrelief_signals::{Control, Material, Texture};
use basrelief_trace::*;
use proptest::prelude::*;
use std::sync::Arc;
use std::time::{Duration, Instant};

fn error_of(bytes: &[u8]) -> TraceError {
    resolve(bytes).expect_err("a malformed trace must not pass")
}

/// Returns the error of the sample with one text replaced by another.
fn with(from: &str, to: &str) -> TraceError {
    assert!(SAMPLE.contains(from), "the sample has no {from}");
    error_of(SAMPLE.replacen(from, to, 1).as_bytes())
}

const TOO_LARGE: &str = "number out of range";

/// Text in the sample, its replacement, and the error: line, path, part of the message.
const CASES: &[(&str, &str, u64, &str, &str)] = &[
    // Text that is not a command.
    (r#"{"texture":{"id":0"#, r#"{"texure":{"id":0"#, 2, "", "unknown command `texure`, expected one of `begin`"),
    (r#"{"object""#, "[1,2", 6, "", "expected"),
    (r#"{"frame_end":{}}"#, "", 8, "", "the line is blank, expected a command"),
    (r#"{"frame_end":{}}"#, r#"{"frame_end":{}} x"#, 8, "", "trailing characters"),
    (r#"{"frame_end":{}}"#, r#"{"frame_end":{},"frame_end":{}}"#, 8, "", "expected"),
    (r#"{"frame_end":{}}"#, r#"{"frame_end":{"x":0}}"#, 8, "frame_end", "unknown field `x`"),
    (r#"{"frame_end":{}}"#, "\u{0}", 8, "", "expected a value"),
    // Fields.
    (r#""lod":3,"#, "", 7, "polygon", "missing field `lod`"),
    (r#""lod":3"#, r#""lod":3,"lod":3"#, 7, "polygon", "duplicate field `lod`"),
    (r#""lod":3"#, r#""lod":3,"level":3"#, 7, "polygon", "unknown field `level`"),
    (r#""lod":3"#, r#""lod":"3""#, 7, "polygon.lod", "the text \"3\" stands here, expected a whole number 0..=255"),
    (r#""lod":3"#, r#""lod":64"#, 7, "polygon.lod", "is 64, expected 0..=63"),
    (r#""lod":3"#, r#""lod":-1"#, 7, "polygon.lod", "the number -1 stands here"),
    (r#""bump":true"#, r#""bump":1"#, 7, "polygon.bump", "the number 1 stands here, expected true or false"),
    (
        r#""wrap":["repeat","clamp"]"#,
        r#""wrap":["repeat"]"#,
        2,
        "texture.sampler.wrap",
        "a list of 1 stands here, expected a list of 2",
    ),
    (r#""clamp"]"#, r#""border"]"#, 2, "texture.sampler.wrap[1]", "unknown value `border`"),
    (r#""filter":"bilinear""#, r#""filter":"bilinear","bias":1"#, 2, "texture.sampler", "unknown field `bias`"),
    (r#""n":32.0"#, r#""n":32.0,"m":1"#, 4, "material.lighting", "unknown field `m`"),
    (r#"{"directional""#, r#"{"spot""#, 5, "frame.lights[0]", "unknown value `spot`"),
    // begin
    (r#""format":"basrelief-display-list""#, r#""format":"gltf""#, 1, "begin.format", "no display list"),
    (r#""version":1"#, r#""version":2,"new":true"#, 1, "begin.version", "is 2, this reader knows 1"),
    (r#""width":8"#, r#""width":0"#, 1, "begin.width", "is 0, expected 1..=16384"),
    (r#""height":8"#, r#""height":4294967295"#, 1, "begin.height", "expected 1..=16384"),
    (r#""width":8,"height":8"#, r#""width":16384,"height":16384"#, 1, "begin.height", "16384 x 16384 pixels, expected at most"),
    (r#""height":8"#, r#""height":1e99"#, 1, "begin.height", "stands here, expected a whole number"),
    (
        r#"{"frame_end""#,
        "{\"begin\":{\"format\":\"basrelief-display-list\",\"version\":1,\"width\":8,\"height\":8,\"generator\":\"\"}}\n{\"frame_end\"",
        8,
        "begin",
        "a second time",
    ),
    // Textures.
    (r#""id":1,"name":"bumps""#, r#""id":0,"name":"bumps""#, 3, "texture.id", "is 0, which is defined already"),
    (r#""width":2"#, r#""width":16385"#, 2, "texture.width", "expected 1..=16384"),
    (
        r#""width":2,"height":2,"levels":1"#,
        r#""width":16384,"height":16384,"levels":1"#,
        2,
        "texture.data",
        "holds 16 bytes, expected 1073741824",
    ),
    (r#""levels":1"#, r#""levels":3"#, 2, "texture.levels", "is 3, expected 1..=2"),
    (r#""levels":1"#, r#""levels":4000000000"#, 2, "texture.levels", "expected 1..=2"),
    (r#""offset":16"#, r#""offset":8"#, 3, "texture.offset", "a multiple of 16"),
    (r#""offset":16"#, r#""offset":1099511627776"#, 3, "texture.offset", "below 2^40"),
    (r#""data":"AAEC"#, r#""data":"!AEC"#, 2, "texture.data", "base64"),
    (r#""data":"AAEC"#, r#""data":"BAEC"#, 2, "texture.sha256", "damaged"),
    (r#""data":"AAEC"#, r#""file":"a.rgba","data":"AAEC"#, 2, "texture.file", "stands beside `data`"),
    (r#""data":"AAEC"#, r#""file":"AAEC"#, 2, "texture.file", "cannot read"),
    (r#""data":"AAEC"#, r#""file":"../AAEC"#, 2, "texture.file", "expected a relative path"),
    (r#""data":"AAEC"#, r#""file":"/AAEC"#, 2, "texture.file", "expected a relative path"),
    (r#""data":"AAEC"#, r#""file":"c:\\AAEC"#, 2, "texture.file", "expected a relative path"),
    (r#""sha256":"be"#, r#""sha256":"BE"#, 2, "texture.sha256", "lower-case"),
    // Materials.
    (r#""color_texture":0"#, r#""color_texture":9"#, 4, "material.color_texture", "is 9, which is not defined"),
    (r#""color_texture":0"#, r#""color_texture":1"#, 4, "material.color_texture", "of the other kind"),
    (r#""normal_map":1"#, r#""normal_map":0"#, 4, "material.normal_map", "of the other kind"),
    (r#""base_color":[0.5"#, r#""base_color":[1e39"#, 4, "material.base_color", TOO_LARGE),
    (r#""base_color":[0.5"#, r#""base_color":[-0.5"#, 4, "material.base_color", "is -0.5, expected 0..=1"),
    (r#""normal_scale":1.0"#, r#""normal_scale":-1e39"#, 4, "material.normal_scale", TOO_LARGE),
    (r#""n":32.0"#, r#""n":0.5"#, 4, "material.lighting.n", "expected 1..=1000"),
    (r#""ka":0.1"#, r#""ka":-0.1"#, 4, "material.lighting.ka", "expected 0..=1"),
    // Frames and objects.
    (r#""index":0"#, r#""index":1"#, 5, "frame.index", "is 1, expected 0"),
    (
        r#""view_projection":[1.0,"#,
        r#""view_projection":["#,
        5,
        "frame.camera.view_projection",
        "a list of 15 stands here, expected a list of 16",
    ),
    (r#""view_projection":[1.0"#, r#""view_projection":[NaN"#, 5, "frame.camera.view_projection[0]", "expected a value"),
    (
        r#""view_projection":[1.0"#,
        r#""view_projection":[null"#,
        5,
        "frame.camera.view_projection[0]",
        "null stands here, expected a number",
    ),
    (r#""view_projection":[1.0"#, r#""view_projection":[1e400"#, 5, "frame.camera.view_projection[0]", "out of range"),
    (r#""intensity":0.5"#, r#""intensity":1e39"#, 5, "frame.lights[1]", TOO_LARGE),
    (r#""intensity":0.5"#, r#""intensity":-0.5"#, 5, "frame.lights[1].intensity", "is -0.5, expected 0 or more"),
    (r#""entries":64"#, r#""entries":0"#, 6, "object.entries", "expected 1..=65536"),
    (r#""centre":[0.0"#, r#""centre":[1e39"#, 6, "object.centre", TOO_LARGE),
    // Polygons.
    (r#""object":5"#, r#""object":6"#, 7, "polygon.object", "is 6, expected the current object, and it is 5"),
    (r#""material":3,"#, r#""material":4,"#, 7, "polygon.material", "is 4, which is not defined"),
    (r#""arrival":12"#, r#""arrival":100000000001"#, 7, "polygon.arrival", "expected 0..=100000000000"),
    (",[0.0,8.0,0.5,1.0]]", "]", 7, "polygon.position", "holds 2 vertices, expected 3..=64"),
    ("[8.0,0.0,0.5,1.0]", "[600000,0.0,0.5,1.0]", 7, "polygon.position[1]", "within +-524288"),
    ("[8.0,0.0,0.5,1.0]", "[8.0,-1e9,0.5,1.0]", 7, "polygon.position[1]", "within +-524288"),
    ("[8.0,0.0,0.5,1.0]", "[8.0,0.0,2.5,1.0]", 7, "polygon.position[1]", "depth is 2.5, expected 0..=1, and for rounded corners"),
    ("[8.0,0.0,0.5,1.0]", "[8.0,0.0,-1.5,1.0]", 7, "polygon.position[1]", "depth is -1.5"),
    ("[8.0,0.0,0.5,1.0]", "[8.0,0.0,0.5,0]", 7, "polygon.position[1]", "1 / w is 0"),
    ("[8.0,0.0,0.5,1.0]", "[8.0,0.0,0.5,1e39]", 7, "polygon.position[1]", TOO_LARGE),
    ("[8.0,0.0,0.5,1.0]", "[8.0,0.0,0.5]", 7, "polygon.position[1]", "a list of 3 stands here, expected a list of 4"),
    ("[1.0,0.0,0.0,1.0],", "", 7, "polygon.tangent", "holds 2 vertices, expected 3"),
    (r#""uv_normal":[[0.0"#, r#""uv_normal":[[1e39"#, 7, "polygon.uv_normal[0]", TOO_LARGE),
    // Order.
    (r#"{"frame_end""#, "{\"frame_end\":{}}\n{\"frame_end\"", 9, "frame_end", "outside a frame"),
    ("{\"frame_end\":{}}\n", "", 8, "expect", "inside a frame"),
    (r#"{"object":"#, "{\"frame_end\":{}}\n{\"object\":", 7, "object", "outside a frame"),
    (r#""cycles":100"#, r#""cycles":-1"#, 9, "expect.cycles", "the number -1 stands here"),
    (r#""replacement.codebook":"fixed""#, r#""replacement.codebook":{}"#, 9, "expect.config", "a switch, a number"),
    // end
    (r#""commands":9"#, r#""commands":8"#, 10, "end.commands", "is 8, but 9 commands"),
    (r#""commands":9"#, r#""commands":1e18"#, 10, "end.commands", "stands here, expected a whole number"),
    (r#""commands":9"#, r#""commands":1000000000000000000"#, 10, "end.commands", "9 commands stand before it"),
    ("{\"commands\":9}}\n", "{\"commands\":9}}\n\nx", 11, "", "after `end`"),
];

#[test]
fn mistake_is_named_by_line_and_field() {
    let mut missed = Vec::new();
    for (from, to, line, path, message) in CASES {
        let error = with(from, to);
        let at_line = matches!(error.place, TracePlace::Line { line: found, .. } if found == *line);
        let at_field = error.path.starts_with(path) && path.is_empty() == error.path.is_empty();
        if !at_line || !at_field || !error.to_string().contains(message) {
            missed.push(format!("{from} -> {to}: {error}"));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn misplaced_shading_command_is_refused() {
    let shading = r#"{"shading":{"mode":"polyhedron","is":0.5}}"#;
    let lines: Vec<&str> = SAMPLE.lines().collect();
    let ahead_of = |name: &str, line: &str| {
        let at = lines.iter().position(|line| line.starts_with(&format!("{{\"{name}\""))).unwrap();
        let text = [&lines[..at], &[line], &lines[at..]].concat().join("\n") + "\n";
        text.replace(r#"{"commands":9}"#, r#"{"commands":10}"#)
    };
    for name in ["frame", "object"] {
        resolve(ahead_of(name, shading).as_bytes()).unwrap();
    }
    for name in ["texture", "polygon", "frame_end", "expect", "end"] {
        let error = error_of(ahead_of(name, shading).as_bytes());
        assert!(error.to_string().contains("stands behind `shading`"), "{name}: {error}");
    }
    for (wrong, message) in [
        (r#"{"shading":{"ia":16.5}}"#, "is 16.5, expected 0..=16"),
        (r#"{"shading":{"is":-1}}"#, "is -1, expected 0..=16"),
        (r#"{"shading":{"mode":"flat"}}"#, "flat"),
        (r#"{"shading":{"n":1}}"#, "n"),
    ] {
        let error = error_of(ahead_of("object", wrong).as_bytes());
        assert!(error.to_string().contains(message), "{wrong}: {error}");
    }
}

/// Returns the sample with other depths of its polygon.
fn with_depths(depths: [f32; 3]) -> String {
    let mut text = SAMPLE.to_string();
    for ([x, y], depth) in [["0.0", "0.0"], ["8.0", "0.0"], ["0.0", "8.0"]].iter().zip(depths) {
        text = text.replacen(&format!("[{x},{y},0.5,1.0]"), &format!("[{x},{y},{depth:?},1.0]"), 1);
    }
    text
}

#[test]
fn polygon_behind_far_plane_is_refused() {
    let error = error_of(with_depths([1.5, 1.25, 1.5]).as_bytes()).to_string();
    assert!(error.starts_with("line 7: polygon.position: has depths above 1 only, expected at least one in 0..=1"), "{error}");
    for rounded in [[1.0, 1.0, 1.0], [1.0001, 1.0001, 1.0001], [1.5, 1.5, 0.9], [-0.5, -0.5, -0.5]] {
        assert!(resolve(with_depths(rounded).as_bytes()).is_ok(), "{rounded:?}");
    }
}

/// By default, serde reads a list as a struct, field by field. The test tries this for every object of every command, at any
/// depth.
#[test]
fn list_in_place_of_object_is_refused() {
    let lists = [
        (r#"{"frame_end":{}}"#, r#"{"frame_end":[]}"#),
        (r#"{"end":{"commands":9}}"#, r#"{"end":[9]}"#),
        (r#"{"wrap":["repeat","clamp"],"filter":"bilinear"}"#, r#"[["repeat","clamp"],"bilinear"]"#),
    ];
    for (from, to) in lists {
        let error = with(from, to).to_string();
        assert!(error.contains("a list stands here, expected an object"), "{error}");
    }
    for (i, line) in SAMPLE.lines().enumerate() {
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        let mut objects = Vec::new();
        objects_in(&value, String::new(), &mut objects);
        // If the first line is a list, the first byte of the trace already fails.
        for pointer in objects.into_iter().filter(|pointer| i > 0 || !pointer.is_empty()) {
            let mut changed = value.clone();
            let object = changed.pointer_mut(&pointer).unwrap();
            *object = object.as_object().unwrap().values().cloned().collect();
            let text: Vec<String> =
                SAMPLE.lines().enumerate().map(|(k, l)| if k == i { changed.to_string() } else { l.into() }).collect();
            let error = error_of((text.join("\n") + "\n").as_bytes());
            assert!(matches!(error.place, TracePlace::Line { line, .. } if line == i as u64 + 1), "{pointer}: {error}");
        }
    }
}

fn objects_in(value: &serde_json::Value, pointer: String, objects: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(map) => {
            map.iter().for_each(|(key, inner)| objects_in(inner, format!("{pointer}/{key}"), objects));
            objects.push(pointer);
        }
        serde_json::Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, inner)| objects_in(inner, format!("{pointer}/{i}"), objects));
        }
        _ => {}
    }
}

#[test]
fn syntax_error_is_named_by_column() {
    let error = with(r#""lod":3"#, r#""lod":x"#);
    assert_eq!(
        error.to_string(),
        "line 7, column 43: polygon.lod: expected a value: a number, a text in quotes, a list, an object, true, false or null"
    );
}

#[test]
fn other_file_is_refused_by_its_first_bytes() {
    for bytes in [&b"\xef\xbb\xbf{\"begin\""[..], b"\n", b"PNG", &[0; 64]] {
        assert!(error_of(bytes).to_string().contains("no display list"));
    }
    assert!(error_of(b"glTF\x02\0\0\0").to_string().contains("a binary glTF model, expected a display list; save the model"));
    assert_eq!(error_of(b"").kind, ErrorKind::Truncated);
    assert_eq!(error_of(b"{\"end\":{\"commands\":0}}\n").to_string(), "line 1: end: stands first; expected `begin`");
}

#[test]
fn falling_arrival_is_refused() {
    let polygon = SAMPLE.lines().nth(6).unwrap();
    let earlier = polygon.replace(r#""arrival":12"#, r#""arrival":11"#);
    let error = with(polygon, &format!("{polygon}\n{earlier}"));
    assert_eq!(error.to_string(), "line 8: polygon.arrival: is 11, before the 12 of an earlier polygon");
}

#[test]
fn excess_expectations_are_refused() {
    let with = |count: usize| {
        let mut lines: Vec<String> = SAMPLE.lines().filter(|l| !l.starts_with("{\"expect\"")).map(str::to_owned).collect();
        lines.pop();
        lines.extend(vec!["{\"expect\":{}}".into(); count]);
        lines.push(format!("{{\"end\":{{\"commands\":{}}}}}\n", lines.len()));
        resolve(lines.join("\n").as_bytes())
    };
    assert!(with(MAX_EXPECTATIONS).is_ok());
    let error = with(MAX_EXPECTATIONS + 1).unwrap_err().to_string();
    assert_eq!(error, "line 73: expect: is one too many, expected at most 64: `verify` replays the trace for each");
}

#[test]
fn trace_without_frame_is_refused() {
    let begin = SAMPLE.lines().next().unwrap();
    let error = error_of(format!("{begin}\n{{\"end\":{{\"commands\":1}}}}\n").as_bytes());
    assert_eq!(error.to_string(), "line 2: end: no frame before it: nothing to draw");
}

#[test]
fn truncation_at_every_byte_is_an_error_in_every_form() {
    for form in TraceForm::ALL {
        let bytes = sample_as(form);
        assert!(resolve(&bytes).is_ok());
        // The line end after the last command may be missing.
        let whole = bytes.len() - usize::from(form == TraceForm { encoding: TraceEncoding::JsonLines, compressed: false });
        for length in 0..whole {
            assert!(resolve(&bytes[..length]).is_err(), "{form:?} cut to {length} of {} bytes", bytes.len());
            assert!(convert(&bytes[..length], Vec::new(), form, &MemoryPool::default()).is_err(), "{form:?} cut to {length}");
        }
    }
}

#[test]
fn trailing_byte_is_an_error_in_every_form() {
    for form in TraceForm::ALL {
        let mut bytes = sample_as(form);
        bytes.push(b'x');
        assert!(resolve(&bytes).is_err(), "{form:?}");
    }
}

#[test]
fn json_lines_end_with_or_without_a_line_end() {
    let whole = resolve(SAMPLE.as_bytes()).unwrap();
    for end in ["", "\n", "\r\n", "\n\n \t\r\n"] {
        let text = [SAMPLE.trim_end(), end].concat();
        assert_eq!(resolve(text.as_bytes()).unwrap(), whole, "{end:?}");
    }
    let error = error_of(SAMPLE.trim_end().trim_end_matches('}').as_bytes()).to_string();
    assert!(error.contains("the last line is incomplete: the trace is truncated"), "{error}");
}

fn binary(version: u32, records: &[&[u8]]) -> Vec<u8> {
    let mut bytes = b"\x89BDL\r\n\x1a\n".to_vec();
    bytes.extend(version.to_le_bytes());
    for record in records {
        bytes.extend((record.len() as u32).to_le_bytes());
        bytes.extend(*record);
    }
    bytes
}

#[test]
fn binary_trace_of_other_version_is_refused() {
    let error = error_of(&binary(2, &[]));
    assert_eq!((error.kind, error.path.as_str()), (ErrorKind::Unsupported, "begin.version"));
}

#[test]
fn bad_record_is_named_by_number_and_command() {
    let whole = sample_as(TraceForm { encoding: TraceEncoding::Binary, compressed: false });
    let begin = whole[16..].split_at(whole[12] as usize).0;
    for (record, says) in [
        (&[99][..], "record 2: unknown command: not a valid record"),
        (&[], "record 2: unknown command: not a valid record"),
        (&[5, 1], "record 2: polygon: not a valid record"),
        (&[6, 0], "record 2: frame_end: not a valid record (1 bytes too many)"),
        (&[6], "record 2: frame_end: stands outside a frame"),
        (&[1, 0, 0xff, 0xff, 0xff, 0xff, 0x0f], "record 2: texture: not a valid record"),
        (&[7, 0, 0xff, 0xff, 0xff, 0xff, 0x0f], "record 2: expect: not a valid record"),
    ] {
        let error = error_of(&binary(1, &[begin, record]));
        assert!(error.to_string().starts_with(says), "{record:?}: {error}");
    }
    let mut huge = binary(1, &[begin]);
    huge.extend([0xff, 0xff, 0xff, 0xff, 1]);
    assert!(error_of(&huge).to_string().contains("at most 512 MiB for a texture"));
    let mut missing = binary(1, &[begin]);
    missing.extend([0, 0, 0, 0x1f, 1]);
    assert_eq!(error_of(&missing).kind, ErrorKind::Truncated);
}

#[test]
fn non_finite_number_in_binary_is_refused() {
    let whole = sample_as(TraceForm { encoding: TraceEncoding::Binary, compressed: false });
    let at = whole.windows(4).position(|bytes| bytes == 0.25f32.to_le_bytes()).unwrap();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        let error = error_of(&bytes).to_string();
        assert!(error.starts_with("record 4: material.base_color: holds a number that is not finite"), "{error}");
    }
}

/// Numbers in a file cause no allocation and no work. Each of these would otherwise take gigabytes or minutes.
#[test]
fn bombs_are_cheap_errors() {
    let begin = format!("{}\n", SAMPLE.lines().next().unwrap());
    let deep = format!("{begin}{}", "[".repeat(1 << 20)) + "\n";
    let nested = format!("{begin}{{\"expect\":{{\"config\":{{\"a\":{}", "[".repeat(1 << 20)) + "\n";
    let long = format!("{begin}{{\"object\":{{\"name\":\"{}", "a".repeat(17 << 20)) + "\n";
    let start = Instant::now();
    for (bytes, says) in [(&deep, "line 2"), (&nested, "line 2"), (&long, "at most 512 MiB for a texture and 16 MiB for others")]
    {
        let error = error_of(bytes.as_bytes());
        assert!(error.to_string().contains(says) && error.to_string().len() < 400, "{error}");
    }
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn all_textures_together_are_bounded() {
    let definition = |id: u32| {
        format!(
            "{{\"texture\":{{\"id\":{id},\"name\":\"\",\"kind\":\"color\",\"sampler\":{{\"wrap\":[\"clamp\",\"clamp\"],\
             \"filter\":\"nearest\"}},\"width\":16384,\"height\":16384,\"levels\":2,\"offset\":0,\"sha256\":\"{}\",\
             \"file\":\"a\"}}}}\n",
            "0".repeat(64)
        )
    };
    let error = error_of(format!("{}\n{}", SAMPLE.lines().next().unwrap(), definition(0)).as_bytes());
    assert_eq!(error.path, "texture.width");
}

fn sample_material() -> Arc<Material> {
    let controls = resolve(SAMPLE.as_bytes()).unwrap();
    let found = controls.iter().find_map(|c| if let Control::Polygon(p) = c { Some(Arc::clone(&p.material)) } else { None });
    found.unwrap()
}

/// Returns the error of recording the sample with a changed material.
fn recording(change: impl Fn(&mut Material)) -> TraceError {
    let mut material = (*sample_material()).clone();
    change(&mut material);
    let material = Arc::new(material);
    let mut recorder = TraceRecorder::new(Vec::new(), TraceForm::default(), BeginCommand::new(8, 8)).unwrap();
    let controls = resolve(SAMPLE.as_bytes()).unwrap();
    let result = controls.iter().try_for_each(|control| {
        recorder.record(control)?;
        if let Control::Polygon(polygon) = control {
            let mut polygon = (**polygon).clone();
            polygon.material = Arc::clone(&material);
            recorder.record(&Control::Polygon(Arc::new(polygon)))?;
        }
        Ok(())
    });
    result.unwrap_err()
}

fn altered(texture: &Option<Arc<Texture>>, change: impl Fn(&mut Texture)) -> Option<Arc<Texture>> {
    let mut texture = (**texture.as_ref().unwrap()).clone();
    change(&mut texture);
    Some(Arc::new(texture))
}

#[test]
fn unreadable_command_is_not_recorded() {
    let says = |change: &dyn Fn(&mut Material), part: &str| {
        let error = recording(change);
        assert!(error.to_string().contains(part), "{error}");
    };
    says(&|m| m.normal_scale = 2.0, "material.id: is 3, the number of a different one");
    says(&|m| (m.id, m.normal_scale) = (4, f32::NAN), "material.normal_scale: holds a number that is not finite");
    says(
        &|m| {
            m.id = 4;
            m.color_texture = altered(&m.color_texture, |t| t.offset = 32);
        },
        "texture.id: is 0, the number of a different one",
    );
    says(&|m| (m.id, m.color_texture) = (4, m.normal_map.clone()), "used as colour and as normal map");
    let fresh = |change: fn(&mut Texture)| {
        move |m: &mut Material| {
            m.id = 4;
            m.normal_map = altered(&m.normal_map, |t| {
                t.id = 9;
                change(t);
            });
        }
    };
    says(&fresh(|t| t.levels.clear()), "texture.levels: is 0");
    says(&fresh(|t| t.levels[1].width = 2), "texture.levels[1]: is 2 x 1 with 1 texels, expected 1 x 1");
    says(&fresh(|t| t.levels[1].texels.clear()), "texture.levels[1]: is 1 x 1 with 0 texels");
    says(&fresh(|t| t.levels[1].texels[0][3] = 0), "has alpha");
    says(&fresh(|t| t.offset = 3), "texture.offset");
}

#[test]
fn unusable_criterion_is_refused() {
    let controls = resolve(SAMPLE.as_bytes()).unwrap();
    for (error_bound, is_kept) in [(0.001, true), (1024.0, true), (0.0, false), (-1.0, false), (f64::NAN, false), (1e9, false)] {
        let mut recorder = TraceRecorder::new(Vec::new(), TraceForm::default(), BeginCommand::new(8, 8)).unwrap();
        recorder.record(&controls[0]).unwrap();
        let recorded = recorder.record(&Control::Criterion(error_bound));
        assert_eq!(recorded.is_ok(), is_kept, "{error_bound}");
        if let Err(error) = recorded {
            assert!(error.to_string().contains("expected 0.001..=1024"), "{error}");
        }
    }
}

#[test]
fn recorder_refuses_wrong_frame_order() {
    let controls = resolve(SAMPLE.as_bytes()).unwrap();
    let recorder = || TraceRecorder::new(Vec::new(), TraceForm::default(), BeginCommand::new(8, 8)).unwrap();
    let error = recorder().record(&controls[2]).unwrap_err();
    assert!(error.to_string().contains("polygon: stands outside a frame"), "{error}");
    assert!(recorder().finish(Vec::new()).unwrap_err().to_string().contains("no frame"));
    let mut open_frame = recorder();
    open_frame.record(&controls[0]).unwrap();
    assert!(open_frame.finish(Vec::new()).unwrap_err().to_string().contains("inside a frame"));
    let mut other_size = TraceRecorder::new(Vec::new(), TraceForm::default(), BeginCommand::new(9, 8)).unwrap();
    assert!(other_size.record(&controls[0]).unwrap_err().to_string().contains("is 8 x 8, expected 9 x 8"));
    let criterion = Control::Criterion(0.5);
    assert!(recorder().record(&criterion).unwrap_err().to_string().contains("criterion: stands outside a frame"));
    let code_book = Control::CodeBook(Arc::new(Vec::new()));
    assert!(recorder().record(&code_book).unwrap_err().to_string().contains("belongs in no display list"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn garbage_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..512), head in 0..4usize) {
        let heads: [&[u8]; 4] = [b"", b"{\"begin\":", b"\x89BDL\r\n\x1a\n\x01\0\0\0", &[0x28, 0xb5, 0x2f, 0xfd]];
        prop_assert!(resolve(&[heads[head], &bytes].concat()).is_err());
    }

    #[test]
    fn damaged_trace_never_panics(form in 0..4usize, at in any::<proptest::sample::Index>(), value in any::<u8>()) {
        let mut bytes = sample_as(TraceForm::ALL[form]);
        let at = at.index(bytes.len());
        bytes[at] = value;
        if let Ok(controls) = resolve(&bytes) {
            let BeginCommand { width, height, .. } = open(bytes.as_slice(), &MemoryPool::default()).unwrap().begin().clone();
            let mut recorder = TraceRecorder::new(Vec::new(), TraceForm::default(), BeginCommand::new(width, height)).unwrap();
            controls.iter().try_for_each(|control| recorder.record(control)).unwrap();
        }
    }
}
