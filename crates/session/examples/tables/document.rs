//! Tables in their place in a document.

use std::error::Error;
use std::path::Path;

const BEGIN: &str = "<!-- measured: ";
const END: &str = "<!-- end -->";

/// Replaces every table of a file by what `make` gives for its command; `None` leaves it.
///
/// # Errors
/// What `make` says, a table without an end, or a file that cannot be read or written.
pub fn update(path: &Path, mut make: impl FnMut(&str) -> Result<Option<String>, Box<dyn Error>>) -> Result<(), Box<dyn Error>> {
    let said = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let text = std::fs::read_to_string(path).map_err(|e| said(&e))?;
    let (mut out, mut rest) = (String::new(), text.as_str());
    while let Some(at) = rest.find(BEGIN) {
        let command = &rest[at + BEGIN.len()..];
        let (command, after) = command.split_once(" -->\n").ok_or_else(|| said(&"expected ` -->` at the end of the line"))?;
        let (old, after) = after.split_once(END).ok_or_else(|| said(&format!("`{command}` has no `{END}`")))?;
        eprintln!("{}: {command}", path.display());
        let new = make(command).map_err(|e| said(&e))?;
        out.push_str(&rest[..at]);
        out.push_str(&format!(
            "{BEGIN}{command} -->\n{}{END}",
            new.map_or_else(|| old.to_owned(), |new| format!("\n{}\n\n", new.trim()))
        ));
        rest = after;
    }
    out.push_str(rest);
    std::fs::write(path, out).map_err(|e| said(&e).into())
}
