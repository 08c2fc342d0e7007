//! Area of hardware in gate equivalents (1 GE is one NAND2), and its delay per cycle in FO4 (delays of an inverter that drives four).
//!
//! The coefficients are parameters, see [`AreaConfig`]. `tools/area` measures them.
//!
//! # Limits
//!
//! - Wires, clock trees, pads, test logic and the control logic of units have no area.
//! - Delays of powers, of memory macros, of the choice in a word and of wires are not known.

mod blocks;
mod config;

use crate::hardware::{Hardware, HardwareKind, OperandFormat};
use crate::{OperatorConfig, Operators};
pub use config::AreaConfig;

/// Size of the smallest memory macro \[bits\].
const LEAST_MACRO_BITS: u64 = 2048;
/// Words of the smallest memory macro.
const LEAST_MACRO_WORDS: u64 = 16;
/// Bits of a word that is read in pieces, so that a macro may hold a single one. A word of entries is read as a whole.
const WIDE_WORD_BITS: u32 = 4096;

/// Everything that the area of a piece of hardware depends on, besides the piece.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaModel {
    /// Coefficients.
    pub area: AreaConfig,
    /// Latencies and intervals of operators, for pipeline registers and for bits of a quotient per cycle.
    pub operators: Operators,
    /// Clock \[Hz\].
    pub hz: u64,
}

/// Area of equal pieces of hardware.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Area {
    /// Logic \[GE\].
    pub logic_ge: f64,
    /// Flip-flops: registers, pipeline registers, and words of small tables and FIFOs \[bits\].
    pub register_bits: u64,
    /// Memory macros \[bits\].
    pub memory_bits: u64,
    /// Logic, flip-flops and memory macros together \[GE\].
    pub area_ge: f64,
    /// Largest delay of a cycle \[FO4\]; 0 if it is not known or not in question.
    pub depth_fo4: f64,
}

impl Area {
    fn add_logic(&mut self, ge: f64) {
        self.logic_ge += ge;
        self.area_ge += ge;
    }

    fn add_registers(&mut self, bits: u64, ge_per_bit: f64) {
        self.register_bits = self.register_bits.saturating_add(bits);
        self.area_ge += bits as f64 * ge_per_bit;
    }
}

/// One operator with its timing.
struct Operator<'a> {
    piece: &'a Hardware,
    timing: &'a OperatorConfig,
    /// Width of a number, without exponent and sign if it is floating.
    digits: u32,
}

impl Operator<'_> {
    /// Results of this width that are in flight in all pieces \[bits\]. An iterative operator has none.
    fn stages(&self, result_bits: u32) -> u64 {
        let stages = if self.timing.interval == 1 { self.timing.latency } else { 0 };
        self.piece.count.saturating_mul(u64::from(stages) * u64::from(result_bits))
    }

    /// Digits that an iterative operator computes at once, if it starts every `cycles` cycles.
    fn digits_in(&self, cycles: u32) -> f64 {
        let rate =
            if self.piece.digits_per_cycle > 0 { self.piece.digits_per_cycle } else { self.digits.div_ceil(cycles.max(1)) };
        f64::from(rate)
    }

    fn per_stage(&self, depth_fo4: f64) -> f64 {
        depth_fo4 / f64::from(self.timing.latency.max(1))
    }
}

impl AreaModel {
    /// Returns the cycle time \[FO4\].
    pub fn cycle_fo4(&self) -> f64 {
        1e12 / (self.hz.max(1) as f64 * self.area.fo4_ps * self.area.gate_length)
    }

    /// Returns the area of equal pieces.
    pub fn of(&self, piece: &Hardware) -> Area {
        let mut area = Area::default();
        let timing = &self.operators;
        let operator = |timing| {
            let digits = if piece.format == OperandFormat::Single { OperandFormat::MANTISSA } else { piece.width };
            Operator { piece, timing, digits }
        };
        let (multiply, add) =
            if piece.integer { (&timing.integer_multiply, &timing.integer_add) } else { (&timing.multiply, &timing.add) };
        if piece.kind.computes() {
            area.add_logic(blocks::operand_choice(&self.area, piece));
        }
        match piece.kind {
            HardwareKind::Multiplier => self.multiplier(&operator(multiply), &mut area),
            HardwareKind::Adder | HardwareKind::Comparator => self.adder(&operator(add), &mut area),
            HardwareKind::InnerProduct => self.inner_product(&operator(multiply), &operator(add), &mut area),
            HardwareKind::Divider => self.iteration(&operator(&timing.divide), &mut area),
            HardwareKind::SquareRoot => self.iteration(&operator(&timing.square_root), &mut area),
            HardwareKind::Power => self.power(&operator(&timing.power), &mut area),
            HardwareKind::TagComparator => self.tag_comparator(piece, &mut area),
            HardwareKind::Registers => {
                area.add_registers(piece.bits(), self.area.register);
            }
            HardwareKind::Table | HardwareKind::CacheData | HardwareKind::CacheTags | HardwareKind::LineBuffer => {
                self.store(piece, &mut area);
            }
            HardwareKind::Fifo | HardwareKind::RequestTable => {
                area.add_logic(blocks::fifo_control(&self.area, piece.count));
                area.add_registers(u64::from(piece.stages) * u64::from(piece.width), self.area.flip_flop);
                self.store(piece, &mut area);
            }
        }
        area
    }

    fn multiplier(&self, of: &Operator<'_>, area: &mut Area) {
        let Hardware { count, width, by, format, .. } = *of.piece;
        let (ge, depth, result) = match format {
            OperandFormat::Fixed => {
                (blocks::multiplier(&self.area, width, by), blocks::multiplier_fo4(width, by), width.saturating_add(by))
            }
            OperandFormat::Single => (blocks::float_multiplier(&self.area), blocks::FLOAT_MULTIPLIER_FO4, width),
        };
        area.add_logic(count as f64 * ge);
        area.add_registers(of.stages(result), self.area.flip_flop);
        area.depth_fo4 = of.per_stage(depth);
    }

    fn adder(&self, of: &Operator<'_>, area: &mut Area) {
        let Hardware { kind, count, width, format, .. } = *of.piece;
        let (ge, depth, result) = match (kind, format) {
            (HardwareKind::Comparator, _) => {
                (self.area.larger * f64::from(width), blocks::LARGER_FO4, width + blocks::INDEX_BITS)
            }
            (_, OperandFormat::Single) => (blocks::float_adder(&self.area), blocks::FLOAT_ADDER_FO4, width + 1),
            (_, OperandFormat::Fixed) => (blocks::adder(&self.area, width), blocks::adder_fo4(width), width + 1),
        };
        area.add_logic(count as f64 * ge);
        area.add_registers(of.stages(result), self.area.flip_flop);
        area.depth_fo4 = of.per_stage(depth);
    }

    /// Three products and two sums. The third product waits for the sum of the others.
    fn inner_product(&self, multiply: &Operator<'_>, add: &Operator<'_>, area: &mut Area) {
        let Hardware { count, width, format, .. } = *multiply.piece;
        let (ge, product, sums, depths) = match format {
            OperandFormat::Fixed => (
                blocks::inner_product(&self.area, width),
                2 * width,
                [2 * width + 1, 2 * width + 2],
                [blocks::multiplier_fo4(width, width), blocks::adder_fo4(2 * width)],
            ),
            OperandFormat::Single => (
                3.0 * blocks::float_multiplier(&self.area) + 2.0 * blocks::float_adder(&self.area),
                width,
                [width, width],
                [blocks::FLOAT_MULTIPLIER_FO4, blocks::FLOAT_ADDER_FO4],
            ),
        };
        area.add_logic(count as f64 * ge);
        let products = 3 * multiply.stages(product) + add.stages(product);
        area.add_registers(sums.into_iter().fold(products, |bits, sum| bits + add.stages(sum)), self.area.flip_flop);
        area.depth_fo4 = multiply.per_stage(depths[0]).max(add.per_stage(depths[1]));
    }

    /// A divider, or a square root, whose radicand has two bits for each of its own.
    fn iteration(&self, of: &Operator<'_>, area: &mut Area) {
        let (timing, digits) = (of.timing, of.digits);
        let rate = of.digits_in(timing.interval);
        let ge = match of.piece.kind {
            HardwareKind::Divider => blocks::divider(&self.area, digits, rate),
            _ => blocks::square_root(&self.area, digits, rate),
        };
        area.add_logic(of.piece.count as f64 * ge);
        let is_pipelined = of.piece.digits_per_cycle == 0;
        area.add_registers(if is_pipelined { of.stages(3 * digits) } else { 0 }, self.area.flip_flop);
        area.depth_fo4 = of.digits_in(timing.latency) * blocks::QUOTIENT_BIT_FO4;
    }

    /// A logarithm, a product and an exponential. Its delay was not measured.
    fn power(&self, of: &Operator<'_>, area: &mut Area) {
        let ge = blocks::power(&self.area, of.digits, of.timing.interval);
        area.add_logic(of.piece.count as f64 * ge);
        area.add_registers(of.stages(of.piece.width), self.area.flip_flop);
    }

    /// `width` bits of a tag in each of `by` ways.
    fn tag_comparator(&self, piece: &Hardware, area: &mut Area) {
        area.add_logic(piece.count as f64 * blocks::tag_comparator(&self.area, piece.by, piece.width));
        area.depth_fo4 = blocks::TAG_FO4;
    }

    /// Words in flip-flops, or in the smallest macros that hold them if these are smaller.
    fn store(&self, piece: &Hardware, area: &mut Area) {
        area.add_logic(blocks::entry_choice(&self.area, piece));
        let Hardware { count, width, banks, ports, .. } = *piece;
        let words = count.div_ceil(u64::from(banks.max(1)));
        let in_pieces = width >= WIDE_WORD_BITS && piece.entries == 0;
        let least_words = if in_pieces { 1 } else { LEAST_MACRO_WORDS };
        let macro_bits = words.max(least_words).saturating_mul(u64::from(width)).max(LEAST_MACRO_BITS);
        let in_macros = blocks::memory_macro(&self.area, macro_bits, ports) * f64::from(banks);
        // A macro has one port for reading and writing, while a flip-flop has a write port of its own.
        let ge_per_bit = blocks::word_bit(&self.area, ports.saturating_sub(1).max(1));
        if in_macros < piece.bits() as f64 * ge_per_bit {
            area.memory_bits = area.memory_bits.saturating_add(piece.bits());
            area.area_ge += in_macros;
        } else {
            area.add_registers(piece.bits(), ge_per_bit);
        }
    }
}

#[cfg(test)]
mod tests;
