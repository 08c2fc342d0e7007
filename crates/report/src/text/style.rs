//! Width and colour of a terminal.

/// Style of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextStyle {
    /// Columns of the terminal.
    pub width: usize,
    /// Emphasis by ANSI escape sequences.
    pub color: bool,
}

impl Default for TextStyle {
    fn default() -> Self {
        Self { width: 100, color: false }
    }
}

/// Emphasis, as ANSI "select graphic rendition" codes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Emphasis {
    Bold = 1,
    Dim = 2,
    Yellow = 33,
}

impl TextStyle {
    pub(crate) fn paint(&self, paint: Emphasis, text: &str) -> String {
        if self.color { format!("\x1b[{}m{text}\x1b[0m", paint as u8) } else { text.into() }
    }

    /// Breaks a text between words so that no line is wider than the terminal, unless a word is.
    pub(crate) fn wrap(&self, text: &str) -> String {
        let mut lines: Vec<String> = vec![];
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if line.chars().count() + 1 + word.chars().count() <= self.width => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.into()),
            }
        }
        lines.join("\n")
    }
}
