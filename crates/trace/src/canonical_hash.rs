//! Hash of an input.

use crate::command::{BeginCommand, TraceCommand};
use crate::data::Digest;
use crate::error::TraceError;
use crate::recorder::{CommandBuilder, TexelUse};
use crate::writer::write_line;
use basrelief_signals::Control;
use sha2::{Digest as _, Sha256};
use std::io::{self, BufWriter, Write};

/// Hash of an input: SHA-256 over the canonical JSON lines of its commands, without `expect`, `end` and texels. Texels contribute the
/// digest in their texture's definition. A scene and its recorded trace have the same hash. For a recorded trace in JSON Lines it is the
/// output of `grep -vE '^\{"(expect|end)"' | sed -E '/^\{"texture"/s/,"(data|file)":"[^"]*"//' | sha256sum`.
///
/// Rejected: texels as the JSON text of a trace. With two textures of 2048 x 2048 texels, this took half of all instructions of a run.
pub struct CanonicalHash {
    hash: BufWriter<HashingWriter>,
    describer: CommandBuilder,
}

impl CanonicalHash {
    /// Starts the hash of an input with this `begin`.
    pub fn new(begin: &BeginCommand) -> Self {
        let mut hash = BufWriter::new(HashingWriter(Sha256::new()));
        feed(&mut hash, &TraceCommand::Begin(begin.clone()));
        Self { hash, describer: CommandBuilder::new(begin, TexelUse::DigestOnly) }
    }

    /// Takes the next token.
    ///
    /// # Errors
    /// Errors of [`TraceRecorder::record`](crate::TraceRecorder::record), without the checks of the writer.
    pub fn update(&mut self, control: &Control) -> Result<(), TraceError> {
        let Self { hash, describer } = self;
        describer.describe(control, &mut |command| {
            feed(hash, command);
            Ok(())
        })
    }

    /// The hash of all tokens taken.
    pub fn finish(mut self) -> Digest {
        let _ = self.hash.flush();
        Digest(self.hash.get_ref().0.clone().finalize().into())
    }
}

/// Writer that hashes its input.
struct HashingWriter(Sha256);

impl Write for HashingWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Hashes a command while it is written.
fn feed(hash: &mut BufWriter<HashingWriter>, command: &TraceCommand) {
    // Hashing cannot fail, nor can a command: it has no keys but names.
    let _ = write_line(command, hash);
}
