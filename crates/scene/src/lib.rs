//! From models to scenes: glTF 2.0 and OBJ import, cameras, MIP pyramids and the demo scenes.
//!
//! The result is a [`Scene`]: objects, frames, and a warning for everything that was left out. Other files of a model are
//! read through [`ModelFiles`], so that the importer also runs without a file system.

mod camera;
mod demo;
mod error;
mod files;
mod gltf;
mod model;
mod normals;
mod obj;
mod outside;
mod picture;
pub mod pyramid;
mod sent;
mod subject;
mod tangents;
pub mod text;
mod textures;
mod view;

pub use camera::{read_camera, write_camera};
pub use demo::{DEMOS, DemoInfo, demo};
pub use error::SceneError;
pub use files::{FolderFiles, MemoryFiles, ModelFiles, OnRead};
pub use gltf::parse::json_error;
pub use outside::over_budget;
pub use subject::SceneSubject;
pub use view::{OwnView, ViewOptions, ZOOM};

use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_signals::{Image, Scene};
use error::ImportWarnings;
use model::ImportedModel;
use outside::ImportContext;
use std::io;
use std::path::Path;
use view::ViewHints;

/// Imports a model. GLB and glTF are recognised by their content, OBJ by the ending of its name.
///
/// `name` is the name of the file and of the scene. `files` supplies the other files of the model. Returns the scene and its
/// reservation.
///
/// # Errors
/// Neither of the formats, corrupt, a required extension that is not supported, over a limit, or nothing to draw.
pub fn load(
    bytes: &[u8],
    name: &str,
    files: &dyn ModelFiles,
    options: &ViewOptions,
    budget: &MemoryPool,
) -> Result<(Scene, MemoryReservation), SceneError> {
    let (subject, mut held) = SceneSubject::load(bytes, name, files, budget)?;
    let (scene, frames) = subject.seen_within(options, budget)?;
    held.join(frames);
    Ok((scene, held))
}

impl SceneSubject {
    /// Imports a model as [`load`](crate::load) does, to be looked at later.
    ///
    /// # Errors
    /// Errors of [`load`], and input over the memory limit.
    pub fn load(
        bytes: &[u8],
        name: &str,
        files: &dyn ModelFiles,
        budget: &MemoryPool,
    ) -> Result<(Self, MemoryReservation), SceneError> {
        let mut warnings = ImportWarnings::default();
        let outside = ImportContext::new(files, budget);
        let model = import(bytes, name, &outside, &mut warnings).map_err(|e| e.in_file(name))?;
        model.warn_of_far_vertices(&mut warnings);
        let hints = ViewHints { shading: model.shading, ..ViewHints::still(model.bounds, model.camera, model.lamps) };
        let (objects, camera_ratio) = (model.objects, model.camera_ratio);
        let subject = Self { name: name.into(), objects, hints, camera_ratio, warnings: warnings.into_vec() };
        Ok((subject, outside.into_kept()))
    }

    /// Imports a model from the file system as [`load_path_with`](crate::load_path_with) does, to be looked at later.
    ///
    /// # Errors
    /// Errors of [`load_path_with`](crate::load_path_with).
    pub fn load_path_with(path: &Path, options: &ImportOptions) -> Result<(Self, MemoryReservation), SceneError> {
        let ImportOptions { budget, allow_outside, on_read } = options;
        let shown = path.display().to_string();
        let cannot = |e: io::Error| match OverBudget::in_io_error(&e) {
            Some(error) => over_budget("", error),
            None => SceneError::at("", format!("cannot be read: {e}")).expected("a .glb, .gltf or .obj file"),
        };
        let (bytes, _held) = files::read_regular(path, budget).map_err(|e| cannot(e).in_file(&shown))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let files = FolderFiles::new(folder).allow_outside(*allow_outside).on_read(*on_read);
        Self::load(&bytes, &shown, &files, budget)
    }
}

/// Imports a model from the file system. Its other files are read from its folder.
///
/// # Errors
/// Errors of [`load`], or the file cannot be read.
pub fn load_path(path: &Path, options: &ViewOptions) -> Result<Scene, SceneError> {
    load_path_with(path, options, &ImportOptions::default()).map(|(scene, _)| scene)
}

/// As [`load_path`], with options of the import: the scene, and the memory that it takes.
///
/// # Errors
/// Errors of [`load_path`], and input over the memory limit.
pub fn load_path_with(
    path: &Path,
    view: &ViewOptions,
    options: &ImportOptions,
) -> Result<(Scene, MemoryReservation), SceneError> {
    let (subject, mut held) = SceneSubject::load_path_with(path, options)?;
    let (scene, frames) = subject.seen_within(view, &options.budget)?;
    held.join(frames);
    Ok((scene, held))
}

/// Decodes a PNG or JPEG file into RGBA, 8 bits each, with its reservation. `name` is for messages.
///
/// # Errors
/// Another format, a corrupt file, a side over 16384 texels, or a picture over the memory limit.
pub fn decode_picture(bytes: &[u8], name: &str, budget: &MemoryPool) -> Result<(Image, MemoryReservation), SceneError> {
    picture::decode(bytes, name, &ImportContext::new(&MemoryFiles::default(), budget))
}

/// Limits of an import from the file system.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Memory that the model may take.
    pub budget: MemoryPool,
    /// The model may name files outside its folder, with `..`.
    pub allow_outside: bool,
    /// Receives the path of each further file of the model.
    pub on_read: Option<OnRead>,
}

/// Expectation of a file that is no known model.
pub const MODEL_FILES: &str = "a .glb, .gltf or .obj file";

fn import(
    bytes: &[u8],
    name: &str,
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<ImportedModel, SceneError> {
    let ending = name.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
    let first = bytes.iter().find(|b| !b.is_ascii_whitespace());
    if bytes.starts_with(gltf::glb::MAGIC) || ending == "glb" {
        gltf::import_glb(bytes, outside, warnings)
    } else if ending == "gltf" || (ending != "obj" && first == Some(&b'{')) {
        gltf::import_json(bytes, outside, warnings)
    } else if ending == "obj" {
        obj::import(bytes, outside, warnings)
    } else {
        Err(SceneError::at("", "no known model format").expected(MODEL_FILES).cure("convert the model to one of these"))
    }
}

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_format_is_refused() {
        let error = load(b"solid x", "x.stl", &MemoryFiles::default(), &ViewOptions::default(), &MemoryPool::default())
            .unwrap_err()
            .to_string();
        assert!(error.starts_with("x.stl: no known model format; expected a .glb, .gltf or .obj file"), "{error}");
    }
}
