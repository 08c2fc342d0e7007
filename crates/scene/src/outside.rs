//! What a model may hold, and where its other files come from.

use crate::SceneError;
use crate::files::{Files, relative_name, shorten};
use basrelief_input::{Budget, Held, OverBudget};
use basrelief_signals::Mesh;
use std::cell::RefCell;
use std::fmt::Display;

/// What all parts of an importer have: the model's other files, and the budget that all it makes us hold is counted against.
pub(crate) struct Outside<'a> {
    files: &'a dyn Files,
    budget: Budget,
    /// What stays in the scene.
    kept: RefCell<Held>,
}

impl<'a> Outside<'a> {
    pub(crate) fn new(files: &'a dyn Files, budget: &Budget) -> Self {
        Self { files, budget: budget.clone(), kept: RefCell::new(budget.nothing()) }
    }

    /// Takes bytes for something that does not stay.
    pub(crate) fn take(&self, bytes: u64, place: impl Into<String>, what: impl Display) -> Result<Held, SceneError> {
        self.budget.take(bytes, what).map_err(|error| over_budget(place, &error))
    }

    /// What may still be taken \[bytes\].
    pub(crate) fn left(&self) -> u64 {
        self.budget.left()
    }

    /// Nothing yet, to grow.
    pub(crate) fn nothing(&self) -> Held {
        self.budget.nothing()
    }

    /// Takes bytes for something that stays in the scene.
    pub(crate) fn hold(&self, bytes: u64, place: impl Into<String>, what: impl Display) -> Result<(), SceneError> {
        self.kept.borrow_mut().grow(bytes, what).map_err(|error| over_budget(place, &error))
    }

    /// What was taken stays in the scene.
    pub(crate) fn keep(&self, held: Held) {
        self.kept.borrow_mut().join(held);
    }

    /// The scene is complete: what stays in it is given back with this.
    pub(crate) fn into_kept(self) -> Held {
        self.kept.into_inner()
    }

    /// Reads a referenced file, with an error that names it and the place that refers to it.
    pub(crate) fn read(&self, reference: &str, place: &str) -> Result<(Vec<u8>, Held), SceneError> {
        let name = relative_name(reference).map_err(|why| {
            SceneError::at(place, format!("`{}` {why}", shorten(reference)))
                .expected("a path relative to the model")
                .cure("copy the file next to the model and refer to it by its name")
        })?;
        self.files.read(name, &self.budget).map_err(|e| match OverBudget::within(&e) {
            Some(error) => over_budget(place, error).in_file(&shorten(name)),
            None => SceneError::at(place, format!("cannot read `{}`: {e}", shorten(name)))
                .expected("a file at this path, relative to the model")
                .cure("put the file there or correct the reference"),
        })
    }
}

/// The error of something at this place of a file that would hold too much.
pub(crate) fn over_budget(place: impl Into<String>, error: &OverBudget) -> SceneError {
    SceneError { over_budget: true, ..SceneError::at(place, error.to_string()) }
}

/// What the lists of a mesh take \[bytes\].
pub(crate) fn mesh_bytes(mesh: &Mesh) -> u64 {
    let Mesh { positions, normals, tangents, uv, uv_normal, colors, indices } = mesh;
    let threes = size_of_val(&**positions) + size_of_val(&**normals);
    let fours = size_of_val(&**tangents) + size_of_val(&**colors);
    (threes + fours + size_of_val(&**uv) + size_of_val(&**uv_normal) + size_of_val(&**indices)) as u64
}
