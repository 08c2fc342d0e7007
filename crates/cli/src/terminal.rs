//! Printing. All text goes through [`without_control_characters`], because names in models, plans, reports and answers of servers may
//! contain escape sequences for the terminal.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{IsTerminal as _, Write as _};

/// Colour codes of the program's own tables.
const OWN_STYLES: [&str; 4] = ["\x1b[0m", "\x1b[1m", "\x1b[2m", "\x1b[33m"];

/// Returns the text with control characters and bidirectional overrides as `\u001b`, except line ends, tabs and, if `styled`, the colours
/// of the program's own tables. JSON stays valid and means the same.
pub fn without_control_characters(text: &str, styled: bool) -> Cow<'_, str> {
    if text.chars().all(is_harmless) {
        return text.into();
    }
    let mut safe = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let own = OWN_STYLES.iter().filter(|_| styled).find(|style| rest.starts_with(**style));
        let length = own.map_or(c.len_utf8(), |style| style.len());
        if own.is_some() || is_harmless(c) {
            safe.push_str(&rest[..length]);
        } else {
            // (Writing to a string cannot fail.)
            let _ = write!(safe, "\\u{:04x}", u32::from(c));
        }
        rest = &rest[length..];
    }
    safe.into()
}

fn is_harmless(c: char) -> bool {
    let is_override = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    matches!(c, '\n' | '\t') || !(c.is_control() || is_override)
}

/// Clears the line of a progress bar.
pub fn clear_progress() {
    let mut err = std::io::stderr();
    if err.is_terminal() {
        let _ = err.write_all(b"\r\x1b[2K");
    }
}

/// Prints a line to standard error. A closed standard error is no reason to fail.
pub fn print_note(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", without_control_characters(line, false));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_sequences_become_visible() {
        for (text, shown) in [
            ("plain, ä\n\t", "plain, ä\n\t"),
            ("a\x1b]0;title\x07b", "a\\u001b]0;title\\u0007b"),
            ("\u{9b}2J\r\x7f", "\\u009b2J\\u000d\\u007f"),
            ("\u{202e}txt.exe", "\\u202etxt.exe"),
        ] {
            assert_eq!(without_control_characters(text, false), shown);
        }
        assert_eq!(without_control_characters("\x1b[1mbold\x1b[0m\x1b[8m", true), "\x1b[1mbold\x1b[0m\\u001b[8m");
        assert_eq!(without_control_characters("\x1b[1mbold", false), "\\u001b[1mbold");
    }
}
