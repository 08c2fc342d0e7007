//! Memory limit of an import, and access to the other files of a model.

use crate::SceneError;
use crate::files::{ModelFiles, NotGiven, OutsideFolder, relative_name, shorten};
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_signals::Mesh;
use std::cell::RefCell;
use std::fmt::Display;

/// The other files of a model, and the memory limit of its import. All parts of an importer share it.
pub(crate) struct ImportContext<'a> {
    files: &'a dyn ModelFiles,
    budget: MemoryPool,
    /// Memory that stays in the scene.
    kept: RefCell<MemoryReservation>,
}

impl<'a> ImportContext<'a> {
    pub(crate) fn new(files: &'a dyn ModelFiles, budget: &MemoryPool) -> Self {
        Self { files, budget: budget.clone(), kept: RefCell::new(budget.empty_reservation()) }
    }

    /// Memory limit of the import.
    pub(crate) fn budget(&self) -> &MemoryPool {
        &self.budget
    }

    /// Takes memory that is given back before the import ends.
    pub(crate) fn take(&self, bytes: u64, place: impl Into<String>, what: impl Display) -> Result<MemoryReservation, SceneError> {
        self.budget.try_reserve(bytes, what).map_err(|error| over_budget(place, &error))
    }

    /// Returns the bytes that are left.
    pub(crate) fn left(&self) -> u64 {
        self.budget.left()
    }

    /// Returns a reservation of 0 bytes, which can grow.
    pub(crate) fn nothing(&self) -> MemoryReservation {
        self.budget.empty_reservation()
    }

    /// Takes memory that stays in the scene.
    pub(crate) fn hold(&self, bytes: u64, place: impl Into<String>, what: impl Display) -> Result<(), SceneError> {
        self.kept.borrow_mut().try_grow(bytes, what).map_err(|error| over_budget(place, &error))
    }

    /// Keeps a reservation with the scene.
    pub(crate) fn keep(&self, held: MemoryReservation) {
        self.kept.borrow_mut().join(held);
    }

    /// Returns the reservation of the complete scene.
    pub(crate) fn into_kept(self) -> MemoryReservation {
        self.kept.into_inner()
    }

    /// Reads a referenced file, with an error that names it and the place that refers to it.
    pub(crate) fn read(&self, reference: &str, place: &str) -> Result<(Vec<u8>, MemoryReservation), SceneError> {
        let name = relative_name(reference).map_err(|why| {
            SceneError::at(place, format!("`{}` {why}", shorten(reference)))
                .expected("a path relative to the model")
                .cure("copy the file next to the model and refer to it by its name")
        })?;
        self.files.read(name, &self.budget).map_err(|e| match OverBudget::in_io_error(&e) {
            Some(error) => over_budget(place, error).in_file(&shorten(name)),
            None if e.get_ref().is_some_and(|inner| inner.is::<OutsideFolder>()) => {
                SceneError::at(place, format!("`{}` {OutsideFolder}", shorten(name)))
                    .expected("a file in this folder or below it")
                    .cure("move the file there, or allow it with --allow-outside")
            }
            None => {
                let cure = if e.get_ref().is_some_and(|inner| inner.is::<NotGiven>()) {
                    "drop or choose the model together with all its files"
                } else {
                    "put the file there or correct the reference"
                };
                SceneError::at(place, format!("cannot read `{}`: {e}", shorten(name)))
                    .expected("a file at this path, relative to the model")
                    .cure(cure)
            }
        })
    }
}

/// Returns the error of a request beyond the memory limit, at this place of a file.
pub fn over_budget(place: impl Into<String>, error: &OverBudget) -> SceneError {
    SceneError { over_budget: true, ..SceneError::at(place, error.to_string()) }
}

/// Memory of the lists of a mesh \[bytes\].
pub(crate) fn mesh_bytes(mesh: &Mesh) -> u64 {
    let Mesh { positions, normals, tangents, uv, uv_normal, colors, indices } = mesh;
    let threes = size_of_val(&**positions) + size_of_val(&**normals);
    let fours = size_of_val(&**tangents) + size_of_val(&**colors);
    (threes + fours + size_of_val(&**uv) + size_of_val(&**uv_normal) + size_of_val(&**indices)) as u64
}
