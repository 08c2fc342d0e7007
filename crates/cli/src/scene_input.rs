//! Scenes that a command names: models and demos.

use crate::error::CommandError;
use crate::global::GlobalOptions;
use basrelief_scene::{MODEL_FILES, SceneError, SceneSubject, ViewOptions, load_path_with};
use basrelief_signals::Scene;
use std::path::Path;
use std::sync::Arc;

/// Returns the name of the demo that an input names.
pub fn demo_of(path: &Path) -> Option<&str> {
    path.to_str()?.strip_prefix("demo:")
}

/// Opens a model or a demo (`demo:NAME`) with a resolved view.
pub fn open_scene(path: &Path, view: &ViewOptions, global: &GlobalOptions) -> Result<Arc<Scene>, SceneError> {
    let (scene, held) = match demo_of(path) {
        Some(name) => SceneSubject::demo(name)?.seen_within(view, &global.budget)?,
        None => load_path_with(path, view, &global.import_options())?,
    };
    // The memory stays reserved until the end of the program.
    held.keep_forever();
    Ok(Arc::new(scene))
}

/// As [`scene_error`], for commands that also read traces.
pub fn input_error(path: &Path) -> impl Fn(SceneError) -> CommandError {
    let convert = scene_error(path);
    move |mut error| {
        if error.expected == MODEL_FILES {
            error.expected = format!("{MODEL_FILES}, or a trace: .jsonl or .bdl, or either with .zst appended");
        }
        convert(error)
    }
}

/// Converts an error of a model or a demo. The error may be in a file that the model references, but the message names the model too.
pub fn scene_error(path: &Path) -> impl Fn(SceneError) -> CommandError {
    let shown = path.display().to_string();
    let is_demo = demo_of(path).is_some();
    move |error| match is_demo {
        true if !error.over_budget => CommandError::usage(error),
        false if error.file != shown => CommandError::in_input(&shown)(error),
        _ => CommandError::bad_input(error),
    }
}
