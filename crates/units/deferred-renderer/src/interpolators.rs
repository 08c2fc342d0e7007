//! Operators of identification (461) and of the final rasterization (463, 472).

use basrelief_kernel::facts::Facts;
use basrelief_kernel::{HardwareKind, Work};

/// Coordinates in steps of 2^-8 texels of a layer \[bits\].
const COORDINATE: u32 = 32;
/// Number of a tile, or address \[bits\].
const ADDRESS: u32 = 32;
/// Colour times a weight \[bits\].
const COLOUR: u32 = 16;

/// Arithmetic of wrapping a pixel's coordinates into its texture: two products and a difference along each axis, and its borders.
const PLACE: Work = Work { multiply: 4, add: 2 + 4, ..Work::NONE };
/// Arithmetic of the texels of a sample in a layer, whose scale is a shift, and of their tiles: half a texel, the neighbour and
/// two borders along each axis; Tr * W + Sr + B, and the three tiles beside it.
const FIND: Work = Work { multiply: 1, add: 8 + 2 + 3, ..Work::NONE };
/// Arithmetic of a bilinear interpolation of R, G, B: three times a difference, a product and a sum.
const BILINEAR: Work = Work { multiply: 9, add: 18, ..Work::NONE };
/// Arithmetic of an interpolation between two layers.
const BETWEEN: Work = Work { multiply: 3, add: 6, ..Work::NONE };
/// Arithmetic of the brightness coefficients, rounded.
const SHADE: Work = Work { multiply: 3, add: 3, ..Work::NONE };

/// Reports the hardware that finds the tiles of `rate` layers per cycle.
pub(crate) fn tell_find(rate: u32, facts: &mut Facts) {
    let work = PLACE.and(FIND).times(rate);
    facts.hardware(HardwareKind::Multiplier, "texels and tiles of a layer", work.multiply, COORDINATE);
    facts.hardware(HardwareKind::Adder, "texels and tiles of a layer", work.add, ADDRESS);
}

/// Reports the hardware of `rate` interpolations per cycle.
pub(crate) fn tell_interpolate(rate: u32, facts: &mut Facts) {
    let work = BILINEAR.and(BETWEEN).and(SHADE).times(rate);
    facts.hardware(HardwareKind::Multiplier, "interpolation in and between layers, brightness", work.multiply, COLOUR);
    facts.hardware(HardwareKind::Adder, "interpolation in and between layers, brightness", work.add, COLOUR);
}

/// Reports the hardware that averages `rate` texels per cycle: R, G, B of four texels, rounded.
pub(crate) fn tell_average(rate: u32, facts: &mut Facts) {
    facts.hardware(HardwareKind::Adder, "averages of four texels", 3 * 4 * rate, COLOUR);
}

/// Reports the hardware that collects the marks of a block: the distance to the centre of the screen, and one comparator per mark
/// side by side.
pub(crate) fn tell_marks(sizes: crate::Sizes, facts: &mut Facts) {
    facts.hardware(HardwareKind::Multiplier, "distance to the centre", 2_u32, COLOUR);
    facts.hardware(HardwareKind::Adder, "distance to the centre, equal marks", 3_u32 + 4, ADDRESS);
    facts.hardware(HardwareKind::Registers, "marks of a block", 4_u32, sizes.tile_bits() + 5);
}
