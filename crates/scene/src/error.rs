//! One error type for every reader of this crate.

use std::fmt::{Display, Formatter, Result as FmtResult};

/// Fault of an input, with its place, the expectation, and the cure.
///
/// Shown as `FILE: PLACE: fault; expected ...; cure`.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error)]
pub struct SceneError {
    /// File as the user named it, or as the model refers to it.
    pub file: String,
    /// JSON pointer, line or byte offset within the file; empty for the whole file.
    pub place: String,
    /// The fault.
    pub what: String,
    /// The expectation.
    pub expected: String,
    /// The cure; may be empty.
    pub cure: Box<str>,
    /// The input may be in order, but holds more than the budget allows.
    pub over_budget: bool,
}

impl Display for SceneError {
    fn fmt(&self, f: &mut Formatter<'_>) -> FmtResult {
        for part in [&self.file, &self.place] {
            if !part.is_empty() {
                write!(f, "{part}: ")?;
            }
        }
        write!(f, "{}", self.what)?;
        if !self.expected.is_empty() {
            write!(f, "; expected {}", self.expected)?;
        }
        if !self.cure.is_empty() {
            write!(f, "; {}", self.cure)?;
        }
        Ok(())
    }
}

impl SceneError {
    /// Creates an error at a place of a file; [`SceneError::in_file`] adds the file's name.
    pub fn at(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self { place: place.into(), what: what.into(), ..Self::default() }
    }

    /// Adds the expectation.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = expected.into();
        self
    }

    /// Adds the cure.
    #[must_use]
    pub fn cure(mut self, cure: impl Into<String>) -> Self {
        self.cure = cure.into().into_boxed_str();
        self
    }

    /// Returns the error as one of a view option: without the file, and without the name of the option in the place.
    #[must_use]
    pub fn in_option(&self) -> Self {
        let inside: Vec<&str> = self.place.trim_start_matches('/').split('/').skip(1).collect();
        Self { file: String::new(), place: inside.join("/"), ..self.clone() }
    }

    /// Adds earlier warnings, which may name the reason.
    #[must_use]
    pub(crate) fn with_notes(mut self, notes: &[String]) -> Self {
        if !notes.is_empty() {
            self.what = format!("{} (noticed before: {})", self.what, notes.join("; "));
        }
        self
    }

    /// Names the place that its own is in.
    #[must_use]
    pub(crate) fn below(mut self, outer: &str) -> Self {
        let own = self.place.trim_start_matches('/');
        self.place = format!("{outer}/{own}");
        self
    }

    /// Names the file, unless an inner reader has named a more precise one.
    #[must_use]
    pub fn in_file(mut self, file: &str) -> Self {
        if self.file.is_empty() {
            self.file = file.into();
        }
        self
    }
}

/// Warnings of an import, each kept once.
#[derive(Debug, Default)]
pub(crate) struct ImportWarnings {
    sentences: Vec<String>,
    dropped: usize,
}

/// Maximum number of different warnings that are kept.
const MOST_WARNINGS: usize = 100;

/// Longest warning \[characters\]. A name in it can be as long as the file.
const LONGEST_WARNING: usize = 1000;

impl ImportWarnings {
    /// Adds a warning, unless it is there.
    pub(crate) fn add(&mut self, sentence: impl Into<String>) {
        let mut sentence = sentence.into();
        if let Some((end, _)) = sentence.char_indices().nth(LONGEST_WARNING) {
            sentence.truncate(end);
            sentence.push_str("...");
        }
        if self.sentences.contains(&sentence) {
            return;
        }
        if self.sentences.len() < MOST_WARNINGS {
            self.sentences.push(sentence);
        } else {
            self.dropped += 1;
        }
    }

    /// Warnings so far.
    pub(crate) fn sentences(&self) -> &[String] {
        &self.sentences
    }

    /// All sentences, in order.
    pub(crate) fn into_vec(mut self) -> Vec<String> {
        if self.dropped > 0 {
            self.sentences.push(format!("{} further warnings are not shown", self.dropped));
        }
        self.sentences
    }
}
