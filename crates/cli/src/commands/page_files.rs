//! Files of the built page: in a folder, or in this program.

use crate::error::{CommandError, CommandResult};
use std::borrow::Cow;
use std::fs;
use std::path::{Path, PathBuf};

/// Files with their names.
type EmbeddedFiles = &'static [(&'static str, &'static [u8])];

/// The page in this program; empty unless the program was built with the feature `page`.
const EMBEDDED: EmbeddedFiles = embedded_files();

#[cfg(not(feature = "page"))]
const fn embedded_files() -> EmbeddedFiles {
    &[]
}

#[cfg(feature = "page")]
const fn embedded_files() -> EmbeddedFiles {
    macro_rules! files {
        ($($name:literal)*) => {
            &[$(($name, include_bytes!(concat!(
                env!("BASRELIEF_PAGE", "feature `page`: run web/build, and set BASRELIEF_PAGE to the absolute path of its folder"),
                "/",
                $name
            )))),*]
        };
    }
    files! {
        "index.html" "index.html.br" "index.html.gz" "viewer.html" "viewer.html.br" "viewer.html.gz" "page.css" "page.css.br"
        "page.css.gz" "page.js" "page.js.br" "page.js.gz" "worker.js" "worker.js.br" "worker.js.gz" "basrelief.wasm"
        "basrelief.wasm.br" "basrelief.wasm.gz" "standalone.html"
    }
}

/// Files of a built page.
pub enum PageFiles {
    /// A folder written by `web/build`.
    Folder(PathBuf),
    /// Files in this program.
    Embedded(EmbeddedFiles),
}

impl PageFiles {
    /// Returns the files of this page: in the given folder, in this program, or in the folder `page` beside this program or one folder
    /// up. Returns `None` if there are none.
    pub fn find(named: Option<&Path>, page: &str) -> CommandResult<Option<Self>> {
        if let Some(folder) = named {
            return Ok(Some(Self::Folder(folder.into())));
        }
        let embedded = Self::Embedded(EMBEDDED);
        if embedded.contains(page) {
            return Ok(Some(embedded));
        }
        let program = std::env::current_exe().map_err(CommandError::bad_input)?;
        let mut folders = program.ancestors().skip(1).take(2).map(|folder| Self::Folder(folder.join("page")));
        Ok(folders.find(|files| files.contains(page)))
    }

    /// Returns true if there is a file of this name.
    pub fn contains(&self, name: &str) -> bool {
        match self {
            Self::Folder(folder) => folder.join(name).is_file(),
            Self::Embedded(files) => files.iter().any(|(of, _)| *of == name),
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(&self, name: &str) -> CommandResult<Cow<'static, [u8]>> {
        match self {
            Self::Folder(folder) => {
                let path = folder.join(name);
                fs::read(&path).map(Cow::Owned).map_err(CommandError::at_file(&path, "be read"))
            }
            Self::Embedded(files) => {
                let found = files.iter().find(|(of, _)| *of == name).map(|(_, bytes)| Cow::Borrowed(*bytes));
                found
                    .ok_or_else(|| CommandError::BadInput(format!("{name}: is not in this program; expected a file of the page")))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embedded_file_is_found_by_its_name() {
        let files = PageFiles::Embedded(&[("index.html", b"<html>"), ("page.js", b"1")]);
        assert!(files.contains("page.js") && !files.contains("page.js.gz"));
        assert_eq!(files.read("page.js").unwrap(), b"1".as_slice());
        assert!(files.read("page.css").unwrap_err().to_string().starts_with("page.css: is not in this program"));
    }

    #[test]
    fn page_is_embedded_with_the_feature_only() {
        let embedded = PageFiles::Embedded(EMBEDDED);
        for name in ["index.html", "viewer.html", "basrelief.wasm.br", "standalone.html"] {
            assert_eq!(embedded.contains(name), cfg!(feature = "page"), "{name}");
        }
    }
}
