//! Formulas of blocks, fitted to measurements by `tools/area/fit.py`. Widths are in bits, results in GE or FO4.

use super::AreaConfig;
use crate::hardware::{Hardware, OperandFormat};

/// Floating-point multiplication, 24-bit mantissa.
pub(super) const FLOAT_MULTIPLIER_FO4: f64 = 97.0;
/// Floating-point addition, 24-bit mantissa.
pub(super) const FLOAT_ADDER_FO4: f64 = 105.0;
/// Comparison of 34 bits, and choice of the larger value.
pub(super) const LARGER_FO4: f64 = 23.0;
/// Comparison of a tag with all ways.
pub(super) const TAG_FO4: f64 = 17.0;
/// One bit of a quotient: 30, 47, 94 and 186 for 1, 2, 4 and 8 bits of 24. A bit of a root is assumed to take as long.
pub(super) const QUOTIENT_BIT_FO4: f64 = 186.0 / 8.0;
/// Products of a power.
const POWER_PRODUCTS: u32 = 3;
/// Index that passes a comparator with the larger value \[bits\].
pub(super) const INDEX_BITS: u32 = 6;

/// Returns ceil(log2 n), at least 1.
fn log2(n: u64) -> f64 {
    f64::from(n.max(2).saturating_sub(1).ilog2() + 1)
}

pub(super) fn multiplier(area: &AreaConfig, width: u32, by: u32) -> f64 {
    let [wide, narrow] = [width.max(by), width.min(by)].map(f64::from);
    // A factor of one bit needs an AND gate per bit.
    (area.multiplier * (wide * (narrow - 1.0) - 0.39 * narrow)).max(1.33 * wide)
}

/// 69, 87 and 110 FO4 were measured for 16, 24 and 32 bits.
pub(super) fn multiplier_fo4(width: u32, by: u32) -> f64 {
    28.0 + 2.56 * f64::from(width.midpoint(by))
}

pub(super) fn float_multiplier(area: &AreaConfig) -> f64 {
    let m = f64::from(OperandFormat::MANTISSA);
    area.float_multiplier * (m * m - 0.53 * m)
}

pub(super) fn adder(area: &AreaConfig, width: u32) -> f64 {
    area.adder * (f64::from(width) - 0.72)
}

/// 42 FO4 were measured for 32 bits.
pub(super) fn adder_fo4(width: u32) -> f64 {
    42.0 / 32.0 * f64::from(width)
}

pub(super) fn float_adder(area: &AreaConfig) -> f64 {
    let m = f64::from(OperandFormat::MANTISSA);
    area.float_adder * (m + 0.075 * m * log2(OperandFormat::MANTISSA.into()))
}

pub(super) fn inner_product(area: &AreaConfig, width: u32) -> f64 {
    let w = f64::from(width);
    area.inner_product * (w * w + 0.37 * w)
}

pub(super) fn divider(area: &AreaConfig, width: u32, bits_per_cycle: f64) -> f64 {
    area.divider * f64::from(width) * (bits_per_cycle + 2.38)
}

pub(super) fn square_root(area: &AreaConfig, width: u32, bits_per_cycle: f64) -> f64 {
    area.square_root * 2.0 * f64::from(width) * (bits_per_cycle + 5.35)
}

/// Returns the area of a power unit of `width` bits that starts an operation every `interval` cycles.
///
/// An operation has three products of `width` digits: the slope of the table of logarithms, the exponent, and the slope of the table
/// of powers of two. In a unit that starts in every cycle, each product has a multiplier of its own. In a slower unit, the products
/// take turns in one multiplier, which adds `3 width / interval` digits per cycle, rounded up. Both units were measured at 16 bits
/// (`power` and `power_seq` in `tools/area`); the slower one needs 2,378 GE and 147 GE for each digit per cycle. A unit with many
/// digits per cycle is never larger than one that starts in every cycle. (Assumed: the tables, the registers and the multiplier of
/// other widths grow as the whole unit.)
pub(super) fn power(area: &AreaConfig, width: u32, interval: u32) -> f64 {
    let scale = f64::from(width) / 16.0;
    let digits = f64::from(width.saturating_mul(POWER_PRODUCTS).div_ceil(interval.max(1)));
    let share = if interval > 1 { 0.476 + 0.472 * digits / f64::from(width.max(1)) } else { 1.0 };
    area.power * scale * scale * share.min(1.0)
}

pub(super) fn fifo_control(area: &AreaConfig, depth: u64) -> f64 {
    area.fifo_control * (log2(depth) + 0.42)
}

/// Multiplexers for both operands of operators whose operations take turns.
pub(super) fn operand_choice(area: &AreaConfig, piece: &Hardware) -> f64 {
    let bits = f64::from(piece.width) + f64::from(piece.by);
    area.multiplexer * bits * f64::from(piece.turns.saturating_sub(1)) * piece.count as f64
}

/// Choice of an entry of a word at each port, and the circuit that finds the first entry that is set. Assumed: the decoder of a port that
/// writes an entry is as large as the multiplexer of a port that reads it.
pub(super) fn entry_choice(area: &AreaConfig, piece: &Hardware) -> f64 {
    let entries = f64::from(piece.entries);
    let choice = area.multiplexer * f64::from(piece.width) * (1.0 - 1.0 / entries.max(1.0));
    let search = if piece.finds_first { area.first_set * (entries - 2.1).max(0.0) } else { 0.0 };
    let chosen = if piece.entries > 0 { choice * f64::from(piece.ports) } else { 0.0 };
    (chosen + search) * f64::from(piece.banks)
}

/// Comparison of a tag with those of all ways, order of use, and choice of the word.
pub(super) fn tag_comparator(area: &AreaConfig, ways: u32, tag_bits: u32) -> f64 {
    let n = f64::from(ways);
    let order = if ways > 1 { area.order_of_use * n * (log2(ways.into()) - 0.89) } else { 0.0 };
    area.tag * n * f64::from(tag_bits) + order + area.multiplexer * f64::from(crate::hardware::WORD_BITS) * (n - 1.0)
}

/// A bit of words in flip-flops with one write port.
pub(super) fn word_bit(area: &AreaConfig, read_ports: u32) -> f64 {
    area.word_bit * (1.0 + 0.27 * f64::from(read_ports))
}

pub(super) fn memory_macro(area: &AreaConfig, bits: u64, ports: u32) -> f64 {
    (area.memory_bit * bits as f64 + area.memory_macro) * f64::from(ports.max(1))
}
