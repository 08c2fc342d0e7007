//! The position that a vertex program computes, read from its source: a product of matrices with a vertex attribute.
//!
//! The program is not executed. Assignments in `main` are followed as long as they are such products; anything else is refused.

use crate::calls::POSITION;
use std::collections::BTreeMap;

/// A product of matrices, leftmost first, with the position of a vertex if it has one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct MatrixProduct {
    /// Names of uniforms, or of matrices of the fixed function.
    pub matrices: Vec<String>,
    /// Name of the vertex attribute.
    pub position: Option<String>,
}

/// Matrices of the fixed function: projection and model-view matrix.
pub(crate) const FIXED_MATRICES: [&str; 2] = ["gl_ProjectionMatrix", "gl_ModelViewMatrix"];

impl MatrixProduct {
    /// Returns the product of the fixed function.
    pub fn fixed_function() -> Self {
        Self { matrices: FIXED_MATRICES.map(str::to_owned).into(), position: Some(POSITION.into()) }
    }
}

/// Names that a program may use.
pub(crate) struct ProgramNames<'a> {
    /// True for a uniform that is a 4 x 4 matrix.
    pub is_matrix: &'a dyn Fn(&str) -> bool,
    /// True for a vertex attribute.
    pub is_attribute: &'a dyn Fn(&str) -> bool,
}

/// Returns the product that a vertex program assigns to `gl_Position`.
///
/// # Errors
/// The text of an assignment that is no such product, or the reason.
pub(crate) fn position_of(source: &str, names: &ProgramNames<'_>) -> Result<MatrixProduct, String> {
    let tokens = tokens(source);
    let body = body_of_main(&tokens).ok_or("has no function `main`")?;
    let mut program = ProgramReader { names, values: BTreeMap::new(), others: BTreeMap::new(), position: None };
    let mut depth = 0;
    for statement in body.split_inclusive(|token| matches!(*token, ";" | "{" | "}")) {
        let (last, words) = statement.split_last().unwrap_or((&"", &[]));
        program.statement(words, depth > 0)?;
        match *last {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
    }
    program.position.ok_or_else(|| "does not assign `gl_Position` in `main`".into())
}

/// Returns the names of the two-dimensional samplers of a program.
pub(crate) fn samplers(source: &str) -> Vec<String> {
    let tokens = tokens(source);
    let names = tokens.windows(2).filter(|pair| pair[0] == "sampler2D").map(|pair| pair[1].to_owned());
    names.filter(|name| is_name(name)).collect()
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

/// Splits a source into names, numbers and single characters, without comments and preprocessor lines.
fn tokens(source: &str) -> Vec<&str> {
    let mut result = Vec::new();
    let mut rest = source.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") || first == '#' {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |at| at + 2)
        } else {
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
            let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len()).max(first.len_utf8());
            result.push(&rest[..length]);
            length
        };
        rest = rest[length..].trim_start();
    }
    result
}

fn body_of_main<'a, 'b>(tokens: &'b [&'a str]) -> Option<&'b [&'a str]> {
    let start = tokens.windows(2).position(|pair| pair == ["main", "("])?;
    let open = start + tokens[start..].iter().position(|token| *token == "{")?;
    let mut depth = 0_i32;
    let close = tokens[open..].iter().position(|token| {
        depth += i32::from(*token == "{") - i32::from(*token == "}");
        depth == 0
    })?;
    Some(&tokens[open + 1..open + close])
}

struct ProgramReader<'a> {
    names: &'a ProgramNames<'a>,
    /// Local variables that hold a product.
    values: BTreeMap<&'a str, MatrixProduct>,
    /// Texts of the local variables that hold another value.
    others: BTreeMap<&'a str, String>,
    position: Option<MatrixProduct>,
}

impl<'a> ProgramReader<'a> {
    /// Follows an assignment. `conditional` statements may not assign products.
    fn statement<'b: 'a>(&mut self, words: &[&'b str], conditional: bool) -> Result<(), String> {
        let Some(equals) = words.iter().position(|word| *word == "=") else { return Ok(()) };
        let (target, value) = (&words[..equals], &words[equals + 1..]);
        let Some(name) = target.iter().rev().find(|word| is_name(word)).copied() else { return Ok(()) };
        let is_position = target.iter().any(|word| *word == "gl_Position" || word.starts_with("gl_Position."));
        // A target such as `name.x` or `name *` changes a value that is known.
        let is_plain = target.last() == Some(&name) && !name.contains('.');
        let product = Some(value).filter(|_| is_plain && !conditional).and_then(|value| self.product(value));
        if is_position {
            let refused = || {
                let others = value.iter().filter_map(|word| Some(format!(", where `{word} = {}`", self.others.get(word)?)));
                format!("computes `{} = {}`{}", target.join(" "), value.join(" "), others.collect::<String>())
            };
            let product = product.filter(|product| product.position.is_some()).ok_or_else(refused)?;
            self.position = Some(product);
        } else {
            let name = name.split('.').next().unwrap_or(name);
            if let Some(product) = product {
                self.values.insert(name, product);
            } else {
                self.values.remove(name);
                self.others.insert(name, value.join(" "));
            }
        }
        Ok(())
    }

    /// Returns the value of an expression; `None` if it is no product of matrices and at most one position, which is last.
    fn product(&self, words: &[&'a str]) -> Option<MatrixProduct> {
        let mut result = MatrixProduct::default();
        for factor in split_outside(words, "*") {
            let factor = self.factor(factor)?;
            if result.position.is_some() {
                return None;
            }
            result.matrices.extend(factor.matrices);
            result.position = factor.position;
        }
        Some(result)
    }

    fn factor(&self, words: &[&'a str]) -> Option<MatrixProduct> {
        match words {
            ["(", inside @ .., ")"] => self.product(inside),
            ["ftransform", "(", ")"] => Some(MatrixProduct::fixed_function()),
            ["vec4", "(", inside @ .., ")"] => self.vector(inside),
            [name] => self.named(name),
            _ => None,
        }
    }

    /// Returns a position of `vec4(NAME, 1.0)`, `vec4(NAME, 0.0, 1.0)` or `vec4(NAME)`.
    fn vector(&self, inside: &[&'a str]) -> Option<MatrixProduct> {
        let arguments = split_outside(inside, ",");
        let (first, rest) = arguments.split_first()?;
        let rest: Option<Vec<f64>> = rest.iter().map(|words| words.concat().trim_end_matches('f').parse().ok()).collect();
        matches!(*rest?, [] | [1.0] | [0.0, 1.0]).then_some(())?;
        let [name] = *first else { return None };
        let name = name.strip_suffix(".xyz").or(name.strip_suffix(".xy")).unwrap_or(name);
        self.named(name).filter(|product| product.position.is_some() && product.matrices.is_empty())
    }

    fn named(&self, name: &str) -> Option<MatrixProduct> {
        let is_fixed = FIXED_MATRICES.contains(&name);
        if let Some(product) = self.values.get(name) {
            Some(product.clone())
        } else if name == "gl_ModelViewProjectionMatrix" {
            Some(MatrixProduct { position: None, ..MatrixProduct::fixed_function() })
        } else if is_fixed || (self.names.is_matrix)(name) {
            Some(MatrixProduct { matrices: vec![name.into()], position: None })
        } else if (self.names.is_attribute)(name) {
            Some(MatrixProduct { matrices: Vec::new(), position: Some(name.into()) })
        } else {
            None
        }
    }
}

/// Splits an expression at a token that is in no parentheses.
fn split_outside<'a, 'b>(words: &'b [&'a str], at: &str) -> Vec<&'b [&'a str]> {
    let mut depth = 0_i32;
    let parts = words.split(|word| {
        depth += i32::from(*word == "(") - i32::from(*word == ")");
        depth == 0 && *word == at
    });
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(body: &str) -> Result<(String, String), String> {
        let is_matrix = |name: &str| ["P", "V", "M", "MVP"].contains(&name);
        let is_attribute = |name: &str| ["position", "corner", "gl_Vertex"].contains(&name);
        let source = format!(
            "#version 330\n#define other main() {{ }}\nuniform mat4 P; // main() {{\nvoid main ( void )\n{{ {body} }}\nvoid other() {{}}"
        );
        let names = ProgramNames { is_matrix: &is_matrix, is_attribute: &is_attribute };
        position_of(&source, &names).map(|product| (product.matrices.join(" "), product.position.unwrap()))
    }

    #[test]
    fn products_are_followed_through_assignments() {
        let ok = |matrices: &str| Ok((matrices.to_owned(), "position".to_owned()));
        assert_eq!(read("gl_Position = MVP * vec4(position, 1.0);"), ok("MVP"));
        assert_eq!(read("gl_Position = P * V * M * position;"), ok("P V M"));
        assert_eq!(read("mat4 vp = P * V; vec4 w = M * vec4(position.xyz, 1.); gl_Position = vp * w;"), ok("P V M"));
        assert_eq!(read("vec4 p = vec4(position, 0.0, 1.0f); gl_Position = (P * (V * M)) * (p);"), ok("P V M"));
        assert_eq!(read("if (true) { color = vec3(1.0); } /* } */ gl_Position = MVP * vec4(position);"), ok("MVP"));
        let fixed = || ("gl_ProjectionMatrix gl_ModelViewMatrix".to_owned(), "gl_Vertex".to_owned());
        assert_eq!(read("gl_Position = ftransform();"), Ok(fixed()));
        assert_eq!(read("gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;"), Ok(fixed()));
        assert_eq!(read("gl_Position = gl_ProjectionMatrix * gl_ModelViewMatrix * gl_Vertex;"), Ok(fixed()));
    }

    #[test]
    fn other_programs_are_refused_by_their_text() {
        let refused = |body: &str, part: &str| {
            let text = read(body).unwrap_err();
            assert!(text.contains(part), "{text}");
        };
        refused(
            "gl_Position = MVP * vec4(position + wave, 1.0);",
            "computes `gl_Position = MVP * vec4 ( position + wave , 1.0 )`",
        );
        refused("gl_Position = vec4(position, 1.0) * MVP;", "computes");
        refused("gl_Position = position * MVP * position;", "computes");
        refused("gl_Position = MVP * vec4(position, 2.0);", "computes");
        refused("vec4 p = vec4(position, 1.0); p.y = 2.0; gl_Position = MVP * p;", "computes");
        refused("vec4 p = vec4(position, 1.0); if (a) { p = vec4(corner, 1.0); } gl_Position = MVP * p;", "computes");
        refused("gl_Position = MVP * vec4(position, 1.0); gl_Position.z = 0.0;", "computes `gl_Position.z = 0.0`");
        refused("gl_Position = MVP * vec4(position, 1.0); gl_Position += x;", "computes");
        refused("gl_Position = unknown * vec4(position, 1.0);", "computes");
        refused("gl_Position = MVP;", "computes");
        refused(
            "vec4 p = vec4(position.x, wave, 0.0, 1.0); gl_Position = MVP * p;",
            "computes `gl_Position = MVP * p`, where `p = vec4 ( position.x , wave , 0.0 , 1.0 )`",
        );
        refused("x = 1.0;", "does not assign `gl_Position`");
    }

    #[test]
    fn samplers_are_found_by_type() {
        assert_eq!(samplers("uniform sampler2D a;\nuniform lowp sampler2D b; uniform samplerCube c; // sampler2D d"), ["a", "b"]);
    }
}
