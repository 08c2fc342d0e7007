//! Hostile cases: a damaged file, and a command line.

use super::random::RandomChoice as _;
use super::samples::{HostileCase, SHORT, SampleInputs, words};
use super::{mutate, options, scripts, settings};
use basrelief_dse::SplitMix64;
use basrelief_input::MemoryPool;
use basrelief_sim::MACHINES;
use basrelief_trace::{TraceForm, convert};
use serde_json::Value;

/// Kinds of inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum InputKind {
    /// Traces in JSON Lines.
    TraceText,
    /// Traces in binary.
    TraceBinary,
    /// Traces in zstd.
    TraceCompressed,
    /// glTF as JSON.
    Gltf,
    /// glTF as JSON.
    Glb,
    /// Binary glTF (GLB).
    Obj,
    /// PNG and JPEG.
    Picture,
    /// Configurations and cameras.
    Settings,
    /// Recordings.
    Tape,
    /// Plans.
    Plan,
    /// Lists of views.
    Views,
    /// Scenes and tiles of a server.
    Scene,
    /// Command lines.
    Options,
}

const CAMERA: &str = r#"{"view_projection":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"to_light":[0,0,1],"to_viewer":[0,0.5,1]}"#;

impl InputKind {
    /// All kinds.
    pub const ALL: [Self; 13] = [
        Self::TraceText,
        Self::TraceBinary,
        Self::TraceCompressed,
        Self::Gltf,
        Self::Glb,
        Self::Obj,
        Self::Picture,
        Self::Settings,
        Self::Tape,
        Self::Plan,
        Self::Views,
        Self::Scene,
        Self::Options,
    ];

    /// Returns the name for the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::TraceText => "traces, JSON Lines",
            Self::TraceBinary => "traces, binary",
            Self::TraceCompressed => "traces, zstd",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Obj => "OBJ and MTL",
            Self::Picture => "PNG and JPEG",
            Self::Settings => "configurations and cameras",
            Self::Tape => "recordings",
            Self::Plan => "plans",
            Self::Views => "lists of views",
            Self::Scene => "scenes over HTTP",
            Self::Options => "command lines",
        }
    }

    /// Creates one case.
    pub fn case(self, sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
        match self {
            Self::TraceText => trace("t.jsonl", spoiled_lines(random.one::<String>(&sources.traces), random), random),
            Self::TraceBinary => trace("t.bdl", spoiled_form("t.bdl", sources, random), random),
            Self::TraceCompressed => {
                let name = *random.one(&["t.jsonl.zst", "t.bdl.zst"]);
                trace(name, spoiled_form(name, sources, random), random)
            }
            Self::Gltf => model("m.gltf", spoiled_gltf(sources, random).into_bytes(), vec![], random),
            Self::Glb => model("m.glb", spoiled_glb(sources, random), vec![], random),
            Self::Obj => obj(sources, random),
            Self::Picture => picture(sources, random),
            Self::Settings => settings(sources, random),
            Self::Tape => tape(sources, random),
            Self::Plan => scripts::plan(sources, random),
            Self::Views => scripts::views(random),
            Self::Scene => scripts::scene(sources, random),
            Self::Options => command_line(sources, random),
        }
    }
}

fn machine(random: &mut SplitMix64) -> &'static str {
    random.one(MACHINES).name
}

fn trace(name: &str, bytes: Vec<u8>, random: &mut SplitMix64) -> HostileCase {
    let line = match random.below(8) {
        0 => format!("verify {name}"),
        1 => format!("convert {name} back.bdl.zst"),
        2 => format!("run {name} --functional --out out"),
        _ => format!("run {name} {SHORT} --machine {}", machine(random)),
    };
    HostileCase::of_files(vec![(name.into(), bytes)], words(&line))
}

fn model(name: &str, bytes: Vec<u8>, mut files: Vec<(String, Vec<u8>)>, random: &mut SplitMix64) -> HostileCase {
    let line = match random.below(8) {
        0 => format!("record {name} --size 32x24 --out t.jsonl"),
        1 => format!("run {name} --size 32x24 {SHORT} --frames 2 --orbit 30"),
        _ => format!("run {name} --size 32x24 {SHORT} --machine {}", machine(random)),
    };
    files.push((name.into(), bytes));
    HostileCase::of_files(files, words(&line))
}

/// Damages a line as JSON, the text as text, or its bytes.
fn spoiled_lines(text: &str, random: &mut SplitMix64) -> Vec<u8> {
    if random.once_in(4) {
        return mutate::text(text, random).into_bytes();
    }
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = random.below(lines.len());
    if let Ok(mut value) = serde_json::from_str::<Value>(&lines[at]) {
        mutate::document(&mut value, random);
        lines[at] = value.to_string();
    }
    let mut bytes = (lines.join("\n") + "\n").into_bytes();
    if random.once_in(4) {
        mutate::bytes(&mut bytes, random);
    }
    bytes
}

fn spoiled_form(name: &str, sources: &SampleInputs, random: &mut SplitMix64) -> Vec<u8> {
    let form = TraceForm::for_file_name(name).unwrap_or_default();
    let mut bytes = Vec::new();
    // The samples are valid.
    convert(random.one(&sources.traces).as_bytes(), &mut bytes, form, &MemoryPool::default()).unwrap_or_default();
    mutate::bytes(&mut bytes, random);
    bytes
}

fn spoiled_gltf(sources: &SampleInputs, random: &mut SplitMix64) -> String {
    let mut document = random.one(&sources.gltf).clone();
    mutate::document(&mut document, random);
    document.to_string()
}

/// Damages the container of a document with a few bytes behind it, or the document.
fn spoiled_glb(sources: &SampleInputs, random: &mut SplitMix64) -> Vec<u8> {
    let mut json = if random.once_in(2) { spoiled_gltf(sources, random) } else { random.one(&sources.gltf).to_string() };
    json.push_str(&" ".repeat(json.len().next_multiple_of(4) - json.len()));
    let data: Vec<u8> = (0..64).map(|_| random.byte()).collect();
    let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
    let chunks = [&length(json.as_bytes())[..], b"JSON", json.as_bytes(), &length(&data), b"BIN\0", &data].concat();
    let total = (chunks.len() as u32 + 12).to_le_bytes();
    let mut all = [b"glTF", &2u32.to_le_bytes(), &total, &chunks[..]].concat();
    if !random.once_in(3) {
        mutate::bytes(&mut all, random);
    }
    all
}

fn pictures(sources: &SampleInputs) -> Vec<(String, Vec<u8>)> {
    vec![("bumps.png".into(), sources.pictures[0].clone()), ("checks.png".into(), sources.pictures[1].clone())]
}

fn obj(sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
    let (mut object, mut library) = (sources.obj.clone(), sources.mtl.clone());
    if random.once_in(3) {
        library = mutate::text(&library, random);
    } else {
        object = mutate::text(&object, random);
    }
    let mut object = object.into_bytes();
    if random.once_in(4) {
        mutate::bytes(&mut object, random);
    }
    let mut files = pictures(sources);
    files.push(("patch.mtl".into(), library.into_bytes()));
    model("m.obj", object, files, random)
}

/// Creates a model with a damaged picture as colour texture and as normal map.
fn picture(sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
    let mut files = pictures(sources);
    let mut bytes = random.one(&sources.pictures).clone();
    mutate::bytes(&mut bytes, random);
    files[random.below(2)].1 = bytes;
    files.push(("patch.mtl".into(), sources.mtl.clone().into_bytes()));
    model("m.obj", sources.obj.clone().into_bytes(), files, random)
}

fn settings(sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
    let spoiled = |text: &str, random: &mut SplitMix64| {
        let mut bytes = mutate::text(text, random).into_bytes();
        if random.once_in(3) {
            mutate::bytes(&mut bytes, random);
        }
        bytes
    };
    let number = random.below(MACHINES.len());
    let (machine, presets) = (&MACHINES[number], &sources.configurations[number]);
    let (name, bytes, option) = match random.below(4) {
        0 => ("c.json", spoiled(CAMERA, random), "--camera c.json"),
        1 => ("c.toml", spoiled(random.one::<String>(presets), random), "--config c.toml"),
        _ => ("c.toml", settings::configuration(machine, random).into_bytes(), "--config c.toml"),
    };
    let line = format!("demo --machine {} --size 32x24 {SHORT} {option}", machine.name);
    HostileCase::of_files(vec![(name.into(), bytes)], words(&line))
}

/// Damages a recording below its compression, which has its own checksum, or in one of four cases above it.
fn tape(sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
    let mut plain = sources.tape.clone();
    let above = random.once_in(4);
    if !above {
        mutate::bytes(&mut plain, random);
    }
    let mut bytes = zstd::encode_all(&plain[..], 0).unwrap_or_default();
    if above {
        mutate::bytes(&mut bytes, random);
    }
    let line = match random.below(8) {
        0 => "size-fifos t.tape".into(),
        1 => "resimulate t.tape --bottlenecks --out out".into(),
        2 => format!("resimulate t.tape --set fifo.spans.depth={} --json", 1 << random.below(8)),
        _ => "resimulate t.tape --no-bottlenecks --out out".to_owned(),
    };
    HostileCase::of_files(vec![("t.tape".into(), bytes)], words(&line))
}

fn command_line(sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
    let model = serde_json::to_vec(&sources.gltf[0]).unwrap_or_default();
    let files = vec![("t0.jsonl".into(), sources.traces[0].clone().into_bytes()), ("m.gltf".into(), model)];
    let named = |word: String| match word.as_str() {
        "FILE" => "t0.jsonl".into(),
        "MODEL" => "m.gltf".into(),
        _ => word,
    };
    HostileCase::of_files(files, options::command_line(random).into_iter().map(named).collect())
}
