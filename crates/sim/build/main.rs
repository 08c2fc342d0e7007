//! Gives the library the identity of its build. Neither a clock nor the path of the sources has an influence.

mod identity;

use identity::Sources;
use std::path::Path;

fn main() -> std::io::Result<()> {
    let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default();
    let sources = Sources::around(Path::new(&package))?;
    for path in &sources.watched {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    println!("cargo::rustc-env=BASRELIEF_BUILD={}+{}", env!("CARGO_PKG_VERSION"), sources.hash()?);
    Ok(())
}
