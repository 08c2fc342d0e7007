//! Coefficients of the area.

#[cfg(not(feature = "config"))]
use crate::plain_parameters::parameters;
#[cfg(feature = "config")]
use basrelief_parameters::parameters;

parameters! {
    /// Coefficients of the area. They change nothing but the cost. `tools/area` measures them with yosys 0.23 in generic gates;
    /// libraries of cells come to 0.85 to 0.97 of them.
    pub struct AreaConfig {
        /// Fixed-point multiplier of w by v bits, w >= v: times w (v - 1) - 0.39 v.
        multiplier: f64 = 10.7, unit: "GE", Derived("yosys 0.23, 21 points, at most 8 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Fixed-point adder of w bits: times w - 0.72.
        adder: f64 = 8.3, unit: "GE", Derived("yosys 0.23, 16 points, at most 7 % off"), range: 0.0..=1000.0, effect: Cost;
        /// The larger of two values of w bits, with its index: times w.
        larger: f64 = 9.2, unit: "GE", Derived("yosys 0.23, 5 trees, at most 3 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Fixed-point dot product of three components of w bits: times w^2 + 0.37 w.
        inner_product: f64 = 33.1, unit: "GE", Derived("yosys 0.23, 3 points, at most 1 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Floating-point multiplier with a mantissa of m bits: times m^2 - 0.53 m.
        float_multiplier: f64 = 9.25, unit: "GE", Derived("yosys 0.23, 3 points, within 0.5 %"), range: 0.0..=1000.0, effect: Cost;
        /// Floating-point adder with a mantissa of m bits: times m + 0.075 m log2 m.
        float_adder: f64 = 46.4, unit: "GE", Derived("yosys 0.23, 3 points, within 0.5 %"), range: 0.0..=1000.0, effect: Cost;
        /// Divider of w bits, k bits of the quotient per cycle: times w (k + 2.38).
        divider: f64 = 13.8, unit: "GE", Derived("yosys 0.23, 16 points, at most 9 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Square root of w bits, k bits of the root per cycle: times 2 w (k + 5.35).
        square_root: f64 = 4.6, unit: "GE", Derived("yosys 0.23, 12 points, at most 3 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Power unit of 16 bits that starts in every cycle. Other widths w: times (w / 16)^2, which is assumed. Iterative, k digits
        /// of a product per cycle: times 0.476 + 0.472 k / w, at most 1.
        power: f64 = 5000.0, unit: "GE", Derived("yosys 0.23, tables of 64 entries; iterative, 5 points, at most 2 % off"), range: 0.0..=1e6, effect: Cost;
        /// Flip-flop between stages.
        flip_flop: f64 = 5.67, unit: "GE/bit", Derived("yosys 0.23, exact; 4.0 in the cells of osu035"), range: 0.0..=1000.0, effect: Cost;
        /// Flip-flop with enable: a register that keeps its value.
        register: f64 = 8.0, unit: "GE/bit", Derived("yosys 0.23, exact"), range: 0.0..=1000.0, effect: Cost;
        /// Words in flip-flops with r read ports: times 1 + 0.27 r.
        word_bit: f64 = 8.4, unit: "GE/bit", Derived("yosys 0.23, 27 points, at most 13 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Control of a FIFO of d slots, or of d credits: times log2 d + 0.42.
        fifo_control: f64 = 52.6, unit: "GE", Derived("yosys 0.23, 8 points, at most 4 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Comparison of a tag with those of a set.
        tag: f64 = 4.85, unit: "GE/bit", Derived("yosys 0.23, 18 points, at most 8 % off; libraries differ by 40 %"), range: 0.0..=1000.0, effect: Cost;
        /// Order of use of n ways: times n (log2 n - 0.89).
        order_of_use: f64 = 17.0, unit: "GE", Derived("yosys 0.23, 4 points, at most 11 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Choice among n words: times n - 1.
        multiplexer: f64 = 2.5, unit: "GE/bit", Derived("yosys 0.23, 12 points, at most 16 % off"), range: 0.0..=1000.0, effect: Cost;
        /// Search of the first set flag of n: times n - 2.1.
        first_set: f64 = 3.3, unit: "GE", Derived("yosys 0.23, 5 points, at most 4 % off"), range: 0.0..=1000.0, effect: Cost;
        /// SRAM macro of 2,048 bits or more, per bit and port.
        memory_bit: f64 = 1.4, unit: "GE/bit", Assumed("published layouts and area models span 0.6 to 2.5; it moves totals most"), range: 0.0..=1000.0, effect: Cost;
        /// SRAM macro, per port, besides its bits.
        memory_macro: f64 = 450.0, unit: "GE", Assumed("overhead of 195 register bits (Mulder, Quach, Flynn 1991), 2.3 GE each"), range: 0.0..=1e6, effect: Cost;
        /// Length of a transistor's gate, which gives the delay of a gate.
        gate_length: f64 = 0.25, unit: "um", Assumed("each machine has its own"), range: 0.001..=100.0, effect: Cost;
        /// FO4: delay of an inverter that drives four, per length of the gate.
        fo4_ps: f64 = 400.0, unit: "ps/um", Assumed("typical corner of processes from 1 um to 90 nm"), range: 1.0..=10000.0, effect: Cost;
    }
}
