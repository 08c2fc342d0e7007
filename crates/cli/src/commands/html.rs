//! `--html`: the report as one page.

use super::output_files::png;
use crate::error::{Done, Failure};
use crate::outputs::PartialFile;
use basrelief_reference::{Picture, metrics};
use basrelief_report::html::{Beside, PagePicture};
use basrelief_report::{Report, to_html};
use basrelief_session::beside;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file of `--html`, and the pictures of the last frame so far.
pub struct HtmlFile {
    path: PathBuf,
    file: PartialFile,
    last: Option<(Picture, Option<Picture>)>,
}

impl HtmlFile {
    /// Opens it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn open(path: &Path) -> Done<Self> {
        let file = PartialFile::create(path).map_err(Failure::file(path, "be written"))?;
        Ok(Self { path: path.into(), file, last: None })
    }

    /// A frame is finished: the machine's picture of it, and the exact one.
    pub fn frame(&mut self, machine: &Picture, exact: Option<&Picture>) {
        self.last = Some((machine.clone(), exact.cloned()));
    }

    /// The file, to be published.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self, report: &Report) -> Done<PartialFile> {
        let pictures = self.last.as_ref().map(pictures).transpose()?.unwrap_or_default();
        let beside = Beside { pictures, ..beside(report).map_err(Failure::bad)? };
        let page = to_html(report, &beside).map_err(Failure::bad)?;
        let written = self.file.write_all(page.as_bytes()).and_then(|()| self.file.flush());
        written.map_err(Failure::file(&self.path, "be written"))?;
        Ok(self.file)
    }
}

fn pictures((machine, exact): &(Picture, Option<Picture>)) -> Done<Vec<PagePicture>> {
    let made = |caption: &str, picture: &Picture, largest| -> Done<PagePicture> {
        Ok(PagePicture { caption: caption.into(), png: png(picture).map_err(Failure::bad)?, largest })
    };
    let mut list = vec![made("The machine's picture", machine, None)?];
    if let Some(exact) = exact {
        let (difference, largest) = metrics::scaled_difference(exact, machine).map_err(Failure::bad)?;
        list.push(made("The exact picture", exact, None)?);
        list.push(made("The difference", &difference, Some(largest))?);
    }
    Ok(list)
}
