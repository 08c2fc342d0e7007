//! Keys of a document that glTF 2.0 does not define, such as misspelled ones.

use super::check::{SUPPORTED, unsupported};
use super::pointer::pointer;
use basrelief_input::{JsonPath, JsonStep};

/// Properties of glTF 2.0 that the importer does not read. Every object may have the first three.
const NOT_READ: [&str; 14] = [
    "name",
    "extensions",
    "extras",
    "copyright",
    "generator",
    "target",
    "mimeType",
    "alphaCutoff",
    "metallicFactor",
    "roughnessFactor",
    "strength",
    "skeleton",
    "spot",
    "animations",
];

/// Returns the warning of a key that the importer does not read; `None` for keys of glTF 2.0.
pub(super) fn warning_of(path: &JsonPath) -> Option<String> {
    let is = |step: &JsonStep, name: &str| matches!(step, JsonStep::Key(key) if key == name);
    let (JsonStep::Key(last), around) = path.0.split_last()? else { return None };
    if around.iter().any(|step| is(step, "extras") || is(step, "animations")) || NOT_READ.contains(&last.as_str()) {
        return None;
    }
    let place = pointer(path);
    Some(match around.last() {
        Some(step) if is(step, "extensions") && SUPPORTED.contains(&last.as_str()) => {
            format!("{place}: this extension has no meaning here, so it is ignored")
        }
        Some(step) if is(step, "extensions") => unsupported(last),
        _ => format!("{place}: glTF 2.0 does not define this key, so it is ignored; check its spelling"),
    })
}
