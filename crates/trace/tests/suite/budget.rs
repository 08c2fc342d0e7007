//! A small file can expand into large data. Each field is counted and refused above the limit.

use basrelief_input::MemoryPool;
use basrelief_signals::resolve_reference;
use basrelief_trace::*;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::{self, Read};

/// Sizes of the budget, of one large field, and of one of many held fields \[bytes\].
const LIMIT: u64 = 2 << 20;
const LONG: usize = 6 << 20;
const SHORT: usize = 48 << 10;

/// The way in which a field of a command becomes large.
#[derive(Clone, Copy)]
enum Hostile {
    /// By a long text.
    Text,
    /// By a list of this item.
    List(&'static str),
    /// By a map to this value.
    Map(&'static str),
    /// By a number that declares a size.
    Size(u32),
    /// Cannot be large: a number, a choice, or a list of fixed length.
    Fixed,
}
use Hostile::{Fixed, List, Map, Size, Text};

/// Every field of every command. Add new fields here.
const FIELDS: &[(&str, &str, Hostile)] = &[
    ("begin", "format", Text),
    ("begin", "version", Fixed),
    ("begin", "width", Fixed), // of pictures: whoever draws them counts them
    ("begin", "height", Fixed),
    ("begin", "generator", Text),
    ("texture", "id", Fixed),
    ("texture", "name", Text),
    ("texture", "kind", Fixed),
    ("texture", "sampler", Fixed),
    ("texture", "width", Size(16_384)),
    ("texture", "height", Size(16_384)),
    ("texture", "levels", Size(12)),
    ("texture", "offset", Fixed),
    ("texture", "sha256", Text),
    ("texture", "data", Text),
    ("texture", "file", Text),
    ("material", "id", Fixed),
    ("material", "name", Text),
    ("material", "base_color", List("1")),
    ("material", "normal_scale", Fixed),
    ("material", "lighting", Fixed),
    ("material", "color_texture", Fixed),
    ("material", "normal_map", Fixed),
    ("material", "double_sided", Fixed),
    ("frame", "index", Fixed),
    ("frame", "camera", Fixed),
    ("frame", "lights", List(r#"{"directional":{"to_light":[0,0,1],"intensity":1}}"#)),
    ("shading", "mode", Fixed),
    ("shading", "ia", Fixed),
    ("shading", "is", Fixed),
    ("object", "id", Fixed),
    ("object", "name", Text),
    ("object", "centre", List("0")),
    ("object", "entries", Fixed),
    ("object", "mesh", Fixed),
    ("importance", "bias", Fixed),
    ("criterion", "error_bound", Fixed),
    ("polygon", "object", Fixed),
    ("polygon", "material", Fixed),
    ("polygon", "lod", Fixed),
    ("polygon", "bump", Fixed),
    ("polygon", "arrival", Fixed),
    ("polygon", "position", List("[0,0,0,1]")),
    ("polygon", "normal", List("[0,0,1]")),
    ("polygon", "tangent", List("[0,0,0,0]")),
    ("polygon", "uv", List("[0,0]")),
    ("polygon", "uv_normal", List("[0,0]")),
    ("polygon", "color", List("[1,1,1,1]")),
    ("polygon", "brightness", List("[1,0]")),
    ("expect", "machine", Text),
    ("expect", "config", Map("1")),
    ("expect", "cycles", Fixed),
    ("expect", "frames", List("1")),
    ("expect", "memories", Map("{}")),
    ("expect", "images", List(r#""ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad""#)),
    ("end", "commands", Fixed),
];

/// Fields of commands that remain in memory in any number.
const KEPT: [(&str, &str); 6] = [
    ("texture", "name"),
    ("material", "name"),
    ("object", "name"),
    ("expect", "config"),
    ("expect", "images"),
    ("expect", "memories"),
];

fn command(name: &str, number: usize) -> Value {
    let camera = json!({"view_projection": ([0; 16]), "to_light": [0, 0, 1], "to_viewer": [0, 0, 1]});
    let lights = json!([{"directional": {"to_light": [0, 0, 1], "intensity": 1}}]);
    match name {
        "begin" => json!({"format": FORMAT, "version": VERSION, "width": 8, "height": 8, "generator": "x"}),
        "texture" => json!({
            "id": number, "name": "x", "kind": "color", "sampler": {"wrap": ["repeat", "clamp"], "filter": "nearest"},
            "width": 1, "height": 1, "levels": 1, "offset": 0, "sha256": Digest::of(&[0; 4]).to_string(), "data": "AAAAAA=="
        }),
        "material" => json!({
            "id": number, "name": "x", "base_color": [1, 1, 1, 1], "normal_scale": 1,
            "lighting": {"ka": 0, "kd": 1, "ks": 0, "n": 1}
        }),
        "frame" => json!({"index": 0, "camera": camera, "lights": lights}),
        "object" => json!({"id": number, "name": "x", "centre": [0, 0, 0]}),
        "polygon" => json!({
            "object": 0, "material": 0, "lod": 0, "bump": false, "arrival": 0,
            "position": [[0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1]]
        }),
        _ => json!({}),
    }
}

/// Returns a command with one field of about `bytes` bytes.
fn hostile((name, field, how): (&str, &str, Hostile), number: usize, bytes: usize) -> String {
    let repeated = |item: String| {
        let count = bytes / (item.len() + 1);
        vec![item; count].join(",")
    };
    let value = match how {
        Text => format!("\"{}\"", "A".repeat(bytes)),
        List(item) => format!("[{}]", repeated(item.into())),
        Map(value) => {
            let entries: Vec<String> = (0..bytes / (value.len() + 12)).map(|i| format!("\"{i:08}\":{value}")).collect();
            format!("{{{}}}", entries.join(","))
        }
        Size(number) => number.to_string(),
        Fixed => unreachable!("not made large"),
    };
    let mut command = command(name, number);
    if let Size(_) = how {
        command["data"] = Value::Null;
        command["file"] = "texels".into();
        (command["width"], command["height"]) = (2048.into(), 512.into());
    }
    command[field] = "VALUE".into();
    format!("{}\n", json!({ name: command }).to_string().replace("\"VALUE\"", &value))
}

/// Returns the commands required before the tested one.
fn before(name: &str) -> String {
    let names = match name {
        "begin" => &[][..],
        "object" => &["begin", "frame"],
        "polygon" => &["begin", "material", "frame", "object"],
        _ => &["begin"],
    };
    names.iter().map(|name| format!("{}\n", json!({ *name: command(name, 0) }))).collect()
}

/// Opens a file beside the trace that never ends.
fn endless(_: &str) -> io::Result<Box<dyn Read>> {
    Ok(Box::new(io::repeat(0)))
}

/// Reads a trace that is compressed to a fraction of the budget, keeps all tokens, and returns the error.
fn error_of(lines: impl Iterator<Item = String>, limit: u64) -> TraceError {
    let mut encoder = zstd::Encoder::new(Vec::new(), 1).expect("an encoder");
    lines.for_each(|line| io::Write::write_all(&mut encoder, line.as_bytes()).expect("in memory"));
    let small = encoder.finish().expect("in memory");
    assert!((small.len() as u64) < LIMIT / 8, "{} bytes", small.len());
    let budget = MemoryPool::new(limit);
    let result = TraceResolver::new(small.as_slice(), endless, &budget).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let error = result.expect_err("more than the budget allows");
    assert_eq!(budget.left(), limit, "what was refused is not held");
    error
}

fn says_so(error: &TraceError, what: &str, limit: &str) {
    let text = error.to_string();
    assert_eq!(error.kind, ErrorKind::OverBudget, "{what}: {text}");
    assert!(text.starts_with("line "), "{what}: {text}");
    assert!(text.contains(&format!("over the limit of {limit}; give more with --memory-limit")), "{what}: {text}");
}

#[test]
fn large_field_of_any_command_exceeds_budget() {
    for &(name, field, how) in FIELDS {
        if let Fixed = how {
            continue;
        }
        // The compressor's own window takes half of this limit.
        let lines = [before(name), hostile((name, field, how), 0, LONG)];
        says_so(&error_of(lines.into_iter(), 2 * LIMIT), &format!("{name}.{field}"), "4 MiB");
    }
}

#[test]
fn small_parts_are_counted() {
    for (name, field) in KEPT {
        let how = FIELDS.iter().find(|(n, f, _)| (*n, *f) == (name, field)).expect("a field").2;
        let many = (0..400).map(|i| hostile((name, field, how), i, SHORT));
        let error = error_of([before(name)].into_iter().chain(many), 2 * LIMIT);
        says_so(&error, &format!("{name}.{field}"), "4 MiB");
        assert!(error.path.starts_with(name), "{error}");
    }
    // These commands have no long fields. Expectations are left out because their number is limited.
    for name in ["texture", "material", "object", "polygon"] {
        let line = |i| format!("{}\n", json!({ name: command(name, if name == "polygon" { 0 } else { i }) }));
        let first = usize::from(name == "material" || name == "object");
        let lines = [before(name)].into_iter().chain((first..40_000).map(line));
        says_so(&error_of(lines, 2 * LIMIT), name, "4 MiB");
    }
}

#[test]
fn many_fitting_textures_together_exceed_budget() {
    let zeros = vec![0; 256 * 256 * TextureKind::Color.texel_bytes() as usize];
    let line = |i| {
        let mut texture = command("texture", i);
        (texture["data"], texture["file"]) = (Value::Null, "texels".into());
        (texture["width"], texture["height"], texture["sha256"]) =
            (256.into(), 256.into(), Digest::of(&zeros).to_string().into());
        format!("{}\n", json!({ "texture": texture }))
    };
    let files = |_: &str| -> io::Result<Box<dyn Read>> { Ok(Box::new(io::repeat(0).take(zeros.len() as u64))) };
    let trace = |count| before("texture") + &(0..count).map(line).collect::<String>();
    let read = |count| {
        let text = trace(count);
        let resolver = TraceResolver::new(text.as_bytes(), files, &MemoryPool::new(LIMIT)).expect("a beginning");
        resolver.filter_map(Result::err).next().expect("it has no end")
    };
    assert_eq!(read(4).kind, ErrorKind::Truncated, "{}", read(4));
    let error = read(8);
    says_so(&error, "textures", "2 MiB");
    assert!(error.path.starts_with("texture"), "{error}");
}

#[test]
fn dropped_tokens_are_not_counted() {
    let line = format!("{}\n", json!({ "polygon": command("polygon", 0) }));
    let text = before("polygon") + &line.repeat(20_000);
    let budget = MemoryPool::new(1 << 20);
    let resolver = TraceResolver::new(text.as_bytes(), NoFiles, &budget).expect("a beginning");
    let passed = resolver.take_while(Result::is_ok).count();
    assert_eq!(passed, 20_000 + 2, "frame, object, polygons");
}

/// The schema of a line has exactly the fields of this table.
#[test]
fn table_of_fields_matches_schema() {
    let schema = schema();
    let mut known = BTreeSet::new();
    for variant in schema["oneOf"].as_array().expect("commands") {
        for (name, command) in variant["properties"].as_object().expect("a command") {
            let fields = resolve_reference(command, &schema)["properties"].as_object().cloned().unwrap_or_default();
            known.extend(fields.keys().map(|field| (name.clone(), field.clone())));
        }
    }
    let listed: BTreeSet<_> = FIELDS.iter().map(|(name, field, _)| ((*name).to_owned(), (*field).to_owned())).collect();
    assert_eq!(listed, known);
}
