//! Properties of each pixel other than its cycles.

use crate::analysis::attribution::TokenOrigin;
use basrelief_input::{MemoryReservation, OverBudget};

/// Marks an unknown polygon or table entry.
const NONE: u32 = u32::MAX;
/// Marks an unknown level.
const NO_LEVEL: u8 = u8::MAX;
/// Memory per pixel \[bytes\].
const PIXEL_BYTES: u64 = 13;

/// Fragments, polygon, level and table entry of each pixel, row by row; empty until the first frame begins.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct PixelRecords {
    pub(super) size: [u32; 2],
    overdraw: Vec<u32>,
    polygons: Vec<u32>,
    levels: Vec<u8>,
    entries: Vec<u32>,
}

impl PixelRecords {
    /// Begins a frame. The first frame determines the size.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    pub(super) fn set_size(&mut self, size: [u32; 2], held: &mut MemoryReservation) -> Result<(), OverBudget> {
        if !self.overdraw.is_empty() {
            return Ok(());
        }
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        held.try_grow(PIXEL_BYTES * pixels, "records of pixels")?;
        let pixels = pixels as usize;
        self.size = size;
        (self.overdraw, self.polygons) = (vec![0; pixels], vec![NONE; pixels]);
        (self.levels, self.entries) = (vec![NO_LEVEL; pixels], vec![NONE; pixels]);
        Ok(())
    }

    /// Returns the index of a pixel; `None` outside of the picture.
    #[inline]
    pub(super) fn index_of(&self, [x, y]: [u16; 2]) -> Option<usize> {
        let [width, height] = self.size;
        let (x, y) = (u32::from(x), u32::from(y));
        (x < width && y < height).then(|| y as usize * width as usize + x as usize)
    }

    /// Returns the indices of an origin's pixels within the picture.
    pub(super) fn indices(&self, origin: &TokenOrigin) -> impl Iterator<Item = usize> {
        origin.pixels.into_iter().flat_map(|pixels| pixels.places()).filter_map(|(_, at)| self.index_of(at))
    }

    /// Counts fragments.
    pub(super) fn count_fragments(&mut self, origin: &TokenOrigin) {
        self.for_each_pixel(origin, |drawing, _, place| drawing.overdraw[place] += 1);
    }

    /// Records the polygon of finished pixels. Later pixels replace earlier ones.
    pub(super) fn record_polygon(&mut self, origin: &TokenOrigin) {
        let polygon = origin.polygon.map_or(NONE, |polygon| polygon.run as u32);
        self.for_each_pixel(origin, |drawing, _, place| drawing.polygons[place] = polygon);
    }

    /// Records the level and the table entry of pixels.
    pub(super) fn record_level_and_entry(&mut self, origin: &TokenOrigin) {
        if let Some(levels) = origin.levels {
            self.for_each_pixel(origin, |drawing, at, place| drawing.levels[place] = (levels >> (4 * at) & 15) as u8);
        }
        if let Some(entries) = origin.pixels.and_then(|pixels| pixels.entries) {
            self.for_each_pixel(origin, |drawing, at, place| drawing.entries[place] = entries[at % entries.len()].into());
        }
    }

    fn for_each_pixel(&mut self, origin: &TokenOrigin, note: impl Fn(&mut Self, usize, usize)) {
        for (at, pixel) in origin.pixels.iter().flat_map(|pixels| pixels.places()) {
            if let Some(place) = self.index_of(pixel) {
                note(self, at, place);
            }
        }
    }

    pub(super) fn overdraw(&self, place: usize) -> u32 {
        self.overdraw.get(place).copied().unwrap_or_default()
    }

    pub(super) fn level(&self, place: usize) -> Option<u8> {
        self.levels.get(place).copied().filter(|level| *level != NO_LEVEL)
    }

    pub(super) fn entry(&self, place: usize) -> Option<u32> {
        self.entries.get(place).copied().filter(|entry| *entry != NONE)
    }

    pub(super) fn polygon(&self, place: usize) -> Option<usize> {
        self.polygons.get(place).filter(|polygon| **polygon != NONE).map(|polygon| *polygon as usize)
    }
}
