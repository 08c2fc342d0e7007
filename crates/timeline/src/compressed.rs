//! Compressed charts.

use std::io::{self, Write};

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
