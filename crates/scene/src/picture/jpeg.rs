//! JPEG files: checks of the headers, then the decoder of the `jpeg-decoder` crate.
//!
//! The decoder reads all scan scripts, restart intervals and sampling factors, except those that [`JpegHeader`] refuses. It
//! does not notice data that end early, takes some colour spaces for others, and calls an unsupported kind a fault of the
//! file; so the headers are read first.

mod header;
#[cfg(test)]
mod tests;

use super::size::{TEXEL, check_size, texels_of};
use crate::SceneError;
use crate::outside::ImportContext;
use basrelief_input::MemoryReservation;
use basrelief_signals::Image;
use header::JpegHeader;
use jpeg_decoder::{Decoder, Error};

/// Memory that the decoder takes for a sample \[bytes\]: its coefficient twice, its value, and its share of the result.
const SAMPLE: u64 = 6;

/// Bytes added after the data of each scan: `0xFF 0x00`, repeated.
///
/// They decode to ones, and no Huffman code consists of ones only. A scan whose data end early therefore runs into an invalid
/// code; the decoder alone would read zeros, which are valid.
const GUARD: [u8; 2048] = {
    let mut guard = [0; 2048];
    let mut i = 0;
    while i < guard.len() {
        guard[i] = 0xff;
        i += 2;
    }
    guard
};

/// Smallest and largest limit of the number of scans. A progressive file has about ten.
const MAX_SCANS: [u64; 2] = [64, 1000];

/// Maximum number of samples of all scans, about ten seconds. A scan of few bytes can pass over all samples.
const MAX_SCANNED_SAMPLES: u64 = 1 << 33;

/// Refuses a file with so many scans that the decoder would need minutes.
fn check_scans(header: &JpegHeader) -> Result<(), SceneError> {
    let scans = header.scan_ends.len();
    let [least, largest] = MAX_SCANS;
    let most = (MAX_SCANNED_SAMPLES / header.samples().max(1)).clamp(least, largest);
    if scans as u64 <= most {
        return Ok(());
    }
    let [width, height] = header.size;
    Err(SceneError::at("", format!("this JPEG has {scans} scans"))
        .expected(format!("at most {most} in an image of {width} x {height}"))
        .cure("open it in an image editor and save it as an ordinary JPEG or as PNG"))
}

/// Decodes a JPEG file into RGBA, with the memory that its texels take.
pub(super) fn decode(bytes: &[u8], name: &str, outside: &ImportContext<'_>) -> Result<(Image, MemoryReservation), SceneError> {
    let header = JpegHeader::read(bytes)?;
    let [width, height] = header.size;
    check_size([width, height])?;
    check_scans(&header)?;
    let file = (bytes.len() + header.scan_ends.len() * GUARD.len()) as u64;
    let what = texels_of(name, header.size);
    let mut held = outside.take(file + SAMPLE * header.samples(), "", what)?;
    let guarded = guarded(bytes, &header.scan_ends);
    let mut decoder = Decoder::new(guarded.as_slice());
    decoder.set_color_transform(header.color_transform());
    let samples = decoder.decode().map_err(|e| fault(&e))?;
    let texels = match header.components.len() {
        1 => samples.iter().map(|y| [*y, *y, *y, 255]).collect(),
        _ => samples.as_chunks().0.iter().map(|[r, g, b]| [*r, *g, *b, 255]).collect(),
    };
    held.shrink_to(TEXEL * u64::from(width) * u64::from(height));
    Ok((Image { width, height, texels }, held))
}

/// The file with [`GUARD`] behind the data of each scan.
fn guarded(bytes: &[u8], scan_ends: &[usize]) -> Vec<u8> {
    let mut guarded = Vec::with_capacity(bytes.len() + scan_ends.len() * GUARD.len());
    let mut begin = 0;
    for end in scan_ends {
        guarded.extend_from_slice(bytes.get(begin..*end).unwrap_or_default());
        guarded.extend_from_slice(&GUARD);
        begin = *end;
    }
    guarded.extend_from_slice(bytes.get(begin..).unwrap_or_default());
    guarded
}

fn fault(error: &Error) -> SceneError {
    match error {
        Error::Format(what) if what.contains("huffman") => header::cut_off("the data of a scan end early, or were changed"),
        Error::Io(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => header::cut_off("its data end early"),
        Error::Unsupported(feature) => header::unsupported(format!("is of a kind that the decoder does not know ({feature:?})")),
        // The decoder's own words name its types and steps.
        Error::Format(_) => header::corrupt("its data contradict each other"),
        Error::Io(e) => SceneError::at("", format!("this JPEG cannot be decoded: {e}")),
        Error::Internal(e) => SceneError::at("", format!("this JPEG cannot be decoded: {e}")),
    }
}
