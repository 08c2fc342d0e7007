//! Operators of identification (461) and of the final rasterization (463, 472).

use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{HardwareKind, OperatorCounts};

/// Coordinates in steps of 2^-8 texels of a layer \[bits\].
const COORDINATE: u32 = 32;
/// Number of a tile, or address \[bits\].
const ADDRESS: u32 = 32;
/// Colour times a weight \[bits\].
const COLOUR: u32 = 16;

/// Arithmetic of wrapping a pixel's coordinates into its texture: two products and a difference along each axis, and its borders.
const PLACE: OperatorCounts = OperatorCounts { multiply: 4, add: 2 + 4, ..OperatorCounts::NONE };
/// Arithmetic of the texels of a sample in a layer, whose scale is a shift, and of their tiles: half a texel, the neighbour and
/// two borders along each axis; Tr * W + Sr + B, and the three tiles beside it.
const FIND: OperatorCounts = OperatorCounts { multiply: 1, add: 8 + 2 + 3, ..OperatorCounts::NONE };
/// Arithmetic of a bilinear interpolation of R, G, B: three times a difference, a product and a sum.
const BILINEAR: OperatorCounts = OperatorCounts { multiply: 9, add: 18, ..OperatorCounts::NONE };
/// Arithmetic of an interpolation between two layers.
const BETWEEN: OperatorCounts = OperatorCounts { multiply: 3, add: 6, ..OperatorCounts::NONE };
/// Arithmetic of the brightness coefficients, rounded.
const SHADE: OperatorCounts = OperatorCounts { multiply: 3, add: 3, ..OperatorCounts::NONE };

/// Reports the hardware that finds the tiles of `rate` layers per cycle.
pub(crate) fn tell_find(rate: u32, stats: &mut UnitStats) {
    let work = PLACE.and(FIND).times(rate);
    stats.hardware(HardwareKind::Multiplier, "texels and tiles of a layer", work.multiply, COORDINATE);
    stats.hardware(HardwareKind::Adder, "texels and tiles of a layer", work.add, ADDRESS);
}

/// Reports the hardware of `rate` interpolations per cycle.
pub(crate) fn tell_interpolate(rate: u32, stats: &mut UnitStats) {
    let work = BILINEAR.and(BETWEEN).and(SHADE).times(rate);
    stats.hardware(HardwareKind::Multiplier, "interpolation in and between layers, brightness", work.multiply, COLOUR);
    stats.hardware(HardwareKind::Adder, "interpolation in and between layers, brightness", work.add, COLOUR);
}

/// Reports the hardware that averages `rate` texels per cycle: R, G, B of four texels, rounded.
pub(crate) fn tell_average(rate: u32, stats: &mut UnitStats) {
    stats.hardware(HardwareKind::Adder, "averages of four texels", 3 * 4 * rate, COLOUR);
}

/// Reports the hardware that collects the marks of a block: the distance to the centre of the screen, and one comparator per mark
/// side by side.
pub(crate) fn tell_marks(sizes: crate::TableSizes, stats: &mut UnitStats) {
    stats.hardware(HardwareKind::Multiplier, "distance to the centre", 2_u32, COLOUR);
    stats.hardware(HardwareKind::Adder, "distance to the centre, equal marks", 3_u32 + 4, ADDRESS);
    stats.hardware(HardwareKind::Registers, "marks of a block", 4_u32, sizes.tile_bits() + 5);
}
