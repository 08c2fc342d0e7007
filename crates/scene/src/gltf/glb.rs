//! The binary container of glTF (GLB).

use crate::SceneError;
use crate::error::ImportWarnings;

/// First bytes of a GLB file.
pub(crate) const MAGIC: &[u8] = b"glTF";

const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The two chunks that matter.
#[derive(Debug, PartialEq)]
pub(crate) struct GlbChunks<'a> {
    pub json: &'a [u8],
    pub bin: Option<&'a [u8]>,
}

/// Takes a GLB file apart.
pub(crate) fn parse<'a>(bytes: &'a [u8], warnings: &mut ImportWarnings) -> Result<GlbChunks<'a>, SceneError> {
    let end = check_header(bytes, warnings)?;
    let within = bytes.get(..end).unwrap_or(bytes);
    let (mut json, mut bin) = (None, None);
    let mut offset = HEADER_BYTES;
    let mut number = 0;
    while offset < end {
        let (kind, data) = chunk(within, offset)?;
        let fail = |what: &str| Err(broken(offset, what).expected("one JSON chunk first, then at most one BIN chunk"));
        match kind {
            JSON if json.is_some() => return fail("second JSON chunk"),
            JSON if number > 0 => return fail("JSON chunk is not the first"),
            JSON => json = Some(data),
            _ if number == 0 => return fail("first chunk is not JSON"),
            BIN if bin.is_some() => return fail("second BIN chunk"),
            BIN if number != 1 => return fail("BIN chunk is not the second"),
            BIN => bin = Some(data),
            _ => warnings.add(format!("GLB chunk of unknown type {kind:#010x} at byte {offset} ignored")),
        }
        offset += CHUNK_HEADER_BYTES + data.len();
        number += 1;
    }
    let json = json.ok_or_else(|| broken(HEADER_BYTES, "no JSON chunk").expected("one as the first chunk"))?;
    Ok(GlbChunks { json, bin })
}

/// Checks the header; where the file should end.
fn check_header(bytes: &[u8], warnings: &mut ImportWarnings) -> Result<usize, SceneError> {
    if bytes.len() < HEADER_BYTES {
        let what = format!("file of {} bytes ends within the GLB header", bytes.len());
        return Err(broken(bytes.len(), &what).expected("at least 12 bytes: magic, version, length"));
    }
    if !bytes.starts_with(MAGIC) {
        return Err(broken(0, "no GLB file: it does not begin with `glTF`")
            .expected("a GLB file, as its name says")
            .cure("rename it if it is a .gltf or .obj file"));
    }
    let version = word(bytes, 4)?;
    if version != 2 {
        return Err(broken(4, &format!("GLB container version {version}")).expected("2").cure("convert the model to glTF 2.0"));
    }
    let length = word(bytes, 8)? as usize;
    if length < HEADER_BYTES + CHUNK_HEADER_BYTES {
        return Err(
            broken(8, &format!("length in the header is {length}")).expected("at least 20: header and first chunk header")
        );
    }
    if bytes.len() > length {
        warnings.add(format!("{} bytes after the end of the GLB data ignored", bytes.len() - length));
    }
    Ok(length)
}

/// Type and data of the chunk at `offset` of the file.
fn chunk(bytes: &[u8], offset: usize) -> Result<(u32, &[u8]), SceneError> {
    if bytes.len().saturating_sub(offset) < CHUNK_HEADER_BYTES {
        return Err(broken(bytes.len(), "file ends within a chunk header").expected("8 bytes: length and type"));
    }
    let length = word(bytes, offset)? as usize;
    let kind = word(bytes, offset + 4)?;
    if !length.is_multiple_of(4) {
        return Err(broken(offset, &format!("chunk length {length}")).expected("a multiple of 4"));
    }
    let start = offset + CHUNK_HEADER_BYTES;
    let data = start.checked_add(length).and_then(|end| bytes.get(start..end)).ok_or_else(|| {
        broken(offset, &format!("chunk of {length} bytes, but only {} are left", bytes.len() - start)).expected("the whole chunk")
    })?;
    Ok((kind, data))
}

fn word(bytes: &[u8], offset: usize) -> Result<u32, SceneError> {
    bytes
        .get(offset..)
        .and_then(|rest| rest.first_chunk::<4>())
        .map(|b| u32::from_le_bytes(*b))
        .ok_or_else(|| broken(offset, "file ends within a number"))
}

fn broken(offset: usize, what: &str) -> SceneError {
    SceneError::at(format!("byte {offset}"), what).cure("export or download the file again")
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A GLB file of these chunks.
    pub(crate) fn build(json: &str, bin: Option<&[u8]>) -> Vec<u8> {
        let mut chunks = Vec::new();
        let mut push = |kind: u32, data: &[u8], fill: u8| {
            let padded = data.len().next_multiple_of(4);
            chunks.extend((padded as u32).to_le_bytes());
            chunks.extend(kind.to_le_bytes());
            chunks.extend(data);
            chunks.extend(std::iter::repeat_n(fill, padded - data.len()));
        };
        push(JSON, json.as_bytes(), b' ');
        if let Some(bin) = bin {
            push(BIN, bin, 0);
        }
        let mut bytes = MAGIC.to_vec();
        bytes.extend(2u32.to_le_bytes());
        bytes.extend((12 + chunks.len() as u32).to_le_bytes());
        bytes.extend(chunks);
        bytes
    }

    #[test]
    fn chunks_come_back() {
        let bytes = build("{}", Some(&[1, 2, 3, 4]));
        let glb = parse(&bytes, &mut ImportWarnings::default()).unwrap();
        assert_eq!(glb, GlbChunks { json: b"{}  ", bin: Some(&[1, 2, 3, 4]) });
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = build("{\"a\": 1}", Some(&[0; 8]));
        for end in 0..bytes.len() {
            // Cut between the chunks the rest is a whole file but for its length, which must be noticed, too.
            let cut = parse(&bytes[..end], &mut ImportWarnings::default());
            assert!(cut.is_err(), "cut at {end}");
        }
    }
}
