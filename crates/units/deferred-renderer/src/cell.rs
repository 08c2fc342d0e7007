//! Cell of the reference buffer (126), Figures 3A and 3B, and the number formats of its fields.

use crate::config::{CellConfig, NumberFormat};
use crate::page::TexturePage;
use basrelief_signals::WrapMode;
use serde::{Deserialize, Serialize};

/// Contents of a pixel of the reference buffer (126). Its numbers are exactly representable in its fields.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceCell {
    /// Texture page pointer (310), or one of the two constants below.
    page: u16,
    /// Brightness coefficients IR IG IB (316), or R G B (303) in steps of 1 / 255.
    coefficients: [u16; 3],
    /// Texture coordinates S, T (312) \[texels of the finest layer\].
    pub coordinates: [f32; 2],
    /// Layer depth D (314).
    pub depth: f32,
    /// Wrap modes of the coordinates, in u and in v.
    pub wrap: [WrapMode; 2],
}

/// Page pointer of an empty cell.
const EMPTY: u16 = u16::MAX;
/// Page pointer of a direct colour: field (301) is 0.
const DIRECT: u16 = u16::MAX - 1;

impl Default for ReferenceCell {
    fn default() -> Self {
        Self { page: EMPTY, coefficients: [0; 3], coordinates: [0.0; 2], depth: 0.0, wrap: [WrapMode::Repeat; 2] }
    }
}

impl ReferenceCell {
    /// Creates the cell of Figure 3A: direct colour, already multiplied by its brightness.
    #[inline]
    pub fn direct(rgb: [u8; 3]) -> Self {
        Self { page: DIRECT, coefficients: rgb.map(u16::from), ..Self::default() }
    }

    /// Creates the cell of Figure 3B: a textured pixel whose texture repeats.
    #[inline]
    pub fn textured(page: u16, coordinates: [f32; 2], depth: f32, coefficients: [u16; 3]) -> Self {
        Self { page, coefficients, coordinates, depth, ..Self::default() }
    }

    /// Returns the same cell with these wrap modes.
    #[inline]
    #[must_use]
    pub fn wrapped(self, wrap: [WrapMode; 2]) -> Self {
        Self { wrap, ..self }
    }

    /// Returns true unless the cell is empty.
    #[inline]
    pub fn is_drawn(&self) -> bool {
        self.page != EMPTY
    }

    /// Returns the texture page pointer (310) of a textured pixel.
    #[inline]
    pub fn page(&self) -> Option<u16> {
        (self.page < DIRECT).then_some(self.page)
    }

    /// Returns the bits of the page pointer (310), with the constants of an empty and of a direct cell.
    pub(crate) fn page_field(&self) -> u16 {
        self.page
    }

    /// Returns R G B (303), which is defined only for cells without a page.
    #[inline]
    pub fn rgb(&self) -> [u8; 3] {
        self.coefficients.map(|c| c as u8)
    }

    /// Returns the stored brightness coefficients IR IG IB (316).
    #[inline]
    pub fn coefficients(&self) -> [u16; 3] {
        self.coefficients
    }
}

/// Returns the number of pages that a cell can point to.
pub fn most_pages(bits: u32) -> usize {
    (1usize << bits.min(16)).min(usize::from(DIRECT))
}

/// Precomputed formats of the fields.
#[derive(Clone, Debug)]
pub struct CellFormat {
    coordinate: FieldRounding,
    depth: FieldRounding,
    /// Largest stored coefficient.
    full: f32,
    /// Brightness that the largest coefficient represents.
    pub range: f32,
    /// Bytes of a cell in memory.
    pub bytes: u32,
}

/// Rounding of a number to its field.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FieldRounding {
    /// Fixed point: steps per unit, and largest magnitude.
    Fixed(f64, f64),
    /// Floating point: dropped bits of the fraction of single precision.
    Float(u32),
}

impl FieldRounding {
    fn new(format: NumberFormat, bits: u32, fraction_bits: u32) -> Self {
        match format {
            NumberFormat::Fixed => {
                let steps = (1u64 << fraction_bits.min(bits)) as f64;
                Self::Fixed(steps, (1u64 << (bits - 1)) as f64 / steps - 1.0 / steps)
            }
            // Sign and exponent take 9 bits.
            NumberFormat::Float => Self::Float(32 - bits.clamp(10, 32)),
        }
    }

    /// Returns true unless the number is larger than the field can hold.
    #[inline]
    fn holds(self, value: f32) -> bool {
        match self {
            Self::Float(_) => true,
            Self::Fixed(_, most) => f64::from(value).abs() <= most,
        }
    }

    /// Returns the nearest number that the field can hold. NaN becomes 0.
    #[inline]
    fn apply(self, value: f32) -> f32 {
        match self {
            Self::Float(0) if value.is_finite() => value,
            Self::Float(lost) => {
                let half = if lost == 0 { 0 } else { 1u32 << (lost - 1) };
                let rounded = f32::from_bits((value.to_bits().wrapping_add(half)) >> lost << lost);
                if rounded.is_finite() { rounded } else { 0.0 }
            }
            Self::Fixed(steps, most) => {
                let scaled = f64::from(value).clamp(-most, most) * steps;
                let whole = (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i64;
                (whole as f64 / steps) as f32
            }
        }
    }
}

impl CellFormat {
    /// Creates the formats of a configuration. `range` is the brightness that a full coefficient represents.
    pub fn new(config: &CellConfig, range: f32) -> Self {
        let c = config;
        Self {
            coordinate: FieldRounding::new(c.coordinate_format, c.coordinate_bits, c.coordinate_fraction_bits),
            depth: FieldRounding::new(c.depth_format, c.depth_bits, c.depth_fraction_bits),
            full: ((1u32 << c.brightness_bits) - 1) as f32,
            range,
            bytes: c.bits().div_ceil(8),
        }
    }

    /// Returns true unless texture coordinates are larger than their fields can hold.
    #[inline]
    pub fn holds(&self, st: [f32; 2]) -> bool {
        st.into_iter().all(|s| self.coordinate.holds(s))
    }

    /// Creates the cell of a textured pixel: coordinates \[texels of the finest layer\], layer depth, brightness per channel.
    #[inline]
    pub fn textured(&self, page: &TexturePage, st: [f32; 2], depth: f32, brightness: [f32; 3]) -> ReferenceCell {
        let scale = self.full / self.range;
        let stored = brightness.map(|b| (b * scale + 0.5).clamp(0.0, self.full) as u16);
        let depth = self.depth.apply(depth).clamp(0.0, f32::from(page.dmax()));
        ReferenceCell::textured(page.number, st.map(|s| self.coordinate.apply(s)), depth, stored)
    }

    /// Returns the factor of a texel per channel.
    #[inline]
    pub fn brightness(&self, cell: &ReferenceCell) -> [f32; 3] {
        let scale = self.range / self.full;
        cell.coefficients.map(|c| f32::from(c) * scale)
    }
}

/// Computes D = Dmax - log2(rho), limited to 0 ..= Dmax. rho is the longer axis of the pixel's footprint \[finest texels\],
/// passed as its square.
#[inline]
pub fn layer_depth(dmax: u8, rho_squared: f32) -> f32 {
    let dmax = f32::from(dmax);
    if rho_squared > 0.0 { (dmax - 0.5 * libm::log2f(rho_squared)).clamp(0.0, dmax) } else { dmax }
}

/// Splits the layer depth into D_L = floor(D) and D_f. At Dmax and beyond no finer layer exists, so D_f = 0.
#[inline]
pub fn split_depth(depth: f32, dmax: u8) -> (u8, f32) {
    if depth >= f32::from(dmax) {
        return (dmax, 0.0);
    }
    let coarse = depth.max(0.0) as u8;
    (coarse, depth.max(0.0) - f32::from(coarse))
}
