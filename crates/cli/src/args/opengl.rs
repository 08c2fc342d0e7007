//! Arguments of the commands for frames of OpenGL applications.

use super::values::{percent, whole};
use basrelief_opengl::{MapEntry, MapKey};
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;

/// Arguments of `import-gl`.
#[derive(Clone, Debug, Args)]
pub struct ImportGlArgs {
    /// State dumps of the draw calls of one frame, in order of drawing: output of `apitrace replay -D CALL TRACE`.
    #[arg(required = true, value_name = "DUMP")]
    pub dumps: Vec<PathBuf>,
    #[command(flatten)]
    pub scene: GlSceneArgs,
}

/// Arguments of `capture`.
#[derive(Clone, Debug, Args)]
pub struct CaptureArgs {
    /// The application and its arguments.
    #[arg(required = true, last = true, value_name = "PROGRAM")]
    pub program: Vec<OsString>,
    /// Number of the frame, from 0, among the frames that draw [default: the last one that the application has shown]. apitrace replays
    /// frame 0 in a window of another size.
    #[arg(long, value_name = "N", value_parser = whole::<usize>(0..=u64::MAX))]
    pub frame: Option<usize>,
    /// Import these draw calls only (comma-separated list of call numbers) [default: all of the frame].
    #[arg(long, value_name = "CALL", value_delimiter = ',', value_parser = whole::<u64>(0..=u64::MAX))]
    pub calls: Vec<u64>,
    /// Interface between application and window system, as `apitrace trace --api` takes it: gl (GLX) or egl.
    #[arg(long, value_name = "NAME", default_value = "gl")]
    pub api: String,
    #[command(flatten)]
    pub scene: GlSceneArgs,
}

/// Mapping and outputs of a frame.
#[derive(Clone, Debug, Args)]
pub struct GlSceneArgs {
    /// The scene to write, NAME.gltf. Beside it: NAME.camera.json, and if the dumps have an image NAME.application.png,
    /// NAME.exact.png and NAME.difference.png.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    #[arg(long = "map", value_name = "KEY=VALUE", value_delimiter = ',', help = map_help())]
    pub entries: Vec<MapEntry>,
    /// End with exit code 1 if coverage and depth agree on less than this percentage of pixels.
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub agree: Option<f64>,
}

/// Returns the help text of `--map`.
fn map_help() -> String {
    let mut values: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, key) in MapKey::NAMES {
        match values.iter_mut().find(|(value, _)| *value == key.accepted()) {
            Some((_, names)) => names.push(name),
            None => values.push((key.accepted(), vec![name])),
        }
    }
    let values: Vec<String> = values.iter().map(|(value, names)| format!("{}: {value}", names.join(", "))).collect();
    format!(
        "Name or value of the application for a property, in place of a guess; repeatable, or a comma-separated list. CALL.KEY=VALUE \
         concerns one draw call. Values by key, with names as in the dump: {}",
        values.join("; ")
    )
}
