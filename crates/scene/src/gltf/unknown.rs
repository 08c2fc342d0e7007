//! Keys of a document that glTF 2.0 does not define, such as misspelled ones.

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

/// Returns true if glTF 2.0 does not define this key, which the importer does not read.
pub(super) fn is_unknown(path: &JsonPath) -> bool {
    let is = |step: &JsonStep, name: &str| matches!(step, JsonStep::Key(key) if key == name);
    let Some((JsonStep::Key(last), around)) = path.0.split_last() else { return false };
    let is_extension = around.last().is_some_and(|step| is(step, "extensions"));
    let is_free = around.iter().any(|step| is(step, "extras") || is(step, "animations"));
    !(is_extension || is_free || NOT_READ.contains(&last.as_str()))
}
