//! Conversion of pictures from and to Python.

use crate::error::{CommandError, CommandResult, PythonResult, budget};
use basrelief_input::{MemoryPool, read_to_end};
use basrelief_reference::{RgbPicture, metrics};
use basrelief_scene::decode_picture;
use basrelief_sim::to_png;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use pyo3::{Bound, FromPyObject, IntoPyObject, Python, pyfunction};
use std::fs::File;
use std::path::PathBuf;

/// A picture for Python: width, height, and RGBA bytes with the top row first.
#[derive(IntoPyObject)]
pub struct Pixels<'py>(u32, u32, Bound<'py, PyBytes>);

impl<'py> Pixels<'py> {
    pub fn of(py: Python<'py>, picture: &RgbPicture) -> Self {
        Self(picture.width, picture.height, PyBytes::new(py, &picture.to_rgba()))
    }
}

/// A picture from Python.
#[derive(FromPyObject)]
pub struct GivenPixels(u32, u32, PyBackedBytes);

impl GivenPixels {
    /// Decodes bytes from [`RgbPicture::to_rgba`].
    pub fn picture(&self) -> CommandResult<RgbPicture> {
        let Self(width, height, rgba) = self;
        let pixels = rgba.as_chunks::<4>().0;
        if u64::from(*width) * u64::from(*height) * 4 != rgba.len() as u64 {
            return Err(CommandError::bad_input(format_args!(
                "an image of {width} x {height} pixels has {} bytes, expected 4 for each",
                rgba.len()
            )));
        }
        let rgb = pixels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
        let covered = pixels.iter().map(|[.., alpha]| *alpha != 0).collect();
        Ok(RgbPicture::drawn([*width, *height], rgb, covered))
    }
}

/// Returns the picture as a PNG file.
#[pyfunction]
pub fn png<'py>(py: Python<'py>, pixels: GivenPixels) -> PythonResult<Bound<'py, PyBytes>> {
    let png = py.detach(|| to_png(&pixels.picture()?).map_err(CommandError::bad_input))?;
    Ok(PyBytes::new(py, &png))
}

/// Reads a PNG file.
#[pyfunction]
pub fn read_png(py: Python<'_>, path: PathBuf) -> PythonResult<Pixels<'_>> {
    let (image, _held) = py.detach(|| {
        let budget = budget(MemoryPool::DEFAULT);
        let file = File::open(&path).map_err(CommandError::at_file(&path, "be read"))?;
        let bytes = read_to_end(&mut &file, 0, &budget, "an image file");
        let (bytes, _file) = bytes.map_err(CommandError::at_file(&path, "be read"))?;
        decode_picture(&bytes, &path.display().to_string(), &budget).map_err(CommandError::bad_input)
    })?;
    Ok(Pixels(image.width, image.height, PyBytes::new(py, image.texels.as_flattened())))
}

/// Returns the difference image of a picture and the reference image.
#[pyfunction]
pub fn difference<'py>(py: Python<'py>, exact: GivenPixels, machine: GivenPixels) -> PythonResult<Pixels<'py>> {
    let difference =
        py.detach(|| metrics::difference(&exact.picture()?, &machine.picture()?).map_err(CommandError::bad_input))?;
    Ok(Pixels::of(py, &difference))
}
