//! `--dump`: auxiliary outputs as JSON Lines.

use crate::error::{CommandError, CommandResult};
use crate::outputs::{PartialFile, not_stdout};
use basrelief_sim::{AuxForm, AuxOutputInfo, MACHINES, MachineConfig, MachineInfo};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An output file.
#[derive(Debug)]
struct DumpFile {
    what: AuxOutputInfo,
    path: PathBuf,
    file: PartialFile,
}

/// The files of `--dump`.
#[derive(Debug, Default)]
pub struct DumpFiles(Vec<DumpFile>);

impl DumpFiles {
    /// Opens the files of pairs of output name and path.
    ///
    /// # Errors
    /// An unknown output, an output of another machine, or a file that cannot be written.
    pub fn open(asked: &[PathBuf], config: &MachineConfig) -> CommandResult<Self> {
        let open = |[what, path]: &[PathBuf; 2]| {
            let what = known_output(what, config.machine()).map_err(CommandError::Usage)?;
            let file = PartialFile::create(path).map_err(CommandError::at_file(path, "be written"))?;
            Ok(DumpFile { what, path: path.clone(), file })
        };
        let pairs = asked.as_chunks::<2>().0;
        pairs.iter().try_for_each(|[_, path]| is_file("--dump", path)).map_err(CommandError::Usage)?;
        pairs.iter().map(open).collect::<CommandResult<_>>().map(Self)
    }

    /// Returns the auxiliary outputs of the files.
    pub fn aux_outputs(&self) -> impl Iterator<Item = AuxOutputInfo> {
        self.0.iter().map(|dump| dump.what)
    }

    /// Writes lines of an auxiliary output to its files.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, what: AuxOutputInfo, lines: impl Fn(&mut dyn Write) -> io::Result<()>) -> Result<(), String> {
        let mut wanted = self.0.iter_mut().filter(|dump| dump.what == what);
        wanted.try_for_each(|d| lines(&mut d.file).map_err(|e| format!("{}: cannot be written: {e}", d.path.display())))
    }

    /// Flushes all files, so that write errors occur before anything is published.
    pub fn flush(&mut self) -> CommandResult {
        self.0.iter_mut().try_for_each(|d| d.file.flush().map_err(CommandError::at_file(&d.path, "be written")))
    }

    /// Publishes the files.
    pub fn publish(self) -> CommandResult {
        self.0.into_iter().try_for_each(|d| d.file.publish().map_err(CommandError::at_file(&d.path, "be written")))
    }
}

/// Checks that the value of an option is a file.
///
/// # Errors
/// Standard output.
pub fn is_file(option: &str, path: &Path) -> Result<(), String> {
    not_stdout(path).map_err(|error| format!("{option}: {error}"))
}

/// Returns the auxiliary output of this name that has lines.
fn known_output(what: &Path, machine: &MachineInfo) -> Result<AuxOutputInfo, String> {
    let of = |m: &MachineInfo| lines_of(m).find(|e| Path::new(e.name) == what);
    if let Some(exhibit) = of(machine) {
        return Ok(exhibit);
    }
    Err(match MACHINES.iter().find(|m| of(m).is_some()) {
        Some(other) => {
            let name = what.display();
            format!("--dump: machine `{}` has no {name}, but machine `{}` has", machine.name, other.name)
        }
        None => {
            let names: Vec<&str> = MACHINES.iter().flat_map(lines_of).map(|e| e.name).collect();
            format!("--dump: unknown output `{}`; expected {}", what.display(), names.join(", "))
        }
    })
}

fn lines_of(machine: &MachineInfo) -> impl Iterator<Item = AuxOutputInfo> + use<> {
    basrelief_sim::aux_outputs(machine).into_iter().filter(|e| e.form == AuxForm::Lines)
}

/// Returns the help text of `--dump`.
pub fn help() -> String {
    let of = |m: &'static MachineInfo| lines_of(m).map(|e| format!("`{}` ({}), {}", e.name, m.name, e.about));
    let all: Vec<String> = MACHINES.iter().flat_map(of).collect();
    format!("Write an auxiliary output of the machine as JSON Lines; repeatable. Outputs: {}", all.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_dump_names_machine_that_has_it() {
        let known =
            |what: &str, machine: &str| known_output(Path::new(what), MachineInfo::named(machine).unwrap()).map(|e| e.name);
        assert_eq!(known("tiles", "defer"), Ok("tiles"));
        assert_eq!(known("tiles", "bump"), Err("--dump: machine `bump` has no tiles, but machine `defer` has".into()));
        assert!(known("tile", "defer").unwrap_err().ends_with("expected spans, reference-buffer, tiles"));
        assert!(known("divisions", "texel").is_err(), "a picture");
    }

    #[test]
    fn standard_output_is_no_dump() {
        assert_eq!(is_file("--dump", Path::new("./-")), Ok(()));
        assert!(is_file("--dump", Path::new("-")).unwrap_err().contains("expected a file"));
    }
}
