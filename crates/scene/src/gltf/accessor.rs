//! Accessors: typed vertex data out of bytes that may claim anything.
//!
//! Every number in the file is untrusted. Offsets are added with overflow checks. Nothing is allocated before the bytes for
//! it are found. Decoded data are counted against the memory limit, because a million primitives can refer to one small
//! buffer.

use super::buffers::GltfBuffers;
use super::check::resolve;
use super::format::{ComponentType, ElementFormat, decode, format_of, unsigned_numbers};
use super::json::{GltfAccessor, GltfDocument, GltfInteger, SparseAccessor};
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::outside::{ImportContext, over_budget};
use basrelief_input::MemoryReservation;
use std::cell::RefCell;

/// Function that returns the smaller or the larger of two numbers.
type CompareFn = fn(f32, f32) -> f32;

/// Maximum number of elements of an accessor without a buffer view, which nothing in the file backs.
const MAX_ZEROS: u64 = 1 << 20;

/// Reads accessors of one document.
pub(crate) struct AccessorReader<'a> {
    document: &'a GltfDocument,
    buffers: &'a GltfBuffers<'a>,
    outside: &'a ImportContext<'a>,
    /// Memory of the mesh that is being built.
    building: RefCell<MemoryReservation>,
}

/// Elements of an accessor without gaps, sparse replacements done.
struct DenseElements {
    format: ElementFormat,
    bytes: Vec<u8>,
    _held: MemoryReservation,
}

impl DenseElements {
    /// The least or largest of each component.
    fn extreme(&self, format: ElementFormat, choose: fn(f32, f32) -> f32) -> Vec<f32> {
        let size = format.component.bytes() as usize;
        let element = |bytes: &[u8]| bytes.chunks_exact(size).map(|raw| decode(raw, format)).collect::<Vec<_>>();
        let mut elements = self.bytes.chunks_exact(format.used_bytes() as usize);
        let mut extreme = elements.next().map(element).unwrap_or_default();
        for bytes in elements {
            for (value, raw) in extreme.iter_mut().zip(bytes.chunks_exact(size)) {
                *value = choose(*value, decode(raw, format));
            }
        }
        extreme
    }
}

impl<'a> AccessorReader<'a> {
    /// Checks that every accessor lies within its buffer view, and warns of those that are not aligned.
    pub(crate) fn new(
        document: &'a GltfDocument,
        buffers: &'a GltfBuffers<'a>,
        outside: &'a ImportContext<'a>,
        warnings: &mut ImportWarnings,
    ) -> Result<Self, SceneError> {
        let accessors = Self { document, buffers, outside, building: RefCell::new(outside.nothing()) };
        for (i, accessor) in document.accessors.iter().enumerate() {
            let format = format_of(accessor, i)?;
            accessors.source(accessor, i, format)?;
            let place = format!("/accessors/{i}");
            if let Some(view) = accessor.buffer_view {
                accessors.check_alignment(view, accessor.byte_offset, format.component, &place, warnings);
            }
            if let Some(sparse) = &accessor.sparse {
                let (component, ..) = accessors.sparse_sources(sparse, i, format)?;
                let (indices, values) = (&sparse.indices, &sparse.values);
                let part = |name: &str| format!("{place}/sparse/{name}");
                accessors.check_alignment(indices.buffer_view, indices.byte_offset, component, &part("indices"), warnings);
                accessors.check_alignment(values.buffer_view, values.byte_offset, format.component, &part("values"), warnings);
            }
        }
        Ok(accessors)
    }

    /// Warns of elements that do not begin at multiples of their components' size: other readers may not take them.
    fn check_alignment(
        &self,
        view: GltfInteger,
        offset: GltfInteger,
        component: ComponentType,
        place: &str,
        warnings: &mut ImportWarnings,
    ) {
        let base = self.document.buffer_views.get(view.index()).map_or(0, |v| v.byte_offset.0);
        let size = component.bytes();
        // Both lie within one buffer, so the sum does not overflow.
        if !offset.0.is_multiple_of(size) || !base.saturating_add(offset.0).is_multiple_of(size) {
            warnings.add(format!(
                "{place}/byteOffset: is {} in a buffer view that begins at byte {base}, expected both together and it alone to be \
                 multiples of {size}, the size of one {}: read as it stands",
                offset.0,
                component.name()
            ));
        }
    }

    /// Bytes between the elements of an accessor, where its buffer view says so.
    pub(crate) fn stride(&self, index: GltfInteger) -> Option<(GltfInteger, u64)> {
        let view = self.document.accessors.get(index.index())?.buffer_view?;
        Some((view, self.document.buffer_views.get(view.index())?.byte_stride?.0))
    }

    /// Warns if `min` or `max` differs from the data. This importer does not use them; other readers do.
    fn check_extremes(&self, index: GltfInteger, packed: &DenseElements, warnings: &mut ImportWarnings) {
        let Some(accessor) = self.document.accessors.get(index.index()) else { return };
        let stored = ElementFormat { normalized: false, ..packed.format };
        let extremes: [(&str, &Option<Vec<f64>>, CompareFn); 2] =
            [("min", &accessor.min, f32::min), ("max", &accessor.max, f32::max)];
        for (name, declared, choose) in extremes {
            let Some(declared) = declared else { continue };
            let place = format!("/accessors/{}/{name}", index.0);
            if declared.len() != stored.rows {
                let count = declared.len();
                warnings.add(format!("{place}: holds {count} numbers, expected {}: not used", stored.rows));
                continue;
            }
            let actual = packed.extreme(stored, choose);
            if let Some((k, (said, is))) = declared.iter().zip(&actual).enumerate().find(|(_, (d, a))| **d as f32 != **a) {
                warnings.add(format!("{place}/{k}: is {said}, expected {is}, as in the data: not used"));
            }
        }
    }

    /// Checks the numbers of every accessor of floats. A fault may be the reason why nothing is drawn.
    pub(crate) fn check_finite(&self, warnings: &mut ImportWarnings) -> Result<(), SceneError> {
        for i in 0..self.document.accessors.len() {
            let index = GltfInteger(i as u64);
            let (format, _) = self.describe(index, "")?;
            if format.component == ComponentType::F32 && format.rows <= 4 && format.columns == 1 {
                self.floats::<4>(index, "nothing that is drawn", warnings)?;
                self.built(0);
            }
        }
        Ok(())
    }

    /// Format and number of elements.
    pub(crate) fn describe(&self, index: GltfInteger, place: &str) -> Result<(ElementFormat, u64), SceneError> {
        let accessor = resolve(&self.document.accessors, "accessors", index, || place.into())?;
        Ok((format_of(accessor, index.index())?, accessor.count.0))
    }

    /// Counts bytes that are about to be allocated for the mesh that is being built.
    pub(crate) fn charge(&self, bytes: u64, place: &str) -> Result<(), SceneError> {
        self.building.borrow_mut().try_grow(bytes, "vertices and triangles").map_err(|error| over_budget(place, &error))
    }

    /// Ends a mesh. This many bytes stay, and the rest is given back.
    pub(crate) fn built(&self, bytes: u64) {
        let mut held = self.building.replace(self.outside.nothing());
        held.shrink_to(bytes);
        self.outside.keep(held);
    }

    /// Elements as floats, of which there are `N` or fewer per element; the rest is 0 (1 for the fourth).
    pub(crate) fn floats<const N: usize>(
        &self,
        index: GltfInteger,
        place: &str,
        warnings: &mut ImportWarnings,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let packed = self.packed(index, place)?;
        self.check_extremes(index, &packed, warnings);
        let DenseElements { format, bytes, _held } = packed;
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
    pub(crate) fn indices(&self, index: GltfInteger, place: &str, warnings: &mut ImportWarnings) -> Result<Vec<u32>, SceneError> {
        let packed = self.packed(index, place)?;
        let DenseElements { format, bytes, .. } = &packed;
        let unsigned = matches!(format.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if !format.is_vector(1) || !unsigned || format.normalized {
            return Err(SceneError::at(place, format!("accessor {} is {}", index.0, format.name()))
                .expected("SCALAR of unsigned byte, unsigned short or unsigned int"));
        }
        self.check_stride_of_indices(index, format.component, warnings)?;
        self.check_extremes(index, &packed, warnings);
        self.charge(4 * (bytes.len() as u64 / format.component.bytes()), place)?;
        let numbers = unsigned_numbers(bytes, format.component);
        let restart = u32::MAX >> (32 - 8 * format.component.bytes());
        if let Some(k) = numbers.iter().position(|n| *n == restart) {
            return Err(SceneError::at(place, format!("index {k} of accessor {} is {restart}", index.0))
                .expected(format!("indices below {restart}, which other formats use to restart a primitive"))
                .cure("export the model again"));
        }
        Ok(numbers)
    }

    /// Indices have no stride. A stride of the size of an index does no harm. With another stride, readers that use it draw
    /// other triangles than readers that ignore it.
    fn check_stride_of_indices(
        &self,
        index: GltfInteger,
        component: ComponentType,
        warnings: &mut ImportWarnings,
    ) -> Result<(), SceneError> {
        let Some((view, stride)) = self.stride(index) else { return Ok(()) };
        let (place, used_by) = (format!("/bufferViews/{}/byteStride", view.0), format!("/accessors/{}", index.0));
        if stride != component.bytes() {
            return Err(SceneError::at(place, format!("is {stride}, and {used_by}, which lies in it, holds indices"))
                .expected("no byteStride: indices lie side by side")
                .cure("export the model again"));
        }
        warnings.add(format!("{place}: is {stride}, expected none, since {used_by}, which lies in it, holds indices"));
        Ok(())
    }

    fn packed(&self, index: GltfInteger, place: &str) -> Result<DenseElements, SceneError> {
        let accessor = resolve(&self.document.accessors, "accessors", index, || place.into())?;
        let format = format_of(accessor, index.index())?;
        let total = accessor.count.0.saturating_mul(format.element_bytes());
        let held = self.outside.take(total, place, format!("elements of accessor {}", index.0))?;
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
        Ok(DenseElements { format, bytes, _held: held })
    }

    /// Place of the elements; `None` for an accessor of zeros.
    fn source(&self, accessor: &GltfAccessor, i: usize, format: ElementFormat) -> Result<Option<ElementSpan>, SceneError> {
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
        self.span(view, accessor.byte_offset, count, [stride, format.used_bytes()], &place).map(Some)
    }

    /// The part of a buffer view that holds `count` elements, checked against the view's length.
    fn span(
        &self,
        view: GltfInteger,
        offset: GltfInteger,
        count: u64,
        [stride, element]: [u64; 2],
        place: &str,
    ) -> Result<ElementSpan, SceneError> {
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
        Ok(ElementSpan { view, start: offset.index(), count: GltfInteger(count).index(), stride, element })
    }

    /// Returns the elements of a range in order.
    fn elements(&self, span: &ElementSpan) -> Result<impl Iterator<Item = &[u8]> + use<'_>, SceneError> {
        let bytes = self.buffers.view(self.document, span.view, String::new)?;
        let ElementSpan { start, count, stride, element, .. } = *span;
        Ok((0..count).filter_map(move |i| bytes.get(start + i * stride..start + i * stride + element)))
    }

    /// Returns the ranges of the indices and of the values of a sparse accessor.
    fn sparse_sources(
        &self,
        sparse: &SparseAccessor,
        i: usize,
        format: ElementFormat,
    ) -> Result<(ComponentType, ElementSpan, ElementSpan), SceneError> {
        let place = |part: &str| format!("/accessors/{i}/sparse/{part}");
        let component = ComponentType::parse(sparse.indices.component_type, || place("indices/componentType"))?;
        if !matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            return Err(SceneError::at(place("indices/componentType"), component.name()).expected("an unsigned type"));
        }
        let (count, at) = (sparse.count.0, &sparse.indices);
        let indices = self.span(at.buffer_view, at.byte_offset, count, [component.bytes(); 2], &place("indices"))?;
        let at = &sparse.values;
        let values =
            self.span(at.buffer_view, at.byte_offset, count, [format.element_bytes(), format.used_bytes()], &place("values"))?;
        Ok((component, indices, values))
    }

    fn replace(&self, sparse: &SparseAccessor, i: usize, format: ElementFormat, bytes: &mut [u8]) -> Result<(), SceneError> {
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

/// Range of elements in a buffer view, checked against its length \[bytes\].
struct ElementSpan {
    view: GltfInteger,
    start: usize,
    count: usize,
    stride: usize,
    element: usize,
}
