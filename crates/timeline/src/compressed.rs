//! Compressed output files.

use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Output compressed with zstd. It ends when it is flushed: charts flush once, at their end, and report errors.
pub struct CompressedChart<W: Write>(zstd::Encoder<'static, W>);

impl<W: Write> CompressedChart<W> {
    /// Starts a compressed output.
    ///
    /// # Errors
    /// The compressor cannot be created.
    pub fn new(out: W) -> io::Result<Self> {
        zstd::Encoder::new(out, zstd::DEFAULT_COMPRESSION_LEVEL).map(Self)
    }
}

impl<W: Write> Write for CompressedChart<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.do_finish()?;
        self.0.get_mut().flush()
    }
}

/// Buffered output that is compressed if the name of its file ends in `.zst`. Compressed output ends when it is flushed.
pub enum NamedOutput<W: Write> {
    /// Output as it is.
    Plain(BufWriter<W>),
    /// Compressed output.
    Compressed(BufWriter<CompressedChart<W>>),
}

impl<W: Write> NamedOutput<W> {
    /// Starts the output into a file of this name.
    ///
    /// # Errors
    /// The compressor cannot be created.
    pub fn new(out: W, path: &Path) -> io::Result<Self> {
        if path.extension().is_none_or(|extension| extension != "zst") {
            return Ok(Self::Plain(BufWriter::new(out)));
        }
        CompressedChart::new(out).map(BufWriter::new).map(Self::Compressed)
    }

    /// Ends the output and returns the file.
    ///
    /// # Errors
    /// The rest of the output cannot be written.
    pub fn finish(self) -> io::Result<W> {
        match self {
            Self::Plain(out) => Ok(out.into_inner()?),
            Self::Compressed(out) => out.into_inner()?.0.finish(),
        }
    }
}

impl<W: Write> Write for NamedOutput<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Plain(out) => out.write(bytes),
            Self::Compressed(out) => out.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(out) => out.flush(),
            Self::Compressed(out) => out.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_named_zst_is_compressed() {
        for name in ["a.csv", "a.csv.zst", "zst"] {
            let mut out = NamedOutput::new(Vec::new(), Path::new(name)).expect("an output");
            out.write_all(b"cycle,").expect("written");
            out.write_all(b"memory").expect("written");
            out.flush().expect("flushed");
            let bytes = out.finish().expect("finished");
            let is_plain = bytes == b"cycle,memory";
            assert_eq!(is_plain, name != "a.csv.zst");
            assert!(is_plain || zstd::decode_all(&*bytes).expect("decoded") == b"cycle,memory");
        }
    }
}
