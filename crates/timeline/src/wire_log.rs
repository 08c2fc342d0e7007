//! Log of everything that crosses the wires of a run, for the comparison with register-transfer code (see `docs/guide/rtl.md`).
//!
//! A log is text, a fact per line. The first word states the kind. Numbers are decimal, bits are hexadecimal. Stages, FIFOs and memory
//! clients are numbered from 0.
//!
//! | line | contents |
//! |---|---|
//! | `machine NAME` | the machine |
//! | `stage NUMBER NAME NUMERAL INPUTS OUTPUTS CLIENTS` | a stage; lists have commas between names, `-` is an empty list |
//! | `fifo NUMBER NAME DEPTH` | a FIFO |
//! | `client NUMBER NAME CREDITS` | a memory client |
//! | `W STAGE TAKEN OUTPUT:BITS ... [r|w|l]CLIENT:ADDRESS:BYTES ...` | a step: mask of inputs, tokens, and reads, writes and look-ups |
//! | `T STAGE FROM TO` | its first cycle, and the cycle after its occupancy |
//! | `V FIFO CYCLE` | the next token becomes visible |
//! | `A STAGE STEP CYCLE ...` | last answers of a step, by client of the stage; 0 for none |
//! | `M CLIENT CYCLE REQUESTS` | requests in flight from a cycle on |
//! | `credits STAGE NUMBER ...` | credits that the largest step needs, by client |
//! | `output STAGE OUTPUT LATENCY NAME:FIRST:BITS ...` | latency of a FIFO, and fields of its tokens |
//! | `table STAGE NAME WIDTH BITS ...` | a table of a unit |
//! | `end CYCLES` | total of the run |
//!
//! Steps of a stage come in order, so do their times, and the tokens of a FIFO. Different kinds and stages interleave.

use crate::layout::TimelineLayout;
use basrelief_kernel::{Cycle, MemoryEvent, Probe, Request, StallCause, StepWires, UnitWires};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Writes a log during a run.
#[derive(Debug)]
pub struct WireLog<W> {
    out: W,
    /// First error of the writer; nothing is written after it.
    error: Option<io::Error>,
    /// The line being built.
    line: String,
}

/// Formats names with commas between them.
fn list(names: &[String]) -> String {
    if names.is_empty() { "-".into() } else { names.join(",") }
}

impl<W: Write> WireLog<W> {
    /// Begins a log.
    pub fn new(out: W, layout: &TimelineLayout) -> Self {
        let mut log = Self { out, error: None, line: String::new() };
        log.write(|line| _ = write!(line, "machine {}", layout.machine));
        for (number, (stage, numeral)) in layout.diagram.stages.iter().zip(&layout.numerals).enumerate() {
            let [inputs, outputs, clients] = [&stage.inputs, &stage.outputs, &stage.clients].map(|names| list(names));
            let numeral = if numeral.is_empty() { "-" } else { numeral };
            log.write(|line| _ = write!(line, "stage {number} {} {numeral} {inputs} {outputs} {clients}", stage.name));
        }
        for (number, fifo) in layout.diagram.fifos.iter().enumerate() {
            log.write(|line| _ = write!(line, "fifo {number} {} {}", fifo.name, fifo.depth));
        }
        for (number, client) in layout.diagram.clients.iter().enumerate() {
            log.write(|line| _ = write!(line, "client {number} {} {}", client.name.replace(' ', "_"), client.credits));
        }
        log
    }

    /// Ends the log of a run of `total` cycles.
    ///
    /// # Errors
    /// The first error of the writer.
    pub fn finish(mut self, total: u64) -> io::Result<W> {
        self.write(|line| _ = write!(line, "end {total}"));
        match self.error {
            Some(error) => Err(error),
            None => self.out.flush().map(|()| self.out),
        }
    }

    fn write(&mut self, build: impl FnOnce(&mut String)) {
        self.line.clear();
        build(&mut self.line);
        self.line.push('\n');
        if self.error.is_none() {
            self.error = self.out.write_all(self.line.as_bytes()).err();
        }
    }
}

/// Appends bits, the highest first.
fn push_bits(line: &mut String, bits: &[u64]) {
    let mut words = bits.iter().rev().skip_while(|word| **word == 0);
    _ = write!(line, "{:x}", words.next().unwrap_or(&0));
    words.for_each(|word| _ = write!(line, "{word:016x}"));
}

fn push_request(line: &mut String, kind: char, request: &Request) {
    _ = write!(line, " {kind}{}:{}:{}", request.client, request.address, request.bytes);
}

impl<W: Write> Probe for WireLog<W> {
    fn reads_wires(&self) -> bool {
        true
    }

    fn on_wires(&mut self, stage: usize, step: &StepWires<'_>) {
        self.write(|line| {
            _ = write!(line, "W {stage} {}", step.taken);
            for (output, bits) in step.given {
                _ = write!(line, " {output}:");
                push_bits(line, bits);
            }
            step.requests.iter().for_each(|request| push_request(line, if request.write { 'w' } else { 'r' }, request));
            step.look_ups.iter().for_each(|request| push_request(line, 'l', request));
        });
    }

    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.write(|line| _ = write!(line, "T {stage} {} {}", from.0, to.0));
    }

    fn on_stall(&mut self, _: usize, _: StallCause, _: Cycle, _: Cycle) {}

    fn on_visible(&mut self, fifo: usize, at: Cycle) {
        self.write(|line| _ = write!(line, "V {fifo} {}", at.0));
    }

    fn on_answers(&mut self, stage: usize, step: u64, answers: &[Cycle]) {
        self.write(|line| {
            _ = write!(line, "A {stage} {step}");
            answers.iter().for_each(|answer| _ = write!(line, " {}", answer.0));
        });
    }

    fn on_memory_event(&mut self, event: MemoryEvent) {
        if let MemoryEvent::InFlight { client, at, requests } = event {
            self.write(|line| _ = write!(line, "M {client} {} {requests}", at.0));
        }
    }

    fn on_unit(&mut self, stage: usize, unit: &UnitWires) {
        self.write(|line| {
            _ = write!(line, "credits {stage}");
            unit.credits.iter().for_each(|credits| _ = write!(line, " {credits}"));
        });
        for (number, output) in unit.outputs.iter().enumerate() {
            self.write(|line| {
                _ = write!(line, "output {stage} {number} {}", output.latency);
                output.fields.iter().for_each(|field| _ = write!(line, " {}:{}:{}", field.name, field.first, field.bits));
            });
        }
        for table in &unit.tables {
            self.write(|line| {
                _ = write!(line, "table {stage} {} {}", table.name, table.bits);
                for entry in &table.entries {
                    line.push(' ');
                    push_bits(line, entry);
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn log_names_stages_steps_and_tokens() {
        let layout = samples::board();
        let mut log = WireLog::new(Vec::new(), &layout);
        let request = Request { client: 1, write: true, address: 64, bytes: 8 };
        let given = [(0, vec![0x1f, 0, 0x2]), (1, vec![0])];
        log.on_wires(0, &StepWires { taken: 3, given: &given, requests: &[request], look_ups: &[] });
        log.on_busy(0, Cycle(5), Cycle(7));
        log.on_visible(2, Cycle(9));
        let text = String::from_utf8(log.finish(12).unwrap()).unwrap();
        let first = format!("stage 0 {} ", layout.diagram.stages[0].name);
        assert!(text.lines().any(|line| line.starts_with(&first)), "{text}");
        let end = "W 0 3 0:20000000000000000000000000000001f 1:0 w1:64:8\nT 0 5 7\nV 2 9\nend 12\n";
        assert!(text.ends_with(end), "{text}");
    }

    #[test]
    fn write_error_is_returned_at_the_end() {
        struct Broken;
        impl Write for Broken {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::Error::other("no room"))
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let log = WireLog::new(Broken, &samples::board());
        assert_eq!(log.finish(1).err().map(|error| error.to_string()), Some("no room".into()));
    }
}
