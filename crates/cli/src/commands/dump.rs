//! `--dump`: what a machine can tell beside its picture, as JSON Lines.

use crate::error::{Done, Failure};
use crate::outputs::PartialFile;
use basrelief_sim::{AuxForm, AuxOutputInfo, MACHINES, MachineConfig, MachineInfo};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file of lines that is being written.
#[derive(Debug)]
struct Dump {
    what: AuxOutputInfo,
    path: PathBuf,
    file: PartialFile,
}

/// The files of `--dump`.
#[derive(Debug, Default)]
pub struct DumpFiles(Vec<Dump>);

impl DumpFiles {
    /// Opens what the command line asks for: pairs of what and file.
    ///
    /// # Errors
    /// What no machine tells, or another one does; a file that cannot be written.
    pub fn open(asked: &[PathBuf], config: &MachineConfig) -> Done<Self> {
        let open = |[what, path]: &[PathBuf; 2]| {
            let what = known(what, config.machine()).map_err(Failure::Usage)?;
            let file = PartialFile::create(path).map_err(Failure::file(path, "be written"))?;
            Ok(Dump { what, path: path.clone(), file })
        };
        let pairs = asked.as_chunks::<2>().0;
        pairs.iter().try_for_each(|[_, path]| is_file("--dump", path)).map_err(Failure::Usage)?;
        pairs.iter().map(open).collect::<Done<_>>().map(Self)
    }

    /// Which exhibits they take.
    pub fn exhibits(&self) -> impl Iterator<Item = AuxOutputInfo> {
        self.0.iter().map(|dump| dump.what)
    }

    /// Writes lines of an exhibit into its files.
    ///
    /// # Errors
    /// A file that cannot be written, in a sentence.
    pub fn write(&mut self, what: AuxOutputInfo, lines: impl Fn(&mut dyn Write) -> io::Result<()>) -> Result<(), String> {
        let mut wanted = self.0.iter_mut().filter(|dump| dump.what == what);
        wanted.try_for_each(|d| lines(&mut d.file).map_err(|e| format!("{}: cannot be written: {e}", d.path.display())))
    }

    /// Writes out what is still held: what cannot be written is known before anything is in its place.
    pub fn flush(&mut self) -> Done {
        self.0.iter_mut().try_for_each(|d| d.file.flush().map_err(Failure::file(&d.path, "be written")))
    }

    /// Puts the files in their place.
    pub fn publish(self) -> Done {
        self.0.into_iter().try_for_each(|d| d.file.publish().map_err(Failure::file(&d.path, "be written")))
    }
}

/// Whether what an option names can be a file.
///
/// # Errors
/// Standard output.
pub fn is_file(option: &str, path: &Path) -> Result<(), String> {
    if path.as_os_str() == "-" {
        return Err(format!("{option}: standard output is the report's; expected a file, `./-` where it is to be called `-`"));
    }
    Ok(())
}

/// The exhibit of this name that comes in lines.
fn known(what: &Path, machine: &MachineInfo) -> Result<AuxOutputInfo, String> {
    let of = |m: &MachineInfo| lines_of(m).find(|e| Path::new(e.name) == what);
    if let Some(exhibit) = of(machine) {
        return Ok(exhibit);
    }
    Err(match MACHINES.iter().find(|m| of(m).is_some()) {
        Some(other) => {
            let name = what.display();
            format!("--dump: machine `{}` has no {name}; --machine {} has", machine.name, other.name)
        }
        None => {
            let names: Vec<&str> = MACHINES.iter().flat_map(lines_of).map(|e| e.name).collect();
            format!("--dump: there is no `{}` to write; expected {}", what.display(), names.join(", "))
        }
    })
}

fn lines_of(machine: &MachineInfo) -> impl Iterator<Item = AuxOutputInfo> + use<> {
    basrelief_sim::aux_outputs(machine).into_iter().filter(|e| e.form == AuxForm::Lines)
}

/// What `--help` says of `--dump`.
pub fn help() -> String {
    let of = |m: &'static MachineInfo| lines_of(m).map(|e| format!("`{}` ({}), {}", e.name, m.name, e.about));
    let all: Vec<String> = MACHINES.iter().flat_map(of).collect();
    format!("Write what the machine can tell beside its picture, as JSON Lines: {}; repeatable", all.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dump_that_the_machine_does_not_have_is_refused_with_the_machine_that_has_it() {
        let known = |what: &str, machine: &str| known(Path::new(what), MachineInfo::named(machine).unwrap()).map(|e| e.name);
        assert_eq!(known("tiles", "defer"), Ok("tiles"));
        assert_eq!(known("tiles", "bump"), Err("--dump: machine `bump` has no tiles; --machine defer has".into()));
        assert!(known("tile", "defer").unwrap_err().ends_with("expected spans, reference-buffer, tiles"));
        assert!(known("divisions", "texel").is_err(), "a picture");
    }

    #[test]
    fn standard_output_is_no_dump() {
        assert_eq!(is_file("--dump", Path::new("./-")), Ok(()));
        assert!(is_file("--dump", Path::new("-")).unwrap_err().contains("expected a file"));
    }
}
