//! Samples that cases damage, and the parts that all cases share.

use super::server::{HostileAnswers, SampleScene};
use basrelief_sim::{MACHINES, MachineInfo};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

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
    pub(super) traces: Vec<String>,
    pub(super) gltf: Vec<Value>,
    pub(super) obj: String,
    pub(super) mtl: String,
    pub(super) pictures: Vec<Vec<u8>>,
    /// Presets of each machine, in the order of [`MACHINES`].
    pub(super) configurations: Vec<Vec<String>>,
    pub(super) tape: Vec<u8>,
    scene: SampleScene,
}

const WORKSPACE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
/// Options of every run of a file: short, and without analyses that other cases cover.
pub(super) const SHORT: &str = "--max-cycles 200000 --out out";

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
            tape: bytes("fuzz/seeds/recording/corridor")?,
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

/// Splits a line at spaces.
pub(super) fn words(line: &str) -> Vec<String> {
    line.split_whitespace().map(str::to_owned).collect()
}
