//! Text of a program without comments and preprocessor lines.

use super::words::variable;

/// First words of declarations that change no position, so they may be conditional.
const DECLARATIONS: [&str; 6] = ["precision", "attribute", "varying", "uniform", "in", "out"];

/// Source of a program.
pub(super) struct ProgramSource {
    /// Code without comments and preprocessor lines.
    text: String,
    /// Names of macros that are no numbers.
    macros: Vec<String>,
    /// First preprocessor condition of code other than declarations.
    condition: Option<String>,
}

impl ProgramSource {
    pub fn read(source: &str) -> Self {
        let mut result = Self { text: String::new(), macros: Vec::new(), condition: None };
        let source = without_comments(&source.replace("\r\n", "\n").replace("\\\n", " "));
        let mut open = Vec::new();
        for line in source.lines().map(str::trim) {
            let Some(directive) = line.strip_prefix('#').map(str::trim_start) else {
                if let Some(condition) = open.first().filter(|_| !is_declaration(line)) {
                    result.condition.get_or_insert_with(|| format!("#{condition}"));
                }
                result.text += line;
                result.text.push('\n');
                continue;
            };
            if let Some(definition) = directive.strip_prefix("define") {
                result.macros.extend(macro_of(definition.trim_start()));
            } else if directive.starts_with("if") {
                open.push(directive);
            } else if directive.starts_with("endif") {
                open.pop();
            }
        }
        result
    }

    /// Splits the code into names, numbers and single characters.
    pub fn tokens(&self) -> Vec<&str> {
        let mut result = Vec::new();
        let mut rest = self.text.trim_start();
        while let Some(first) = rest.chars().next() {
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
            let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len()).max(first.len_utf8());
            result.push(&rest[..length]);
            rest = rest[length..].trim_start();
        }
        result
    }

    /// Refuses code that the preprocessor chooses or changes.
    ///
    /// # Errors
    /// Conditional code, or a macro in the body of `main`. The error names it.
    pub fn check(&self, body: &[&str]) -> Result<(), String> {
        if let Some(condition) = &self.condition {
            return Err(format!("has code under `{condition}`"));
        }
        let is_used = |name: &&String| body.iter().any(|token| variable(token) == name.as_str());
        self.macros.iter().find(is_used).map_or(Ok(()), |name| Err(format!("uses the macro `{name}` in `main`")))
    }
}

/// Replaces comments by a space.
fn without_comments(source: &str) -> String {
    let (mut result, mut rest) = (String::new(), source);
    while let Some(start) = ["//", "/*"].iter().filter_map(|start| rest.find(start)).min() {
        result += &rest[..start];
        result.push(' ');
        let is_line = rest[start..].starts_with("//");
        let end = if is_line { rest[start..].find('\n') } else { rest[start + 2..].find("*/").map(|at| at + 4) };
        rest = end.map_or("", |end| &rest[start + end..]);
    }
    result + rest
}

/// Returns true for an empty line, or a line with one declaration that changes no position.
fn is_declaration(line: &str) -> bool {
    let is_one = line.find(';') == line.len().checked_sub(1) && !line.contains(['{', '}', '=']);
    line.is_empty() || is_one && line.split_whitespace().next().is_some_and(|word| DECLARATIONS.contains(&word))
}

/// Returns the name of a macro; `None` for a number, which can be no position.
fn macro_of(definition: &str) -> Option<String> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let end = definition.find(|c| !is_word(c)).unwrap_or(definition.len());
    let (name, value) = definition.split_at(end);
    let is_number = value.trim().trim_end_matches(['f', 'F', 'u']).parse::<f64>().is_ok();
    (!is_number).then(|| name.to_owned())
}
