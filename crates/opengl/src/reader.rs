//! Choices of one draw call: names and numbers are given by a mapping or guessed, and every choice is noted.

use crate::dump::GlDump;
use crate::map_value::{NONE, three};
use crate::mapping::{MapKey, Mapping};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{SceneError, over_budget};
use serde_json::Value;

/// Reader of one draw call.
pub(crate) struct DrawReader<'a> {
    pub dump: &'a GlDump,
    pub call: u64,
    pub mapping: &'a Mapping,
    pub budget: &'a MemoryPool,
    /// Choices, one sentence each.
    pub notes: Vec<String>,
    /// Parts that are left out, one sentence each.
    pub warnings: Vec<String>,
    /// Memory that stays in the frame.
    pub kept: MemoryReservation,
}

impl<'a> DrawReader<'a> {
    pub fn new(dump: &'a GlDump, call: u64, mapping: &'a Mapping, budget: &'a MemoryPool) -> Self {
        let (notes, warnings) = (Vec::new(), Vec::new());
        Self { dump, call, mapping, budget, notes, warnings, kept: budget.empty_reservation() }
    }

    pub fn note(&mut self, text: impl AsRef<str>) {
        self.notes.push(format!("call {}: {}", self.call, text.as_ref()));
    }

    pub fn warn(&mut self, text: impl AsRef<str>) {
        self.warnings.push(format!("call {}: {}", self.call, text.as_ref()));
    }

    pub fn reserve(&self, bytes: u64, place: &str, what: &str) -> Result<MemoryReservation, SceneError> {
        self.budget.try_reserve(bytes, what).map_err(|e| over_budget(place, &e))
    }

    pub fn keep(&mut self, held: MemoryReservation) {
        self.kept.join(held);
    }

    /// Returns the mapped value of a key; `None` if there is none.
    pub fn mapped(&self, key: MapKey) -> Option<&'a str> {
        self.mapping.get(self.call, key)
    }

    /// Chooses one of several names: the mapped one, or the first that `guess` accepts in lower case.
    pub fn choose(&mut self, key: MapKey, names: &[String], guess: impl Fn(&str) -> bool) -> Result<Option<String>, SceneError> {
        match self.mapped(key) {
            Some(NONE) => Ok(None),
            Some(given) if names.iter().any(|name| name == given) => Ok(Some(given.into())),
            Some(given) => Err(unknown(key, given, names)),
            None => {
                let found = names.iter().find(|name| guess(&name.to_ascii_lowercase())).cloned();
                found.iter().for_each(|name| self.note(format!("{key} = {name} (guessed)")));
                Ok(found)
            }
        }
    }

    /// Returns three numbers: mapped, or those of the first uniform that `guess` accepts in lower case.
    pub fn vector(&mut self, key: MapKey, guess: &dyn Fn(&str) -> bool) -> Result<Option<[f64; 3]>, SceneError> {
        if let Some(given) = self.mapped(key) {
            let wrong = || unknown(key, given, &self.uniforms(|value| vector_of(value).is_some()));
            return if given == NONE {
                Ok(None)
            } else {
                three(given).or_else(|| self.dump.uniforms.get(given).and_then(vector_of)).ok_or_else(wrong).map(Some)
            };
        }
        Ok(self.guessed(key, guess, vector_of))
    }

    /// Returns the mapped number of a key that accepts no names.
    pub fn mapped_number(&self, key: MapKey) -> Option<f64> {
        self.mapped(key)?.parse().ok()
    }

    /// Returns a number: mapped, or that of the first uniform that `guess` accepts in lower case.
    pub fn number(&mut self, key: MapKey, guess: &dyn Fn(&str) -> bool) -> Result<Option<f64>, SceneError> {
        if let Some(given) = self.mapped(key) {
            let of_uniform = || self.dump.uniforms.get(given).and_then(Value::as_f64);
            let number = given.parse::<f64>().ok().filter(|number| number.is_finite()).or_else(of_uniform);
            return match number {
                Some(number) => Ok(Some(number)),
                None if given == NONE => Ok(None),
                None => Err(unknown(key, given, &self.uniforms(|value| value.is_number()))),
            };
        }
        Ok(self.guessed(key, guess, Value::as_f64))
    }

    /// Returns the number of the application within the range of a key. Warns if it is another number.
    pub fn clamped(&mut self, key: MapKey, number: f64) -> f64 {
        let clamped = key.clamped(number);
        if clamped != number {
            self.warn(format!("{key} = {number} is drawn as {clamped}"));
        }
        clamped
    }

    fn guessed<T>(&mut self, key: MapKey, guess: &dyn Fn(&str) -> bool, read: fn(&Value) -> Option<T>) -> Option<T> {
        let uniforms = &self.dump.uniforms;
        let mut found = uniforms.iter().filter(|(name, _)| guess(&name.to_ascii_lowercase()));
        let (name, value) = found.find_map(|(name, value)| Some((name, read(value)?)))?;
        self.note(format!("{key} = {name} (guessed)"));
        Some(value)
    }

    pub fn uniforms(&self, fits: impl Fn(&Value) -> bool) -> Vec<String> {
        self.dump.uniforms.iter().filter(|(_, value)| fits(value)).map(|(name, _)| name.clone()).collect()
    }
}

/// Error of a mapped name that the draw call does not have.
pub(crate) fn unknown(key: MapKey, given: &str, names: &[String]) -> SceneError {
    let known = if names.is_empty() { "none".into() } else { names.join(", ") };
    SceneError::at("", format!("--map {key}={given}: the draw call has no such name"))
        .expected(format!("{} (the draw call has {known})", key.accepted()))
}

/// Returns three numbers of a uniform: a list of three or four.
fn vector_of(value: &Value) -> Option<[f64; 3]> {
    let list = value.as_array().filter(|list| matches!(list.len(), 3 | 4))?;
    let numbers: Option<Vec<f64>> = list.iter().take(3).map(Value::as_f64).collect();
    numbers?.try_into().ok()
}
