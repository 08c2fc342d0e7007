//! Help texts and the messages of common mistakes, as they are shown.
//!
//! `TRYCMD=overwrite cargo test -p basrelief-cli --test end_to_end usage` writes what the program says now; review the
//! difference.

use crate::support::{PROGRAM, workspace};

#[test]
fn help_and_messages_are_as_reviewed() {
    trycmd::TestCases::new()
        .register_bin("basrelief", std::path::Path::new(PROGRAM))
        .env("COLUMNS", "100")
        .case(workspace().join("tests/usage/*.trycmd"));
}
