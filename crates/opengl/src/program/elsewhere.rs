//! Effects of functions other than `main` on the variables of a vertex program.

use super::words::{has_step, is_name, is_position, variable};
use std::collections::BTreeSet;

/// Effects of the code outside `main`.
pub(super) struct Elsewhere<'a> {
    /// Variables that other functions may assign.
    pub assigned: BTreeSet<&'a str>,
    /// Functions with parameters that they assign.
    pub writers: BTreeSet<&'a str>,
}

impl<'a> Elsewhere<'a> {
    /// Reads the code before and after `main`.
    ///
    /// # Errors
    /// A use of `gl_Position` that is no declaration.
    pub fn read(parts: &[&[&'a str]]) -> Result<Self, String> {
        let (mut assigned, mut writers) = (BTreeSet::new(), BTreeSet::new());
        for part in parts {
            let uses = |at: &usize| is_position(part[*at]) && !is_declaration(part, *at);
            if (0..part.len()).any(|at| uses(&at)) {
                return Err("uses `gl_Position` outside `main`".into());
            }
            let mut function = "";
            for (at, token) in part.iter().enumerate() {
                match (*token, part.get(at + 1)) {
                    (name, Some(&"(")) if is_name(name) => function = name,
                    ("out" | "inout", _) if is_parameter(part, at) => drop(writers.insert(function)),
                    _ => {}
                }
            }
            for statement in part.split(|token| matches!(*token, ";" | "{" | "}")) {
                assigned.extend(written(statement).iter().map(|word| variable(word)).filter(|word| is_name(word)));
            }
        }
        Ok(Self { assigned, writers })
    }
}

/// Returns true for the name in `invariant gl_Position;` or `vec4 gl_Position;`.
fn is_declaration(part: &[&str], at: usize) -> bool {
    let before = at.checked_sub(1).map(|before| part[before]);
    matches!(before, Some("invariant" | "vec4")) && part.get(at + 1) == Some(&";")
}

/// Returns true for `out` behind `(` or `,`, or behind the qualifier of a parameter.
fn is_parameter(part: &[&str], at: usize) -> bool {
    at.checked_sub(1).is_some_and(|before| matches!(part[before], "(" | "," | "precise"))
}

/// Returns the words of a statement that may name variables that it changes.
fn written<'a, 'b>(statement: &'b [&'a str]) -> &'b [&'a str] {
    if has_step(statement) {
        return statement;
    }
    statement.iter().rposition(|word| *word == "=").map_or(&[], |last| &statement[..last])
}
