//! Help texts and the messages of common mistakes, compared with reviewed copies.
//!
//! `TRYCMD=overwrite cargo test -p basrelief-cli --test end_to_end usage` writes the program's current output. Review the
//! difference.

use crate::support::{PROGRAM, workspace};

#[test]
fn help_and_messages_are_as_reviewed() {
    trycmd::TestCases::new()
        .register_bin("basrelief", std::path::Path::new(PROGRAM))
        .env("COLUMNS", "100")
        .case(workspace().join("tests/usage/*.trycmd"))
        .case(workspace().join("crates/cli/README.md"));
}
