//! `--html`: the report as an HTML page.

use crate::error::{CommandError, CommandResult};
use crate::outputs::PartialFile;
use basrelief_reference::RgbPicture;
use basrelief_report::html::PageAssets;
use basrelief_report::{Report, to_html};
use basrelief_sim::{page_assets, page_pictures};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The page and the images of the last frame.
pub struct HtmlFile {
    path: PathBuf,
    file: PartialFile,
    last: Option<(RgbPicture, Option<RgbPicture>)>,
}

impl HtmlFile {
    /// Creates the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn open(path: &Path) -> CommandResult<Self> {
        let file = PartialFile::create(path).map_err(CommandError::at_file(path, "be written"))?;
        Ok(Self { path: path.into(), file, last: None })
    }

    /// Stores image and reference image of a frame.
    pub fn frame(&mut self, machine: &RgbPicture, exact: Option<&RgbPicture>) {
        self.last = Some((machine.clone(), exact.cloned()));
    }

    /// Completes the file for publication.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self, report: &Report) -> CommandResult<PartialFile> {
        let pictures = self.last.as_ref().map(|(machine, exact)| page_pictures(machine, exact.as_ref()));
        let pictures = pictures.transpose().map_err(CommandError::BadInput)?.unwrap_or_default();
        let assets = PageAssets { pictures, ..page_assets(report).map_err(CommandError::bad_input)? };
        let page = to_html(report, &assets).map_err(CommandError::bad_input)?;
        let written = self.file.write_all(page.as_bytes()).and_then(|()| self.file.flush());
        written.map_err(CommandError::at_file(&self.path, "be written"))?;
        Ok(self.file)
    }
}
