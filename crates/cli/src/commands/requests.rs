//! `--requests`: memory requests, for reading or for other memory simulators.

use super::dump::is_file;
use crate::args::{RequestsFormat, SimulationArgs};
use crate::error::{CommandError, CommandResult};
use crate::outputs::{OutputFolder, PartialFile};
use basrelief_sim::{MachineConfig, MemoryRequests, RequestFormat, RequestLog, RequestLogError, logged_memories};
use basrelief_timeline::NamedOutput;
use clap::ValueEnum;
use std::fs::File;
use std::path::PathBuf;

impl From<RequestsFormat> for RequestFormat {
    fn from(format: RequestsFormat) -> Self {
        match format {
            RequestsFormat::Csv => Self::Csv,
            RequestsFormat::Dramsim3 => Self::Dramsim3,
            RequestsFormat::Ramulator => Self::Ramulator,
            RequestsFormat::Ramulator2 => Self::Ramulator2,
        }
    }
}

/// The file of `--requests`.
pub struct RequestsFile {
    path: PathBuf,
    log: RequestLog<NamedOutput<PartialFile>, File>,
}

impl RequestsFile {
    /// Opens the file.
    ///
    /// # Errors
    /// An unknown memory, several memories in a format for one, or a file that cannot be written.
    pub fn open(simulation: &SimulationArgs, config: &MachineConfig, outputs: &OutputFolder) -> CommandResult<Option<Self>> {
        let Some(path) = &simulation.requests else { return Ok(None) };
        is_file("--requests", path).map_err(CommandError::Usage)?;
        let format = simulation.requests_format;
        let memories = logged_memories(config, format.into(), simulation.requests_memory.as_deref());
        let memories = memories.map_err(|error| selection_error(format, &error))?;
        let log = PartialFile::create(path)
            .and_then(|file| NamedOutput::new(file, path))
            .and_then(|out| RequestLog::new(out, format.into(), memories, || outputs.scratch()))
            .map_err(CommandError::at_file(path, "be written"))?;
        Ok(Some(Self { path: path.clone(), log }))
    }

    /// Writes requests of a memory.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, of: &MemoryRequests<'_>) -> Result<(), String> {
        self.log.write(of).map_err(|error| format!("{}: cannot be written: {error}", self.path.display()))
    }

    /// Joins the parts. Returns the file for publication.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> CommandResult<PartialFile> {
        self.log.finish().and_then(NamedOutput::finish).map_err(CommandError::at_file(&self.path, "be written"))
    }
}

/// Converts an error in the selected memories, with the options that select them.
fn selection_error(format: RequestsFormat, error: &RequestLogError) -> CommandError {
    match error {
        RequestLogError::Config(_) => CommandError::bad_input(error),
        RequestLogError::SeveralMemories { names, .. } => {
            let format = format.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
            CommandError::Usage(format!("--requests-format {format}: {error}; choose one with --requests-memory: {names}"))
        }
        RequestLogError::UnknownMemory { .. } => CommandError::Usage(format!("--requests-memory: {error}")),
    }
}
