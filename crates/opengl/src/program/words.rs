//! Words of a program: names, and what they do.

/// Returns true for a name or a keyword.
pub(super) fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

/// Returns the variable of a token such as `name.x`.
pub(super) fn variable(token: &str) -> &str {
    token.split('.').next().unwrap_or(token)
}

/// Returns true for the position, or a component of it.
pub(super) fn is_position(token: &str) -> bool {
    variable(token) == "gl_Position"
}

/// Returns true if words increment or decrement a variable.
pub(super) fn has_step(words: &[&str]) -> bool {
    words.windows(2).any(|pair| matches!(pair, ["+", "+"] | ["-", "-"]))
}
