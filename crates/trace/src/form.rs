//! The four forms of a trace, and the layer that compresses and decompresses.

use basrelief_input::{MemoryPool, MemoryReservation};
use std::io::{self, BufRead, BufReader, BufWriter, Chain, Cursor, Read, Write};

/// First bytes of the binary form. As in PNG, a first byte above 127 and both kinds of line end show up a transfer
/// that took the file for text.
pub(crate) const BINARY_MAGIC: [u8; 8] = *b"\x89BDL\r\n\x1a\n";
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Encoding of the commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TraceEncoding {
    /// JSON Lines: one command per line.
    #[default]
    JsonLines,
    /// The binary twin: magic bytes, version, then each command as a length (32 bits, little endian) and a postcard
    /// record.
    Binary,
}

/// Form of a trace. Readers recognise it by its first bytes and not by the name of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraceForm {
    /// Encoding of the commands.
    pub encoding: TraceEncoding,
    /// The file is compressed with zstd.
    pub compressed: bool,
}

impl TraceForm {
    /// True if this build compresses.
    pub const CAN_COMPRESS: bool = cfg!(feature = "zstd");

    /// All forms.
    pub const ALL: [Self; 4] = [
        Self { encoding: TraceEncoding::JsonLines, compressed: false },
        Self { encoding: TraceEncoding::JsonLines, compressed: true },
        Self { encoding: TraceEncoding::Binary, compressed: false },
        Self { encoding: TraceEncoding::Binary, compressed: true },
    ];

    /// The form to write into a file of this name: `.jsonl` or `.bdl`, each with `.zst` behind it if compressed.
    pub fn for_file_name(name: &str) -> Option<Self> {
        let (name, compressed) = name.strip_suffix(".zst").map_or((name, false), |stem| (stem, true));
        let encoding = match name.rsplit_once('.')?.1 {
            "jsonl" => TraceEncoding::JsonLines,
            "bdl" => TraceEncoding::Binary,
            _ => return None,
        };
        Some(Self { encoding, compressed })
    }
}

/// Returns true if the first bytes of a file are those of a display list of any form. JSON is one if its first command is
/// `begin`. For callers that also accept other kinds of file.
pub fn looks_like_trace(start: &[u8]) -> bool {
    let json = start.trim_ascii_start().strip_prefix(b"{").map(<[u8]>::trim_ascii_start);
    start.starts_with(&BINARY_MAGIC) || looks_compressed(start) || json.is_some_and(|rest| rest.starts_with(b"\"begin\""))
}

/// Returns true if the first bytes of a file are those of zstd.
pub fn looks_compressed(start: &[u8]) -> bool {
    start.starts_with(&ZSTD_MAGIC)
}

/// Longest beginning of a compressed trace that says how large a window it takes \[bytes\].
const ZSTD_HEAD: u64 = 18;

/// Reader whose first bytes were read and put back.
type PeekedReader<R> = Chain<Cursor<Vec<u8>>, R>;

#[cfg(feature = "zstd")]
type ZstdDecoder<R> = zstd::Decoder<'static, BufReader<PeekedReader<R>>>;

fn peek<R: Read>(mut reader: R, bytes: u64) -> io::Result<(Vec<u8>, PeekedReader<R>)> {
    let mut head = Vec::new();
    reader.by_ref().take(bytes).read_to_end(&mut head)?;
    Ok((head.clone(), Cursor::new(head).chain(reader)))
}

/// Uncompressed bytes of a trace.
pub(crate) enum TraceBytes<R: Read> {
    Plain(BufReader<PeekedReader<R>>),
    #[cfg(feature = "zstd")]
    Zstd(Box<BufReader<PeekedReader<ZstdDecoder<R>>>>),
}

impl<R: Read> TraceBytes<R> {
    /// Returns the first uncompressed bytes, the source, and the reservation of the decompressor.
    pub(crate) fn open(reader: R, budget: &MemoryPool) -> io::Result<(Vec<u8>, Self, MemoryReservation)> {
        let (mut head, reader) = peek(reader, ZSTD_HEAD)?;
        if looks_compressed(&head) {
            return Self::decompress(&head, reader, budget);
        }
        head.truncate(BINARY_MAGIC.len());
        Ok((head, Self::Plain(BufReader::new(reader)), budget.empty_reservation()))
    }

    #[cfg(feature = "zstd")]
    fn decompress(head: &[u8], reader: PeekedReader<R>, budget: &MemoryPool) -> io::Result<(Vec<u8>, Self, MemoryReservation)> {
        let mut decoder = zstd::Decoder::new(reader)?;
        let bits = window_bits(head);
        decoder.window_log_max(bits.max(COMMON_WINDOW))?;
        let window = budget.try_reserve(1 << bits, "the window of its compression")?;
        let (head, reader) = peek(decoder, BINARY_MAGIC.len() as u64)?;
        Ok((head, Self::Zstd(Box::new(BufReader::with_capacity(1 << 16, reader))), window))
    }

    #[cfg(not(feature = "zstd"))]
    fn decompress(_: &[u8], _: PeekedReader<R>, _: &MemoryPool) -> io::Result<(Vec<u8>, Self, MemoryReservation)> {
        Err(no_compression())
    }
}

/// Bits of the largest window that compressors use by default \[bytes, binary logarithm\]: 8 MiB.
#[cfg(feature = "zstd")]
const COMMON_WINDOW: u32 = 23;

/// Bits of the window that the first frame of a compressed trace needs (RFC 8878, 3.1.1.1). Later frames may need the same
/// window or the common one. Windows above 2^27 bytes are refused, as other decompressors do.
#[cfg(feature = "zstd")]
fn window_bits(head: &[u8]) -> u32 {
    const LEAST: u32 = 10;
    const MOST: u32 = 27;
    let rest = head.get(ZSTD_MAGIC.len()..).unwrap_or_default();
    let Some((&descriptor, rest)) = rest.split_first() else { return LEAST };
    if descriptor & 0x20 == 0 {
        // Its mantissa, in the low three bits, adds up to seven eighths.
        return rest.first().map_or(LEAST, |window| 10 + u32::from(window >> 3) + u32::from(window & 7 != 0)).clamp(LEAST, MOST);
    }
    // No window of its own: as large as the content.
    let identity = [0, 1, 2, 4][usize::from(descriptor & 3)];
    let size = [1, 2, 4, 8][usize::from(descriptor >> 6)];
    let bytes = rest.get(identity..).unwrap_or_default().iter().take(size).rev();
    let content = bytes.fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte));
    content.saturating_add(1 << 8).checked_next_power_of_two().map_or(MOST, u64::ilog2).clamp(LEAST, MOST)
}

#[cfg(not(feature = "zstd"))]
fn no_compression() -> io::Error {
    let message = "this build has no zstd (feature `zstd` of basrelief-trace): use the uncompressed form";
    io::Error::new(io::ErrorKind::Unsupported, message)
}

impl<R: Read> Read for TraceBytes<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(reader) => reader.read(into),
            #[cfg(feature = "zstd")]
            Self::Zstd(reader) => reader.read(into),
        }
    }
}

impl<R: Read> BufRead for TraceBytes<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        match self {
            Self::Plain(reader) => reader.fill_buf(),
            #[cfg(feature = "zstd")]
            Self::Zstd(reader) => reader.fill_buf(),
        }
    }

    fn consume(&mut self, amount: usize) {
        match self {
            Self::Plain(reader) => reader.consume(amount),
            #[cfg(feature = "zstd")]
            Self::Zstd(reader) => reader.consume(amount),
        }
    }
}

/// Returns an encoder that appends a checksum, for files that are read again: traces and recordings.
///
/// # Errors
/// The compressor cannot be created.
#[cfg(feature = "zstd")]
pub fn checked_encoder<W: Write>(writer: W) -> io::Result<zstd::Encoder<'static, W>> {
    let mut encoder = zstd::Encoder::new(writer, zstd::DEFAULT_COMPRESSION_LEVEL)?;
    encoder.include_checksum(true)?;
    Ok(encoder)
}

/// Takes the uncompressed bytes of a trace.
pub(crate) enum ByteSink<W: Write> {
    Plain(BufWriter<W>),
    #[cfg(feature = "zstd")]
    Zstd(Box<zstd::Encoder<'static, W>>),
}

impl<W: Write> ByteSink<W> {
    pub(crate) fn create(writer: W, compressed: bool) -> io::Result<Self> {
        if compressed { Self::compress(writer) } else { Ok(Self::Plain(BufWriter::with_capacity(1 << 16, writer))) }
    }

    #[cfg(feature = "zstd")]
    fn compress(writer: W) -> io::Result<Self> {
        checked_encoder(writer).map(Box::new).map(Self::Zstd)
    }

    #[cfg(not(feature = "zstd"))]
    fn compress(_: W) -> io::Result<Self> {
        Err(no_compression())
    }

    pub(crate) fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Plain(writer) => writer.write_all(bytes),
            #[cfg(feature = "zstd")]
            Self::Zstd(encoder) => encoder.write_all(bytes),
        }
    }

    pub(crate) fn finish(self) -> io::Result<W> {
        let mut writer = match self {
            Self::Plain(writer) => writer.into_inner().map_err(io::IntoInnerError::into_error)?,
            #[cfg(feature = "zstd")]
            Self::Zstd(encoder) => encoder.finish()?,
        };
        writer.flush()?;
        Ok(writer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_name_selects_written_form() {
        let name = |name| TraceForm::for_file_name(name);
        assert_eq!(name("helmet.dl.jsonl"), Some(TraceForm::ALL[0]));
        assert_eq!(name("a/helmet.jsonl.zst"), Some(TraceForm::ALL[1]));
        assert_eq!(name("helmet.bdl"), Some(TraceForm::ALL[2]));
        assert_eq!(name("helmet.bdl.zst"), Some(TraceForm::ALL[3]));
        assert_eq!(name("helmet.glb"), None);
        assert_eq!(name("zst"), None);
    }
}
