//! Replacement of tables in documents.

use std::error::Error;
use std::path::Path;

/// Prefixes of commands: tables measured by runs, and descriptions of machines.
const BEGIN: [&str; 2] = ["<!-- measured: ", "<!-- described: "];
const END: &str = "<!-- end -->";

/// Replaces every table of a file, as [`replaced`] does.
///
/// # Errors
/// Errors of [`replaced`], or a file that cannot be read or written.
pub fn update(path: &Path, mut make: impl FnMut(&str) -> Result<Option<String>, Box<dyn Error>>) -> Result<(), Box<dyn Error>> {
    let said = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let text = std::fs::read_to_string(path).map_err(|e| said(&e))?;
    let make = |command: &str| {
        eprintln!("{}: {command}", path.display());
        make(command)
    };
    let text = replaced(&text, make).map_err(|e| said(&e))?;
    std::fs::write(path, text).map_err(|e| said(&e).into())
}

/// Returns a document with every table replaced by the result of `make` for its command. `None` keeps the table.
///
/// # Errors
/// Errors of `make`, and a table without an end.
pub fn replaced(
    text: &str,
    mut make: impl FnMut(&str) -> Result<Option<String>, Box<dyn Error>>,
) -> Result<String, Box<dyn Error>> {
    let (mut out, mut rest) = (String::new(), text);
    while let Some((at, begin)) = BEGIN.iter().filter_map(|begin| Some((rest.find(begin)?, *begin))).min() {
        let command = &rest[at + begin.len()..];
        let (command, after) = command.split_once(" -->\n").ok_or("expected ` -->` at the end of the line")?;
        let (old, after) = after.split_once(END).ok_or_else(|| format!("`{command}` has no `{END}`"))?;
        let new = make(command)?.map_or_else(|| old.to_owned(), |new| format!("\n{}\n\n", new.trim()));
        out.push_str(&format!("{}{begin}{command} -->\n{new}{END}", &rest[..at]));
        rest = after;
    }
    out.push_str(rest);
    Ok(out)
}
