//! JSON files that are no glTF files.

use crate::SceneError;
use serde::Deserialize;
use serde::de::IgnoredAny;

/// Members that tell formats apart.
#[derive(Deserialize)]
struct FormatMarks {
    asset: Option<IgnoredAny>,
    schema: Option<String>,
    view_projection: Option<IgnoredAny>,
    shaders: Option<IgnoredAny>,
    parameters: Option<IgnoredAny>,
}

/// Returns the error of a JSON file that is no glTF file. `None` for a glTF file, and for a text that is not valid JSON.
pub(crate) fn other_format(text: &str) -> Option<SceneError> {
    let marks: FormatMarks = basrelief_input::from_str(text).ok()?;
    if marks.asset.is_some() {
        return None;
    }
    let (what, cure) = if marks.schema.is_some_and(|schema| schema.starts_with("basrelief-report/")) {
        ("is the report of a run", "`basrelief compare` reads it, and `--config` its parameters")
    } else if marks.view_projection.is_some() {
        ("is a camera", "name the model, and this file with `--camera`")
    } else if marks.shaders.is_some() && marks.parameters.is_some() {
        ("is a state dump of OpenGL", "`basrelief import-gl` turns it into a model")
    } else {
        ("is no glTF file, because the member `asset` is missing", "name another file, or export the model again")
    };
    Some(SceneError::at("", what).expected("a glTF file").cure(cure))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_of_another_format_is_named() {
        let says = |text: &str| other_format(text).map(|error| error.to_string()).unwrap_or_default();
        let report = says(r#"{"schema": "basrelief-report/3", "cycles": {}}"#);
        assert_eq!(
            report,
            "is the report of a run; expected a glTF file; `basrelief compare` reads it, and `--config` its parameters"
        );
        assert!(says(r#"{"view_projection": []}"#).starts_with("is a camera; expected a glTF file; "));
        assert!(says(r#"{"shaders": {}, "parameters": {}}"#).starts_with("is a state dump of OpenGL; expected a glTF file; "));
        assert!(says("{}").starts_with("is no glTF file, because the member `asset` is missing; expected a glTF file; "));
        assert_eq!([says(r#"{"asset": {}}"#), says("{"), says("[]")], [""; 3]);
    }
}
