//! JSON pointers, which name places in a document.

use basrelief_input::{JsonPath, JsonStep};

/// The JSON pointer of a place.
pub(super) fn pointer(path: &JsonPath) -> String {
    let step = |step: &JsonStep| match step {
        JsonStep::Item(item) => format!("/{item}"),
        JsonStep::Key(key) => format!("/{}", escape(key)),
    };
    path.0.iter().map(step).collect()
}

/// A name as part of a JSON pointer.
pub(super) fn escape(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}
