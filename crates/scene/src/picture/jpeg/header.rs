//! Marker segments of a JPEG file (ITU-T T.81, annex B).

use crate::SceneError;
use jpeg_decoder::ColorTransform;

/// Markers: the byte behind `0xFF`.
mod marker {
    pub const ARITHMETIC_TABLES: u8 = 0xcc;
    pub const END: u8 = 0xd9;
    pub const SCAN: u8 = 0xda;
    pub const HIERARCHICAL: [u8; 2] = [0xde, 0xdf];
    pub const APP0: u8 = 0xe0;
    pub const APP14: u8 = 0xee;
    pub const JPEG_LS: u8 = 0xf7;
    /// Markers without data: TEM and the restart markers.
    pub fn stands_alone(marker: u8) -> bool {
        marker == 0x01 || is_restart(marker)
    }
    pub fn is_restart(marker: u8) -> bool {
        (0xd0..=0xd7).contains(&marker)
    }
}

/// A colour component.
pub(super) struct JpegComponent {
    id: u8,
    /// Horizontal and vertical sampling factor, each 1..=4.
    sampling: [u32; 2],
    /// A scan holds its mean values (DC coefficients).
    has_scan: bool,
}

/// Facts about a JPEG file that can be decoded.
#[derive(Default)]
pub(super) struct JpegHeader {
    /// Width and height \[pixels\].
    pub size: [u32; 2],
    pub components: Vec<JpegComponent>,
    /// Offset of the marker behind the data of each scan \[bytes\].
    pub scan_ends: Vec<usize>,
    has_jfif: bool,
    /// Colour transform that an Adobe segment names.
    adobe_transform: Option<u8>,
}

impl JpegHeader {
    /// Reads all marker segments up to the end-of-image marker.
    ///
    /// # Errors
    /// A kind of JPEG that is not supported, a missing end, or segments that contradict each other.
    pub fn read(bytes: &[u8]) -> Result<Self, SceneError> {
        let mut header = Self::default();
        let mut at = 2;
        loop {
            let (marker, data_at) = next_marker(bytes, at).ok_or_else(|| cut_off("the end-of-image marker (EOI) is missing"))?;
            if marker == marker::END {
                return header.complete();
            }
            at = data_at;
            if marker::stands_alone(marker) {
                continue;
            }
            let data = segment(bytes, data_at).ok_or_else(|| cut_off("a marker segment is incomplete"))?;
            at += 2 + data.len();
            header.read_segment(marker, data)?;
            if marker == marker::SCAN {
                at = end_of_scan(bytes, at);
                header.scan_ends.push(at);
            }
        }
    }

    /// Samples of all components, each padded to whole MCUs as if none was subsampled.
    pub fn samples(&self) -> u64 {
        let [width, height] = [0, 1].map(|axis| u64::from(self.size[axis]).next_multiple_of(8 * u64::from(self.largest(axis))));
        width * height * self.components.len() as u64
    }

    /// The colour transform by the rules of libjpeg: a JFIF segment first, then an Adobe segment, then component numbers.
    pub fn color_transform(&self) -> ColorTransform {
        let ids: Vec<u8> = self.components.iter().map(|c| c.id).collect();
        match (ids.as_slice(), self.has_jfif, self.adobe_transform) {
            ([_], ..) => ColorTransform::Grayscale,
            (_, false, Some(0)) => ColorTransform::RGB,
            (b"RGB", false, None) => ColorTransform::RGB,
            _ => ColorTransform::YCbCr,
        }
    }

    fn read_segment(&mut self, marker: u8, data: &[u8]) -> Result<(), SceneError> {
        match marker {
            0xc0..=0xc2 => self.read_frame(data),
            0xc3 => Err(unsupported("uses lossless coding")),
            0xc5..=0xc7 => Err(unsupported("uses hierarchical coding")),
            0xc9..=0xcb | 0xcd..=0xcf | marker::ARITHMETIC_TABLES => Err(unsupported("uses arithmetic coding")),
            marker::JPEG_LS => Err(unsupported("is a JPEG-LS file")),
            marker::SCAN => self.read_scan(data),
            marker::APP0 if data.starts_with(b"JFIF\0") => {
                self.has_jfif = true;
                Ok(())
            }
            marker::APP14 if data.starts_with(b"Adobe") => {
                self.adobe_transform = data.get(11).copied();
                Ok(())
            }
            _ if marker::HIERARCHICAL.contains(&marker) => Err(unsupported("uses hierarchical coding")),
            _ => Ok(()),
        }
    }

    fn read_frame(&mut self, data: &[u8]) -> Result<(), SceneError> {
        let [precision, y1, y0, x1, x0, count, components @ ..] = data else {
            return Err(corrupt("its frame header is too short"));
        };
        if !self.components.is_empty() {
            return Err(unsupported("has several frames (hierarchical coding)"));
        }
        if *precision != 8 {
            return Err(unsupported(format!("has {precision} bits per sample")));
        }
        match count {
            1 | 3 => {}
            4 => return Err(unsupported("has four components (CMYK or YCCK colours)")),
            _ => return Err(unsupported(format!("has {count} components"))),
        }
        self.size = [u16::from_be_bytes([*x1, *x0]), u16::from_be_bytes([*y1, *y0])].map(u32::from);
        if self.size[1] == 0 {
            return Err(unsupported("gives its height behind the first scan (DNL marker)"));
        }
        for [id, factors, _table] in components.as_chunks().0 {
            let sampling = [factors >> 4, factors & 15].map(u32::from);
            if sampling.iter().any(|factor| !(1..=4).contains(factor)) {
                return Err(corrupt("a sampling factor is not 1, 2, 3 or 4"));
            }
            self.components.push(JpegComponent { id: *id, sampling, has_scan: false });
        }
        if self.components.len() != usize::from(*count) {
            return Err(corrupt("its frame header has another length than its number of components asks for"));
        }
        self.check_sampling()
    }

    /// Refuses sampling factors that do not divide the largest one, such as 2 of 3.
    fn check_sampling(&self) -> Result<(), SceneError> {
        for axis in [0, 1] {
            let largest = self.largest(axis);
            if let Some(part) = self.components.iter().map(|c| c.sampling[axis]).find(|part| !largest.is_multiple_of(*part)) {
                return Err(unsupported(format!("has sampling factors {largest} and {part}, whose ratio is not a whole number")));
            }
        }
        Ok(())
    }

    fn read_scan(&mut self, data: &[u8]) -> Result<(), SceneError> {
        let Some((count, rest)) = data.split_first() else { return Err(corrupt("a scan header is too short")) };
        let (selectors, rest) =
            rest.as_chunks::<2>().0.split_at_checked(usize::from(*count)).ok_or_else(|| corrupt("a scan header is too short"))?;
        let first_coefficient = rest.first().map_or(0, |[first, _]| *first);
        for [id, _tables] in selectors {
            let component = self.components.iter_mut().find(|c| c.id == *id);
            let component =
                component.ok_or_else(|| corrupt(format!("a scan names component {id}, which the frame does not have")))?;
            component.has_scan |= first_coefficient == 0;
        }
        if let [[id, _]] = selectors {
            self.check_lone_scan(*id)?;
        }
        Ok(())
    }

    /// Refuses a scan of one component of which the decoder would read a wrong number of blocks.
    ///
    /// T.81 A.2.2 asks for as many as cover the component. The decoder reads as many as its MCUs have, but at most as many as
    /// cover the picture: too many if, for example, the factor is 2 of 4 and the width is 100.
    fn check_lone_scan(&self, id: u8) -> Result<(), SceneError> {
        let Some(component) = self.components.iter().find(|c| c.id == id) else { return Ok(()) };
        for axis in [0, 1] {
            let (size, part, largest) = (self.size[axis], component.sampling[axis], self.largest(axis));
            let read = (size.div_ceil(8 * largest) * part).min(size.div_ceil(8));
            if read != (size * part).div_ceil(largest).div_ceil(8) {
                let what = format!("has a scan of a single component whose sampling factor is {part} of {largest}");
                return Err(unsupported(what));
            }
        }
        Ok(())
    }

    fn complete(self) -> Result<Self, SceneError> {
        if self.components.is_empty() || self.components.iter().any(|c| !c.has_scan) {
            return Err(cut_off("a component has no scan"));
        }
        Ok(self)
    }

    fn largest(&self, axis: usize) -> u32 {
        self.components.iter().map(|c| c.sampling[axis]).max().unwrap_or(1)
    }
}

/// The next marker from this offset on, and the offset behind it. Other bytes are skipped, as libjpeg does.
fn next_marker(bytes: &[u8], from: usize) -> Option<(u8, usize)> {
    let pairs = bytes.get(from..)?.windows(2);
    let (at, marker) = pairs.enumerate().find_map(|(i, pair)| match pair {
        [0xff, marker] if !matches!(marker, 0 | 0xff) => Some((i, *marker)),
        _ => None,
    })?;
    Some((marker, from + at + 2))
}

/// Data of the marker segment whose length is at this offset.
fn segment(bytes: &[u8], at: usize) -> Option<&[u8]> {
    let length = bytes.get(at..)?.first_chunk()?;
    let length = usize::from(u16::from_be_bytes(*length));
    bytes.get(at + 2..at.checked_add(length)?)
}

/// Offset of the first marker at or behind this offset that ends the data of a scan; fill bytes are part of the marker.
fn end_of_scan(bytes: &[u8], from: usize) -> usize {
    let mut at = from;
    while let Some((marker, behind)) = next_marker(bytes, at) {
        if !marker::is_restart(marker) {
            let data = bytes.get(..behind - 1).unwrap_or_default();
            return data.len() - data.iter().rev().take_while(|byte| **byte == 0xff).count();
        }
        at = behind;
    }
    bytes.len()
}

pub(super) fn unsupported(what: impl std::fmt::Display) -> SceneError {
    SceneError::at("", format!("this JPEG {what}, which is not supported"))
        .expected("a baseline or progressive JPEG with Huffman coding, 8 bits per sample, and grey, YCbCr or RGB colours")
        .cure("open it in an image editor and save it as an ordinary JPEG or as PNG")
}

pub(super) fn cut_off(why: &str) -> SceneError {
    SceneError::at("", format!("this JPEG is cut off: {why}")).expected("a complete image").cure("fetch it or export it again")
}

pub(super) fn corrupt(why: impl std::fmt::Display) -> SceneError {
    SceneError::at("", format!("this JPEG is corrupt: {why}"))
        .expected("a complete image")
        .cure("open it in an image editor and save it again, or fetch it again")
}
