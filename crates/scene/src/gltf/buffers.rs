//! Buffers and buffer views.

use super::check::resolve;
use super::json::{BufferView, GltfBuffer, GltfDocument, GltfInteger};
use crate::SceneError;
use crate::files::shorten;
use crate::outside::ImportContext;
use base64::Engine;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use basrelief_input::MemoryReservation;
use std::borrow::Cow;

/// All buffers of a document. One without data is legal as long as nothing reads it: some exporters leave such
/// placeholders for extensions.
pub(crate) struct GltfBuffers<'a> {
    data: Vec<Option<(Cow<'a, [u8]>, MemoryReservation)>>,
}

impl<'a> GltfBuffers<'a> {
    /// Loads every buffer: from the GLB's BIN chunk (`bin`, where `container` says the file is a GLB), a data URI or a
    /// file.
    pub(crate) fn load(
        document: &GltfDocument,
        container: GltfContainer<'a>,
        outside: &ImportContext<'_>,
    ) -> Result<Self, SceneError> {
        let load = |(i, buffer)| load_buffer(i, buffer, container, outside);
        let data = document.buffers.iter().enumerate().map(load).collect::<Result<_, _>>()?;
        for (i, view) in document.buffer_views.iter().enumerate() {
            check_view(document, i, view)?;
        }
        Ok(Self { data })
    }

    /// The bytes of a buffer view.
    pub(crate) fn view(
        &self,
        document: &GltfDocument,
        index: GltfInteger,
        place: impl FnOnce() -> String,
    ) -> Result<&[u8], SceneError> {
        let view = resolve(&document.buffer_views, "bufferViews", index, place)?;
        let data = self.data.get(view.buffer.index()).and_then(|d| d.as_ref()).ok_or_else(|| {
            SceneError::at(format!("/buffers/{}", view.buffer.0), "has no data: neither a uri nor a BIN chunk")
                .expected(format!("data, since /bufferViews/{} is read", index.0))
                .cure("export the model again")
        })?;
        let start = view.byte_offset.index();
        // The views are checked against lengths that the data are known to have.
        Ok(data.0.get(start..start.saturating_add(view.byte_length.index())).unwrap_or_default())
    }
}

/// Container of the buffers.
#[derive(Clone, Copy)]
pub(crate) enum GltfContainer<'a> {
    /// A `.gltf` file.
    Json,
    /// A `.glb` file and its BIN chunk.
    Glb(Option<&'a [u8]>),
}

fn check_view(document: &GltfDocument, i: usize, view: &BufferView) -> Result<(), SceneError> {
    let place = || format!("/bufferViews/{i}/byteLength");
    let buffer = resolve(&document.buffers, "buffers", view.buffer, || format!("/bufferViews/{i}/buffer"))?;
    if view.byte_length.0 == 0 {
        return Err(SceneError::at(place(), "is 0").expected("at least 1"));
    }
    let end = view.byte_offset.0.checked_add(view.byte_length.0);
    if end.is_none_or(|end| end > buffer.byte_length.0) {
        let (length, offset) = (view.byte_length.0, view.byte_offset.0);
        return Err(SceneError::at(place(), format!("{length} bytes from byte {offset} on do not fit"))
            .expected(format!("a range within buffer {}, which has {} bytes", view.buffer.0, buffer.byte_length.0))
            .cure("export the model again"));
    }
    Ok(())
}

/// Bytes of a buffer with their reservation.
type HeldBytes<'a> = (Cow<'a, [u8]>, MemoryReservation);

fn load_buffer<'a>(
    i: usize,
    buffer: &GltfBuffer,
    container: GltfContainer<'a>,
    outside: &ImportContext<'_>,
) -> Result<Option<HeldBytes<'a>>, SceneError> {
    let place = format!("/buffers/{i}");
    if buffer.byte_length.0 == 0 {
        return Err(SceneError::at(format!("{place}/byteLength"), "is 0").expected("at least 1"));
    }
    let (data, held) = match (&buffer.uri, container) {
        (Some(uri), _) => {
            let (data, held) = read_uri(uri, outside, &format!("{place}/uri"))?;
            (Cow::Owned(data), held)
        }
        (None, GltfContainer::Glb(Some(bin))) if i == 0 => (Cow::Borrowed(bin), outside.nothing()),
        (None, GltfContainer::Glb(None)) if i == 0 => {
            return Err(SceneError::at(place, "the GLB file has no BIN chunk")
                .expected("one, since this buffer has no uri")
                .cure("export the model again"));
        }
        (None, _) => return Ok(None),
    };
    if (data.len() as u64) < buffer.byte_length.0 {
        let what = format!("is {}, but the data have {} bytes", buffer.byte_length.0, data.len());
        return Err(SceneError::at(format!("{place}/byteLength"), what)
            .expected("no more than there is")
            .cure("the data are cut off: export or download them again"));
    }
    Ok(Some((data, held)))
}

/// Reads the bytes of a data URI or of a file relative to the model, with their reservation.
pub(crate) fn read_uri(uri: &str, outside: &ImportContext<'_>, place: &str) -> Result<(Vec<u8>, MemoryReservation), SceneError> {
    if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        // Text without percent escapes, and the bytes.
        let held = outside.take(uri.len() as u64 * if uri.contains('%') { 2 } else { 1 }, place, "a data URI")?;
        return decode_data_uri(uri).map(|bytes| (bytes, held)).ok_or_else(|| {
            SceneError::at(place, format!("invalid data URI `{}`", shorten(uri)))
                .expected("`data:[type];base64,` and base64 text, or `data:[type],` and percent-encoded bytes")
                .cure("export the model again")
        });
    }
    let name = percent_decode(uri).ok_or_else(|| {
        SceneError::at(place, format!("`{}` has a wrong percent escape", shorten(uri))).expected("%XX, in UTF-8")
    })?;
    outside.read(&name, place)
}

/// Readers differ on padding and on bits beyond the end; exporters do, too.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent).with_decode_allow_trailing_bits(true),
);

fn decode_data_uri(uri: &str) -> Option<Vec<u8>> {
    let (head, data) = uri.split_once(',')?;
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return percent_bytes(data);
    }
    // Base64 text has three special characters, which some exporters escape.
    let text = if data.contains('%') { Cow::Owned(percent_bytes(data)?) } else { Cow::Borrowed(data.as_bytes()) };
    BASE64.decode(text.trim_ascii()).ok()
}

fn percent_decode(uri: &str) -> Option<String> {
    String::from_utf8(percent_bytes(uri)?).ok()
}

fn percent_bytes(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digit = |b: Option<u8>| char::from(b?).to_digit(16);
            bytes.push((digit(rest.next())? * 16 + digit(rest.next())?) as u8);
        } else {
            bytes.push(byte);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::MemoryFiles;
    use basrelief_input::MemoryPool;

    #[test]
    fn uris_are_decoded() {
        let files = MemoryFiles::default().with("a b.bin", *b"xyz");
        let outside = ImportContext::new(&files, &MemoryPool::default());
        let read = |uri: &str| read_uri(uri, &outside, "").map(|(bytes, _)| bytes);
        assert_eq!(read("a%20b.bin").unwrap(), b"xyz");
        assert_eq!(read("data:application/octet-stream;base64,AAEC").unwrap(), [0, 1, 2]);
        assert_eq!(read("data:;base64,%2B%2F8%3D").unwrap(), [0xfb, 0xff]);
        assert_eq!(read("data:;base64,AA").unwrap(), [0]);
        assert_eq!(read("data:text/plain,x%00").unwrap(), [b'x', 0]);
        for bad in ["data:", "data:;base64,A*", "a%2", "a%zz", "%ff", "http://a/b", "/a", "é"] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
