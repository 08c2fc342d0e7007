//! Regenerates the tables of docs/ in place.
//!
//! ```text
//! cargo run --release -p basrelief-sim --example tables -- [--models FOLDER] [FILE.md ...]
//! cargo run --release -p basrelief-sim --example tables -- --print 'entries golf-ball'
//! ```
//!
//! A table is between `<!-- measured: NAME INPUT ... -->` and `<!-- end -->`. The first line selects the table, and the text up to the end
//! is replaced. Without files, all files are processed. An input is a demo scene or a model in the folder. If a model is missing, the table
//! is kept and a message is printed to stderr. `described:` instead of `measured:` marks a table that follows from the machine without a
//! run; a test checks it.

mod bump;
mod defer;
mod document;
mod listings;
mod machine;
mod memory;
mod shade;
mod support;
mod texel;

use std::error::Error;
use std::path::PathBuf;
use support::{Inputs, Missing};

/// Function that makes a table from its inputs.
type Make = fn(&Inputs, &[&str]) -> Result<String, Box<dyn Error>>;

/// All tables, by name.
const TABLES: &[(&str, Make)] = &[
    ("entries", bump::entries),
    ("quality", bump::quality),
    ("paths", shade::paths),
    ("short-cuts", shade::short_cuts),
    ("full-over-hybrid", shade::full_over_hybrid),
    ("cpu", shade::cpu),
    ("methods", texel::methods),
    ("dividers", texel::dividers),
    ("igehy", memory::igehy),
    ("hakura", memory::hakura),
    ("tiles", defer::tiles),
    ("dmax", defer::dmax),
    ("machine", machine::machine),
];

/// Files with tables.
const FILES: [&str; 7] = [
    "docs/tutorial.md",
    "docs/reference/machines.md",
    "docs/experiments/quality.md",
    "docs/experiments/shading.md",
    "docs/experiments/texel.md",
    "docs/experiments/defer.md",
    "docs/experiments/texture-caches.md",
];

/// Makes the table of a command `NAME INPUT ...`.
fn make(inputs: &Inputs, command: &str) -> Result<String, Box<dyn Error>> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let (name, of) = words.split_first().ok_or("expected the name of a table")?;
    let names = || TABLES.iter().map(|t| t.0).collect::<Vec<_>>().join(", ");
    let table = TABLES.iter().find(|t| t.0 == *name);
    table.ok_or_else(|| format!("there is no table `{name}`; expected {}", names()))?.1(inputs, of)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut inputs, mut files) = (Inputs::default(), Vec::new());
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or_else(|| format!("{arg} needs a value"));
        match arg.as_str() {
            "--models" => inputs.models = Some(value()?.into()),
            "--print" => {
                print!("{}", make(&inputs, &value()?)?);
                return Ok(());
            }
            _ => files.push(PathBuf::from(arg)),
        }
    }
    if files.is_empty() {
        files = FILES.into_iter().chain(listings::LISTINGS.map(|(file, _)| file)).map(PathBuf::from).collect();
    }
    for file in files {
        if let Some((_, make)) = listings::LISTINGS.iter().find(|(listing, _)| file.ends_with(listing)) {
            std::fs::write(&file, make()?)?;
            continue;
        }
        document::update(&file, |command| match make(&inputs, command) {
            Ok(table) => Ok(Some(table)),
            Err(e) if e.is::<Missing>() => {
                eprintln!("{}: {command}: left as it is: {e}", file.display());
                Ok(None)
            }
            Err(e) => Err(e),
        })?;
    }
    Ok(())
}
