//! `--requests`: memory requests, for reading or for other memory simulators.
//!
//! The engines decide memories in different orders, so requests of several memories arrive interleaved; those of one memory arrive in
//! order. Therefore the file holds the memories one after the other. All but the first wait in an unnamed file until the end of the run. So
//! both engines write the same bytes, and memory use does not grow.

use super::dump::is_file;
use crate::args::{RequestsFormat, SimulationArgs};
use crate::error::{CommandError, CommandResult};
use crate::outputs::{OutputFolder, PartialFile};
use basrelief_kernel::MemoryRequest;
use basrelief_sim::{MachineConfig, MemoryRequests};
use clap::ValueEnum;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::PathBuf;

/// The file of `--requests`.
#[derive(Debug)]
pub struct RequestsFile {
    path: PathBuf,
    format: RequestsFormat,
    file: PartialFile,
    /// Memories to write, in order.
    sections: Vec<MemorySection>,
}

/// Part of a memory.
#[derive(Debug)]
struct MemorySection {
    memory: String,
    burst_bytes: u32,
    /// Unnamed file; `None` for the first memory, which is written directly.
    waits_in: Option<BufWriter<File>>,
}

impl RequestsFile {
    /// Opens the file.
    ///
    /// # Errors
    /// An unknown memory, several memories in a format for one, or a file that cannot be written.
    pub fn open(simulation: &SimulationArgs, config: &MachineConfig, outputs: &OutputFolder) -> CommandResult<Option<Self>> {
        let Some(path) = &simulation.requests else { return Ok(None) };
        is_file("--requests", path).map_err(CommandError::Usage)?;
        let (format, asked) = (simulation.requests_format, simulation.requests_memory.as_deref());
        let memories = config.memories().map_err(CommandError::bad_input)?;
        let memories = choose(memories, asked, format, config.machine().name).map_err(CommandError::Usage)?;
        let failed = || CommandError::at_file(path, "be written");
        let mut file = PartialFile::create(path).map_err(failed())?;
        file.write_all(header_line(format).as_bytes()).map_err(failed())?;
        let section = |(number, (memory, burst_bytes)): (usize, (String, u32))| {
            let waits_in = (number > 0).then(|| outputs.scratch().map(BufWriter::new)).transpose()?;
            Ok(MemorySection { memory, burst_bytes, waits_in })
        };
        let sections = memories.into_iter().enumerate().map(section).collect::<io::Result<_>>().map_err(failed())?;
        Ok(Some(Self { path: path.clone(), format, file, sections }))
    }

    /// Writes requests of a memory.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, of: &MemoryRequests<'_>) -> Result<(), String> {
        let Self { path, format, file, sections } = self;
        let Some(section) = sections.iter_mut().find(|s| s.memory == of.memory) else { return Ok(()) };
        let out: &mut dyn Write = match &mut section.waits_in {
            Some(waits_in) => waits_in,
            None => file,
        };
        let written = of.requests.iter().try_for_each(|r| write_request(out, *format, r, of, section.burst_bytes));
        written.map_err(|e| format!("{}: cannot be written: {e}", path.display()))
    }

    /// Joins the parts. Returns the file for publication.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> CommandResult<PartialFile> {
        let Self { path, mut file, sections, .. } = self;
        let append = |waits_in: BufWriter<File>| {
            let mut waited = waits_in.into_inner()?;
            waited.rewind()?;
            io::copy(&mut waited, &mut file)
        };
        let appended = sections.into_iter().filter_map(|s| s.waits_in).map(append).try_for_each(|n| n.map(|_| ()));
        appended.and_then(|()| file.flush()).map_err(CommandError::at_file(&path, "be written"))?;
        Ok(file)
    }
}

/// Selects the memories to write.
fn choose(
    all: Vec<(String, u32)>,
    asked: Option<&str>,
    format: RequestsFormat,
    machine: &str,
) -> Result<Vec<(String, u32)>, String> {
    let names = all.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
    let Some(asked) = asked else {
        if format == RequestsFormat::Csv || all.len() == 1 {
            return Ok(all);
        }
        let format = format.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
        return Err(format!(
            "--requests-format {format}: the format holds one memory, but machine `{machine}` has several; choose one with \
             --requests-memory: {names}"
        ));
    };
    match all.into_iter().find(|(name, _)| name == asked) {
        Some(one) => Ok(vec![one]),
        None => Err(format!("--requests-memory: machine `{machine}` has no memory `{asked}`; expected {names}")),
    }
}

/// Returns the header line.
fn header_line(format: RequestsFormat) -> &'static str {
    if format == RequestsFormat::Csv { "cycle,memory,client,operation,address,bytes\n" } else { "" }
}

fn write_request(
    out: &mut dyn Write,
    format: RequestsFormat,
    request: &MemoryRequest,
    of: &MemoryRequests<'_>,
    burst_bytes: u32,
) -> io::Result<()> {
    let MemoryRequest { arrival, client, write, address, bytes } = *request;
    let cycle = arrival.0;
    let (mut bursts, operation) =
        (request.bursts(burst_bytes), |[read, posted]: [&'static str; 2]| if write { posted } else { read });
    match format {
        RequestsFormat::Csv => {
            let client = of.clients.get(client).map_or("", String::as_str);
            writeln!(out, "{cycle},{},{client},{},{address},{bytes}", of.memory, operation(["read", "write"]))
        }
        RequestsFormat::Dramsim3 => {
            let operation = operation(["READ", "WRITE"]);
            bursts.try_for_each(|burst| writeln!(out, "{burst:#x} {operation} {cycle}"))
        }
        RequestsFormat::Ramulator => {
            let operation = operation(["R", "W"]);
            bursts.try_for_each(|burst| writeln!(out, "{burst:#x} {operation}"))
        }
        RequestsFormat::Ramulator2 => {
            let operation = operation(["LD", "ST"]);
            bursts.try_for_each(|burst| writeln!(out, "{operation} {burst:#x}"))
        }
    }
}
