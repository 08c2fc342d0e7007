//! Names of commands, options and parameters before version 0.2. They still work, with a note on standard error.

use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};

const COMMANDS: &[(&str, &str)] = &[("retime", "resimulate")];
/// Options, and parameters of `--set`. Parameters in files have their old names in the configuration.
const OPTIONS: &[(&str, &str)] = &[
    ("--limits", "--bottlenecks"),
    ("--no-limits", "--no-bottlenecks"),
    ("--tape", "--recording"),
    ("video_out.enabled", "display.enabled"),
    ("video_out.burst_bytes", "display.burst_bytes"),
    ("video_out.pixel_hz", "display.pixel_hz"),
];

/// Replaces old names in a command line. Returns the new command line and one note per old name.
pub fn current_names(args: impl IntoIterator<Item = OsString>) -> (Vec<OsString>, BTreeSet<String>) {
    let (mut renamed, mut notes) = (Vec::new(), BTreeSet::new());
    let (mut is_before_command, mut are_options) = (true, true);
    for arg in args {
        are_options &= arg != "--";
        let table = if is_before_command && !is_option(&arg) { COMMANDS } else { OPTIONS };
        let new = arg.to_str().filter(|_| are_options).and_then(|text| replacement_for(text, table));
        is_before_command &= is_option(&arg) || renamed.is_empty() || !is_command(new.as_deref().unwrap_or(&arg));
        if let Some(new) = &new {
            notes.insert(format!("note: `{}` is now `{}`; the old name will be removed", name(&arg), name(new)));
        }
        renamed.push(new.unwrap_or(arg));
    }
    (renamed, notes)
}

fn is_option(arg: &OsStr) -> bool {
    arg.to_string_lossy().starts_with('-')
}

fn is_command(arg: &OsStr) -> bool {
    arg.to_string_lossy().starts_with(|c: char| c.is_ascii_lowercase())
}

/// The part of an argument before `=`.
fn name(arg: &OsStr) -> String {
    let text = arg.to_string_lossy();
    text.split('=').next().unwrap_or_default().to_owned()
}

fn replacement_for(arg: &str, table: &[(&str, &str)]) -> Option<OsString> {
    let (name, value) = arg.find('=').map_or((arg, ""), |at| arg.split_at(at));
    let (_, new) = table.iter().find(|(old, _)| *old == name)?;
    Some(format!("{new}{value}").into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_names_become_new_ones_with_a_note() {
        for (old, new, notes) in [
            ("b retime out --limits --out x", "b resimulate out --bottlenecks --out x", 2),
            ("b --memory-limit 2GiB retime a", "b --memory-limit 2GiB resimulate a", 1),
            ("b run a --tape=t --no-limits", "b run a --recording=t --no-bottlenecks", 2),
            ("b run a --set video_out.pixel_hz=9", "b run a --set display.pixel_hz=9", 1),
            ("b run retime", "b run retime", 0),
            ("b run -- --tape", "b run -- --tape", 0),
        ] {
            let (args, said) = current_names(old.split(' ').map(OsString::from));
            assert_eq!(args, new.split(' ').map(OsString::from).collect::<Vec<_>>(), "{old}");
            assert_eq!(said.len(), notes, "{said:?}");
        }
    }
}
