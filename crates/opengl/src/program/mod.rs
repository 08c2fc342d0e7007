//! The position that a vertex program computes, read from its source: a product of matrices with a vertex attribute.
//!
//! The program is not executed. Assignments in `main` are followed as long as they are such products; anything else is refused.

mod elsewhere;
mod source;
#[cfg(test)]
mod tests;
mod words;

use crate::calls::POSITION;
use elsewhere::Elsewhere;
use source::ProgramSource;
use std::collections::BTreeMap;
use std::ops::Range;
use words::{has_step, is_name, is_position, variable};

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
    let source = ProgramSource::read(source);
    let tokens = source.tokens();
    let body = body_of_main(&tokens).ok_or("has no function `main`")?;
    source.check(&tokens[body.clone()])?;
    let (before, after) = (&tokens[..body.start], &tokens[body.end..]);
    let elsewhere = Elsewhere::read(&[before, after])?;
    let mut program =
        ProgramReader { names, elsewhere, values: BTreeMap::new(), others: BTreeMap::new(), position: None, returns: false };
    let (mut depth, mut parentheses) = (0, 0_i32);
    let is_end = |token: &&str| {
        parentheses += i32::from(*token == "(") - i32::from(*token == ")");
        parentheses <= 0 && *token == ";" || matches!(*token, "{" | "}")
    };
    for statement in tokens[body].split_inclusive(is_end) {
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
    let source = ProgramSource::read(source);
    let tokens = source.tokens();
    let names = tokens.windows(2).filter(|pair| pair[0] == "sampler2D").map(|pair| pair[1].to_owned());
    names.filter(|name| is_name(name)).collect()
}

/// Returns the tokens between the braces of `main`. A declaration of `main` has none.
fn body_of_main(tokens: &[&str]) -> Option<Range<usize>> {
    let head = |start: &usize| matches!(tokens[*start..], ["main", "(", ")", "{", ..] | ["main", "(", "void", ")", "{", ..]);
    let start = (0..tokens.len()).find(head)?;
    let open = start + tokens[start..].iter().position(|token| *token == "{")?;
    let mut depth = 0_i32;
    let close = tokens[open..].iter().position(|token| {
        depth += i32::from(*token == "{") - i32::from(*token == "}");
        depth == 0
    })?;
    Some(open + 1..open + close)
}

struct ProgramReader<'a> {
    names: &'a ProgramNames<'a>,
    elsewhere: Elsewhere<'a>,
    /// Local variables that hold a product.
    values: BTreeMap<&'a str, MatrixProduct>,
    /// Variables that hold another value, with the text of their assignment.
    others: BTreeMap<&'a str, String>,
    position: Option<MatrixProduct>,
    /// A statement has been a `return`.
    returns: bool,
}

/// Words that make the statement behind them conditional.
const CONDITIONS: [&str; 7] = ["if", "else", "for", "while", "do", "switch", "case"];

impl<'a> ProgramReader<'a> {
    /// Follows a statement. `conditional` statements may not assign products.
    fn statement(&mut self, words: &[&'a str], conditional: bool) -> Result<(), String> {
        let conditional = conditional || words.first().is_some_and(|word| CONDITIONS.contains(word));
        self.returns |= words.contains(&"return");
        let writes_argument = words.iter().any(|word| self.elsewhere.writers.contains(word));
        let assignments = words.iter().filter(|word| **word == "=").count();
        if writes_argument || has_step(words) || (conditional && assignments > 1) {
            return self.forget(words, &words.join(" "));
        }
        for (number, part) in split_outside(words, ",").into_iter().enumerate() {
            match part.iter().position(|word| *word == "=") {
                Some(equals) => self.assignment(&part[..equals], &part[equals + 1..], conditional)?,
                None if is_declared(part, number > 0) => self.forget(&part[part.len() - 1..], &part.join(" "))?,
                None if part.iter().any(|word| is_position(word)) => self.forget(part, &part.join(" "))?,
                None => {}
            }
        }
        Ok(())
    }

    /// Forgets the products of variables that a statement may change.
    fn forget(&mut self, changed: &[&'a str], statement: &str) -> Result<(), String> {
        if changed.iter().any(|word| is_position(word)) {
            return Err(format!("computes `{statement}`"));
        }
        for name in changed.iter().map(|word| variable(word)).filter(|word| is_name(word)) {
            self.values.remove(name);
            self.others.insert(name, statement.to_owned());
        }
        Ok(())
    }

    fn assignment(&mut self, target: &[&'a str], value: &[&'a str], conditional: bool) -> Result<(), String> {
        let text = format!("{} = {}", target.join(" "), value.join(" "));
        // A target such as `name.x` or `name *` changes a value that is known.
        let plain = target.last().copied().filter(|name| is_name(name) && !name.contains('.') && !target.contains(&"."));
        let product = plain.filter(|_| !conditional).and_then(|_| self.product(value));
        if target.iter().any(|word| is_position(word)) {
            let others = value.iter().filter_map(|word| Some(format!(", where `{}`", self.others.get(variable(word))?)));
            let refused = format!("computes `{text}`{}", others.collect::<String>());
            if self.returns {
                return Err(format!("has a `return` before `{text}`"));
            }
            self.position = Some(product.filter(|product| product.position.is_some()).ok_or(refused)?);
            return Ok(());
        }
        if value.contains(&"=") {
            self.forget(value, &text)?;
        }
        self.forget(plain.as_ref().map_or(target, std::slice::from_ref), &text)?;
        let is_local = |name: &str| target.len() > 1 || !self.elsewhere.assigned.contains(name);
        if let Some((name, product)) = plain.zip(product).filter(|(name, _)| is_local(name)) {
            self.others.remove(name);
            self.values.insert(name, product);
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
        } else if self.others.contains_key(name) {
            None
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

/// Returns true for a declaration without a value, such as `mat4 name` or the `name` behind a comma.
fn is_declared(words: &[&str], is_list: bool) -> bool {
    match words {
        [name] => is_list && is_name(name),
        [.., kind, name] => is_name(kind) && is_name(name),
        [] => false,
    }
}
