//! Accessors: typed vertex data out of bytes that may claim anything.
//!
//! Every number in the file is untrusted. Offsets are added with overflow checks, nothing is allocated before it is known
//! that the bytes for it are there, and all that is decoded is counted against one budget (a small buffer that a million
//! primitives refer to would otherwise grow without bounds).

use super::buffers::Buffers;
use super::check::resolve;
use super::json::{Accessor, Document, Int, Sparse};
use crate::SceneError;
use std::cell::Cell;

/// Most bytes that all accessors together may decode to.
const MAX_DECODED: u64 = 1 << 29;

/// Most elements of an accessor without a buffer view, which nothing in the file backs.
const MAX_ZEROS: u64 = 1 << 20;

/// Type of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn parse(code: Int, place: impl FnOnce() -> String) -> Result<Self, SceneError> {
        Ok(match code.0 {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => {
                return Err(
                    SceneError::at(place(), format!("component type {other}")).expected("5120, 5121, 5122, 5123, 5125 or 5126")
                );
            }
        })
    }

    fn bytes(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::I8 => "signed byte",
            Self::U8 => "unsigned byte",
            Self::I16 => "signed short",
            Self::U16 => "unsigned short",
            Self::U32 => "unsigned int",
            Self::F32 => "float",
        }
    }
}

/// What an accessor's elements are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Format {
    pub component: Component,
    pub normalized: bool,
    /// Components per column: 1..=4.
    rows: usize,
    /// 1, or more for a matrix.
    columns: usize,
}

impl Format {
    /// For messages.
    pub(crate) fn name(self) -> String {
        let kind = match (self.columns, self.rows) {
            (1, 1) => "SCALAR".into(),
            (1, rows) => format!("VEC{rows}"),
            (columns, _) => format!("MAT{columns}"),
        };
        format!("{kind} of {}{}", if self.normalized { "normalized " } else { "" }, self.component.name())
    }

    /// Whether it is a vector (or scalar) of this width.
    pub(crate) fn is_vector(self, width: usize) -> bool {
        self.columns == 1 && self.rows == width
    }

    /// Bytes of an element; columns of matrices begin at multiples of four bytes.
    fn element_bytes(self) -> u64 {
        let column = self.component.bytes() * self.rows as u64;
        if self.columns == 1 { column } else { self.columns as u64 * column.next_multiple_of(4) }
    }
}

/// Reads accessors of one document.
pub(crate) struct Accessors<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    budget: Cell<u64>,
}

/// Elements of an accessor without gaps, sparse replacements done.
struct Packed {
    format: Format,
    bytes: Vec<u8>,
}

impl<'a> Accessors<'a> {
    /// Checks that every accessor lies within its buffer view.
    pub(crate) fn new(document: &'a Document, buffers: &'a Buffers<'a>) -> Result<Self, SceneError> {
        let accessors = Self { document, buffers, budget: Cell::new(MAX_DECODED) };
        for (i, accessor) in document.accessors.iter().enumerate() {
            let format = format_of(accessor, i)?;
            accessors.source(accessor, i, format)?;
            if let Some(sparse) = &accessor.sparse {
                accessors.sparse_sources(sparse, i, format)?;
            }
        }
        Ok(accessors)
    }

    /// Checks the numbers of every accessor of floats: for files of which nothing is drawn, to find out why.
    pub(crate) fn check_finite(&self) -> Result<(), SceneError> {
        for i in 0..self.document.accessors.len() {
            let index = Int(i as u64);
            let (format, _) = self.describe(index, "")?;
            if format.component == Component::F32 && format.rows <= 4 && format.columns == 1 {
                self.floats::<4>(index, "nothing that is drawn")?;
            }
        }
        Ok(())
    }

    /// Format and number of elements.
    pub(crate) fn describe(&self, index: Int, place: &str) -> Result<(Format, u64), SceneError> {
        let accessor = resolve(&self.document.accessors, "accessors", index, || place.into())?;
        Ok((format_of(accessor, index.index())?, accessor.count.0))
    }

    /// Counts bytes that are about to be allocated for decoded data.
    pub(crate) fn charge(&self, bytes: u64, place: &str) -> Result<(), SceneError> {
        let left = self.budget.get().checked_sub(bytes).ok_or_else(|| {
            SceneError::at(place, "the geometry of this file decodes to too much data")
                .expected(format!("at most {} MiB", MAX_DECODED >> 20))
                .cure("decimate or split the model")
        })?;
        self.budget.set(left);
        Ok(())
    }

    /// Elements as floats, of which there are `N` or fewer per element; the rest is 0 (1 for the fourth).
    pub(crate) fn floats<const N: usize>(&self, index: Int, place: &str) -> Result<Vec<[f32; N]>, SceneError> {
        let Packed { format, bytes } = self.packed(index, place)?;
        self.charge(4 * N as u64 * (bytes.len() as u64 / format.element_bytes()), place)?;
        let step = format.component.bytes() as usize;
        let mut elements = Vec::with_capacity(bytes.len() / format.element_bytes() as usize);
        for (i, element) in bytes.chunks_exact(format.element_bytes() as usize).enumerate() {
            let mut values = std::array::from_fn(|k| if k == 3 { 1.0 } else { 0.0 });
            for (value, raw) in values.iter_mut().zip(element.chunks_exact(step)) {
                *value = decode(raw, format);
            }
            if values.iter().any(|v| !v.is_finite()) {
                return Err(SceneError::at(
                    format!("/accessors/{}", index.0),
                    format!("element {i} is {values:?}, used by {place}"),
                )
                .expected("finite numbers")
                .cure("export the model again"));
            }
            elements.push(values);
        }
        Ok(elements)
    }

    /// Elements as indices.
    pub(crate) fn indices(&self, index: Int, place: &str) -> Result<Vec<u32>, SceneError> {
        let Packed { format, bytes } = self.packed(index, place)?;
        let unsigned = matches!(format.component, Component::U8 | Component::U16 | Component::U32);
        if !format.is_vector(1) || !unsigned || format.normalized {
            return Err(SceneError::at(place, format!("accessor {} is {}", index.0, format.name()))
                .expected("SCALAR of unsigned byte, unsigned short or unsigned int"));
        }
        self.charge(4 * (bytes.len() as u64 / format.component.bytes()), place)?;
        let numbers = unsigned_numbers(&bytes, format.component);
        let restart = u32::MAX >> (32 - 8 * format.component.bytes());
        if let Some(k) = numbers.iter().position(|n| *n == restart) {
            return Err(SceneError::at(place, format!("index {k} of accessor {} is {restart}", index.0))
                .expected(format!("indices below {restart}, which other formats use to restart a primitive"))
                .cure("export the model again"));
        }
        Ok(numbers)
    }

    fn packed(&self, index: Int, place: &str) -> Result<Packed, SceneError> {
        let accessor = resolve(&self.document.accessors, "accessors", index, || place.into())?;
        let format = format_of(accessor, index.index())?;
        let total = accessor.count.0.saturating_mul(format.element_bytes());
        self.charge(total, place)?;
        let mut bytes = match self.source(accessor, index.index(), format)? {
            Some(span) => {
                let elements = self.elements(&span)?;
                let mut bytes = Vec::with_capacity(total as usize);
                elements.for_each(|element| bytes.extend_from_slice(element));
                bytes
            }
            None => vec![0; total as usize],
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace(sparse, index.index(), format, &mut bytes)?;
        }
        Ok(Packed { format, bytes })
    }

    /// Where the elements lie; `None` for an accessor of zeros.
    fn source(&self, accessor: &Accessor, i: usize, format: Format) -> Result<Option<Span>, SceneError> {
        let place = format!("/accessors/{i}");
        let count = accessor.count.0;
        let Some(view) = accessor.buffer_view else {
            if count > MAX_ZEROS {
                return Err(SceneError::at(format!("{place}/count"), format!("{count} elements without a buffer view"))
                    .expected(format!("at most {MAX_ZEROS} where no data back them"))
                    .cure("give the accessor a buffer view"));
            }
            return Ok(None);
        };
        let element = format.element_bytes();
        let views = &self.document.buffer_views;
        let stride = resolve(views, "bufferViews", view, || format!("{place}/bufferView"))?.byte_stride;
        let stride = stride.map_or(element, |s| s.0);
        if stride < element {
            return Err(SceneError::at(format!("/bufferViews/{}/byteStride", view.0), format!("is {stride}"))
                .expected(format!("at least {element}, the size of an element of accessor {i}")));
        }
        self.span(view, accessor.byte_offset, count, [stride, element], &place).map(Some)
    }

    /// The part of a buffer view that holds `count` elements, checked against the view's length.
    fn span(&self, view: Int, offset: Int, count: u64, [stride, element]: [u64; 2], place: &str) -> Result<Span, SceneError> {
        let views = &self.document.buffer_views;
        let length = resolve(views, "bufferViews", view, || format!("{place}/bufferView"))?.byte_length.0;
        let needed = count.checked_sub(1).and_then(|n| n.checked_mul(stride)).and_then(|n| n.checked_add(element));
        if needed.and_then(|n| n.checked_add(offset.0)).is_none_or(|end| end > length) {
            let what = format!("{count} elements of {element} bytes, {stride} apart, from byte {} on do not fit", offset.0);
            return Err(SceneError::at(format!("{place}/count"), what)
                .expected(format!("at least one, and all within buffer view {}, which has {length} bytes", view.0))
                .cure("export the model again"));
        }
        // All of it lies within the view, so it can be addressed as soon as the view has data.
        let [stride, element] = [stride, element].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        Ok(Span { view, start: offset.index(), count: Int(count).index(), stride, element })
    }

    /// The elements of a span, one after the other.
    fn elements(&self, span: &Span) -> Result<impl Iterator<Item = &[u8]> + use<'_>, SceneError> {
        let bytes = self.buffers.view(self.document, span.view, String::new)?;
        let Span { start, count, stride, element, .. } = *span;
        Ok((0..count).filter_map(move |i| bytes.get(start + i * stride..start + i * stride + element)))
    }

    /// Where the indices and the values of a sparse accessor lie.
    fn sparse_sources(&self, sparse: &Sparse, i: usize, format: Format) -> Result<(Component, Span, Span), SceneError> {
        let place = |part: &str| format!("/accessors/{i}/sparse/{part}");
        let component = Component::parse(sparse.indices.component_type, || place("indices/componentType"))?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(SceneError::at(place("indices/componentType"), component.name()).expected("an unsigned type"));
        }
        let (count, at) = (sparse.count.0, &sparse.indices);
        let indices = self.span(at.buffer_view, at.byte_offset, count, [component.bytes(); 2], &place("indices"))?;
        let at = &sparse.values;
        let values = self.span(at.buffer_view, at.byte_offset, count, [format.element_bytes(); 2], &place("values"))?;
        Ok((component, indices, values))
    }

    fn replace(&self, sparse: &Sparse, i: usize, format: Format, bytes: &mut [u8]) -> Result<(), SceneError> {
        let (component, indices, values) = self.sparse_sources(sparse, i, format)?;
        let mut least = 0;
        for (k, (index, value)) in self.elements(&indices)?.zip(self.elements(&values)?).enumerate() {
            let index = unsigned_numbers(index, component).first().copied().unwrap_or_default();
            let start = (index as usize).saturating_mul(value.len());
            let target = bytes.get_mut(start..start.saturating_add(value.len())).filter(|_| index >= least);
            let target = target.ok_or_else(|| {
                SceneError::at(format!("/accessors/{i}/sparse/indices"), format!("index {k} is {index}"))
                    .expected("strictly increasing indices below the accessor's count")
            })?;
            target.copy_from_slice(value);
            least = index.saturating_add(1);
        }
        Ok(())
    }
}

/// A checked place of elements in a buffer view \[bytes\].
struct Span {
    view: Int,
    start: usize,
    count: usize,
    stride: usize,
    element: usize,
}

fn format_of(accessor: &Accessor, i: usize) -> Result<Format, SceneError> {
    let component = Component::parse(accessor.component_type, || format!("/accessors/{i}/componentType"))?;
    let (columns, rows) = match accessor.kind.as_str() {
        "SCALAR" => (1, 1),
        "VEC2" => (1, 2),
        "VEC3" => (1, 3),
        "VEC4" => (1, 4),
        "MAT2" => (2, 2),
        "MAT3" => (3, 3),
        "MAT4" => (4, 4),
        other => {
            return Err(SceneError::at(format!("/accessors/{i}/type"), format!("type `{other}`"))
                .expected("SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4"));
        }
    };
    if accessor.normalized && matches!(component, Component::U32 | Component::F32) {
        return Err(SceneError::at(format!("/accessors/{i}/normalized"), format!("true for {}", component.name()))
            .expected("true only for bytes and shorts"));
    }
    if accessor.count.0 == 0 {
        return Err(SceneError::at(format!("/accessors/{i}/count"), "is 0").expected("at least 1"));
    }
    Ok(Format { component, normalized: accessor.normalized, rows, columns })
}

fn unsigned_numbers(bytes: &[u8], component: Component) -> Vec<u32> {
    match component {
        Component::U8 => bytes.iter().map(|b| u32::from(*b)).collect(),
        Component::U16 => bytes.as_chunks().0.iter().map(|b| u32::from(u16::from_le_bytes(*b))).collect(),
        _ => bytes.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect(),
    }
}

/// A component as a float; normalized integers to 0..=1 or -1..=1 (glTF 2.0, section 3.11).
fn decode(raw: &[u8], format: Format) -> f32 {
    let scaled = |value: f32, most: f32| if format.normalized { (value / most).max(-1.0) } else { value };
    match (format.component, raw) {
        (Component::I8, [a]) => scaled(f32::from(*a as i8), 127.0),
        (Component::U8, [a]) => scaled(f32::from(*a), 255.0),
        (Component::I16, [a, b]) => scaled(f32::from(i16::from_le_bytes([*a, *b])), 32767.0),
        (Component::U16, [a, b]) => scaled(f32::from(u16::from_le_bytes([*a, *b])), 65535.0),
        (Component::U32, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
        (Component::F32, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
        _ => 0.0,
    }
}
