//! Memory requests of a run, for reading or for other memory simulators.
//!
//! The engines decide memories in different orders, so requests of several memories arrive interleaved; those of one memory arrive in
//! order. Therefore the log holds the memories one after the other. All but the first wait in a scratch file until the end of the run. So
//! both engines write the same bytes, and memory use does not grow.

use crate::observer::MemoryRequests;
use basrelief_kernel::MemoryRequest;
use basrelief_machines::{ConfigProblem, MachineConfig};
use std::io::{self, BufWriter, Read, Seek, Write};

/// File format of memory requests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RequestFormat {
    /// One line per request: cycle,memory,client,operation,address,bytes.
    #[default]
    Csv,
    /// Trace of DRAMsim3, one line per burst: 0xADDRESS READ|WRITE CYCLE.
    Dramsim3,
    /// DRAM trace of Ramulator 1, one line per burst: 0xADDRESS R|W.
    Ramulator,
    /// LoadStoreTrace of Ramulator 2, one line per burst: LD|ST 0xADDRESS.
    Ramulator2,
}

impl RequestFormat {
    /// All formats with their names.
    pub const ALL: [(&'static str, Self); 4] =
        [("csv", Self::Csv), ("dramsim3", Self::Dramsim3), ("ramulator", Self::Ramulator), ("ramulator2", Self::Ramulator2)];
}

/// Error in the selected memories.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RequestLogError {
    /// The parameters do not fit together.
    #[error(transparent)]
    Config(ConfigProblem),
    /// The format holds one memory.
    #[error("the format holds one memory, but machine `{machine}` has several")]
    SeveralMemories {
        /// Name of the machine.
        machine: &'static str,
        /// Names of its memories.
        names: String,
    },
    /// The machine has no such memory.
    #[error("machine `{machine}` has no memory `{name}`; expected {names}")]
    UnknownMemory {
        /// Name of the machine.
        machine: &'static str,
        /// Unknown name.
        name: String,
        /// Names of its memories.
        names: String,
    },
}

/// A memory of a log.
#[derive(Clone, Debug)]
pub struct LoggedMemory {
    name: String,
    burst_bytes: u32,
}

/// Selects the memories to log: the named one, or all.
///
/// # Errors
/// An unknown memory, several memories in a format for one, and parameters that do not fit together.
pub fn logged_memories(
    config: &MachineConfig,
    format: RequestFormat,
    named: Option<&str>,
) -> Result<Vec<LoggedMemory>, RequestLogError> {
    let all = config.memories().map_err(RequestLogError::Config)?;
    let all: Vec<_> = all.into_iter().map(|(name, burst_bytes)| LoggedMemory { name, burst_bytes }).collect();
    let names = || all.iter().map(|memory| memory.name.as_str()).collect::<Vec<_>>().join(", ");
    let machine = config.machine().name;
    let Some(named) = named else {
        return if format == RequestFormat::Csv || all.len() == 1 {
            Ok(all)
        } else {
            Err(RequestLogError::SeveralMemories { machine, names: names() })
        };
    };
    match all.iter().find(|memory| memory.name == named) {
        Some(one) => Ok(vec![one.clone()]),
        None => Err(RequestLogError::UnknownMemory { machine, name: named.into(), names: names() }),
    }
}

/// Log of memory requests, written to `W` with scratch files `S`.
#[derive(Debug)]
pub struct RequestLog<W, S: Write> {
    format: RequestFormat,
    out: W,
    sections: Vec<MemorySection<S>>,
}

/// Part of a memory.
#[derive(Debug)]
struct MemorySection<S: Write> {
    memory: LoggedMemory,
    /// Scratch file; `None` for the first memory, which is written directly.
    waits_in: Option<BufWriter<S>>,
}

impl<W: Write, S: Read + Write + Seek> RequestLog<W, S> {
    /// Starts a log of these memories. `scratch` makes an empty scratch file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn new(
        mut out: W,
        format: RequestFormat,
        memories: Vec<LoggedMemory>,
        scratch: impl Fn() -> io::Result<S>,
    ) -> io::Result<Self> {
        out.write_all(header_line(format).as_bytes())?;
        let section = |(number, memory)| {
            let waits_in = (number > 0).then(|| scratch().map(BufWriter::new)).transpose()?;
            Ok(MemorySection { memory, waits_in })
        };
        let sections = memories.into_iter().enumerate().map(section).collect::<io::Result<_>>()?;
        Ok(Self { format, out, sections })
    }

    /// Writes requests of a memory.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, of: &MemoryRequests<'_>) -> io::Result<()> {
        let Self { format, out, sections } = self;
        let Some(section) = sections.iter_mut().find(|section| section.memory.name == of.memory) else { return Ok(()) };
        let out: &mut dyn Write = match &mut section.waits_in {
            Some(waits_in) => waits_in,
            None => out,
        };
        of.requests.iter().try_for_each(|request| write_request(out, *format, request, of, section.memory.burst_bytes))
    }

    /// Joins the parts and returns the output.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn finish(self) -> io::Result<W> {
        let Self { mut out, sections, .. } = self;
        for waits_in in sections.into_iter().filter_map(|section| section.waits_in) {
            let mut waited = waits_in.into_inner()?;
            waited.rewind()?;
            io::copy(&mut waited, &mut out)?;
        }
        out.flush()?;
        Ok(out)
    }
}

/// Returns the header line.
fn header_line(format: RequestFormat) -> &'static str {
    if format == RequestFormat::Csv { "cycle,memory,client,operation,address,bytes\n" } else { "" }
}

fn write_request(
    out: &mut dyn Write,
    format: RequestFormat,
    request: &MemoryRequest,
    of: &MemoryRequests<'_>,
    burst_bytes: u32,
) -> io::Result<()> {
    let MemoryRequest { arrival, client, write, address, bytes } = *request;
    let cycle = arrival.0;
    let (mut bursts, operation) =
        (request.bursts(burst_bytes), |[read, posted]: [&'static str; 2]| if write { posted } else { read });
    match format {
        RequestFormat::Csv => {
            let client = of.clients.get(client).map_or("", String::as_str);
            writeln!(out, "{cycle},{},{client},{},{address},{bytes}", of.memory, operation(["read", "write"]))
        }
        RequestFormat::Dramsim3 => {
            let operation = operation(["READ", "WRITE"]);
            bursts.try_for_each(|burst| writeln!(out, "{burst:#x} {operation} {cycle}"))
        }
        RequestFormat::Ramulator => {
            let operation = operation(["R", "W"]);
            bursts.try_for_each(|burst| writeln!(out, "{burst:#x} {operation}"))
        }
        RequestFormat::Ramulator2 => {
            let operation = operation(["LD", "ST"]);
            bursts.try_for_each(|burst| writeln!(out, "{operation} {burst:#x}"))
        }
    }
}
