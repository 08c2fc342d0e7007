//! Arguments of the commands for frames of OpenGL applications.

use basrelief_opengl::{MapEntry, MapKey};
use clap::Args;
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

/// Mapping and outputs of a frame.
#[derive(Clone, Debug, Args)]
pub struct GlSceneArgs {
    /// The scene to write, NAME.gltf. Beside it: NAME.camera.json, and if the dumps have a picture NAME.application.png,
    /// NAME.exact.png and NAME.difference.png.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    #[arg(long = "map", value_name = "KEY=VALUE", value_delimiter = ',', help = map_help())]
    pub entries: Vec<MapEntry>,
    /// End with exit code 1 if coverage and depth agree on fewer pixels of the application's picture [percent].
    #[arg(long, value_name = "PERCENT")]
    pub agree: Option<f64>,
}

/// Returns the help text of `--map`.
fn map_help() -> String {
    let keys = MapKey::NAMES.map(|(name, _)| name).join(", ");
    format!(
        "Name or value of the application for a property, in place of a guess; repeatable, or a comma-separated list. CALL.KEY=VALUE \
         concerns one draw call. VALUE is a name in the dump, `none`, a number, or three numbers such as 1:2:3. `normal-space` is \
         `tangent` or `object`. Keys: {keys}"
    )
}
