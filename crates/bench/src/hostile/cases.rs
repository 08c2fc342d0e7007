//! Hostile cases: a damaged file, and a command line.

use super::random::RandomChoice as _;
use super::server::{HostileAnswers, SampleScene};
use super::{mutate, options, scripts, settings};
use basrelief_dse::SplitMix64;
use basrelief_sim::{MACHINES, MachineInfo};
use basrelief_trace::{TraceForm, convert};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

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

/// A run of the program.
#[derive(Clone, Debug, PartialEq)]
pub struct HostileCase {
    /// Files in its folder.
    pub files: Vec<(String, Vec<u8>)>,
    /// Arguments of the program; SERVER is the address of the hostile server.
    pub arguments: Vec<String>,
    /// Answers of the hostile server, if the program requests any.
    pub served: Option<HostileAnswers>,
}

impl HostileCase {
    /// Makes a case without a server.
    pub(super) fn of_files(files: Vec<(String, Vec<u8>)>, arguments: Vec<String>) -> Self {
        Self { files, arguments, served: None }
    }
}

/// Valid inputs, to be damaged.
#[derive(Clone, Debug)]
pub struct SampleInputs {
    traces: Vec<String>,
    gltf: Vec<Value>,
    obj: String,
    mtl: String,
    pictures: Vec<Vec<u8>>,
    /// Presets of each machine, in the order of [`MACHINES`].
    configurations: Vec<Vec<String>>,
    tape: Vec<u8>,
    scene: SampleScene,
}

const WORKSPACE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
/// Options of every run of a file: short, and without analyses that other cases cover.
pub(super) const SHORT: &str = "--max-cycles 200000 --out out";
const CAMERA: &str = r#"{"view_projection":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"to_light":[0,0,1],"to_viewer":[0,0.5,1]}"#;

impl SampleInputs {
    /// Reads the samples of the workspace.
    ///
    /// # Errors
    /// Returns an error if a sample cannot be read.
    pub fn load() -> Result<Self, String> {
        let bytes = |name: &str| fs::read(Path::new(WORKSPACE).join(name)).map_err(|e| format!("{name}: {e}"));
        let text = |name: &str| bytes(name).map(|b| String::from_utf8_lossy(&b).into_owned());
        let json = |name: &str| text(name).and_then(|t| serde_json::from_str(&t).map_err(|e| format!("{name}: {e}")));
        Ok(Self {
            traces: vec![text("crates/sim/src/quad.dl.jsonl")?, text("traces/patch-per-polygon.jsonl")?],
            gltf: vec![json("tests/models/patch.gltf")?, json("tests/models/alcove.gltf")?],
            obj: text("tests/models/patch.obj")?,
            mtl: text("tests/models/patch.mtl")?,
            pictures: ["tests/models/bumps.png", "tests/models/checks.png", "fuzz/seeds/image/tile.jpg"]
                .map(bytes)
                .into_iter()
                .collect::<Result<_, _>>()?,
            tape: bytes("fuzz/seeds/tape/corridor")?,
            scene: SampleScene::load(&Path::new(WORKSPACE).join("tests/models/patch.obj"))?,
            configurations: MACHINES.iter().map(presets).collect::<Result<_, _>>()?,
        })
    }

    /// Returns a small trace.
    pub(super) fn trace(&self) -> &str {
        &self.traces[0]
    }

    /// Returns a scene as a server sends it, without compression.
    pub(super) fn scene(&self) -> &[u8] {
        &self.scene.plain
    }

    /// Returns the sample scene, for the hostile server.
    pub fn sample_scene(&self) -> &SampleScene {
        &self.scene
    }
}

/// Returns the presets of a machine, `presets/MACHINE-NAME.toml`, in order of name.
fn presets(machine: &MachineInfo) -> Result<Vec<String>, String> {
    let folder = Path::new(WORKSPACE).join("presets");
    let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
    let paths = fs::read_dir(&folder).map_err(failed)?.map(|entry| entry.map(|e| e.path()));
    let mut paths: Vec<PathBuf> = paths.collect::<Result<_, _>>().map_err(failed)?;
    paths.sort();
    let prefix = format!("{}-", machine.name);
    let own = paths.iter().filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(&prefix)));
    own.map(|path| fs::read_to_string(path).map_err(failed)).collect()
}

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

/// Splits a line at spaces.
pub(super) fn words(line: &str) -> Vec<String> {
    line.split_whitespace().map(str::to_owned).collect()
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
    convert(random.one(&sources.traces).as_bytes(), &mut bytes, form).unwrap_or_default();
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
