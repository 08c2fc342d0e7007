//! Identity of a build: a hash over the sources of the simulator.
//!
//! In a workspace, all crates count on which a report depends, and the versions of all other packages. In a published package the
//! sources of the other crates are elsewhere. Their exact versions are fixed by the manifest, and a published version never changes.

use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Crates on which no report depends.
pub const OTHER_CRATES: [&str; 7] = ["bench", "cli", "dse", "kernel-conformance", "python", "tile-server", "web"];

/// Hexadecimal digits of a hash.
const DIGITS: usize = 16;

/// Sources of the simulator.
pub struct Sources {
    /// Files and folders, to be watched for changes.
    pub watched: Vec<PathBuf>,
    /// Files by their paths below the workspace or the package, with `/` on every system.
    files: BTreeMap<String, PathBuf>,
}

impl Sources {
    /// Finds the sources around the package in `package`.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn around(package: &Path) -> io::Result<Self> {
        let workspace = package.parent().and_then(Path::parent).filter(|root| {
            let is_workspace = root.join("Cargo.lock").is_file() && root.join("crates/kernel/Cargo.toml").is_file();
            is_workspace && root.join("crates/sim").canonicalize().ok() == package.canonicalize().ok()
        });
        let (root, watched) = match workspace {
            Some(root) => (root, of_workspace(root)?),
            None => (package, of_crate(package)),
        };
        let mut files = BTreeMap::new();
        for path in &watched {
            collect(root, path, &mut files)?;
        }
        Ok(Self { watched, files })
    }

    /// Returns a hash over paths and contents.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn hash(&self) -> io::Result<String> {
        let mut all = Sha256::new();
        for (name, path) in &self.files {
            let content = std::fs::read(path)?;
            all.update(format!("{name}\n{}\n", content.len()));
            all.update(&content);
        }
        let digits: String = all.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(digits[..DIGITS].to_owned())
    }
}

/// Returns the sources of a workspace.
fn of_workspace(root: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = vec![root.join("Cargo.toml"), root.join("Cargo.lock")];
    for folder in ["crates", "crates/units"] {
        for entry in std::fs::read_dir(root.join(folder))? {
            let entry = entry?;
            let counts = entry.file_name().to_str().is_some_and(|name| !OTHER_CRATES.contains(&name));
            if counts && entry.path().join("Cargo.toml").is_file() {
                found.extend(of_crate(&entry.path()));
            }
        }
    }
    Ok(found)
}

/// Returns the sources of a crate.
fn of_crate(folder: &Path) -> Vec<PathBuf> {
    vec![folder.join("Cargo.toml"), folder.join("src")]
}

/// Adds a file, or all files in a folder.
fn collect(root: &Path, path: &Path, files: &mut BTreeMap<String, PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in std::fs::read_dir(path)? {
            collect(root, &entry?.path(), files)?;
        }
    } else if let Ok(below) = path.strip_prefix(root) {
        let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy()).collect();
        files.insert(parts.join("/"), path.to_path_buf());
    }
    Ok(())
}
