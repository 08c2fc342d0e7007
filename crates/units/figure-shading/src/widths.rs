//! How wide the device's signals are.

use crate::signals::{Dot, Finished, Highlight, Highlights, NormalLoad, Order, Signal as Dots};
use basrelief_signals::width::{CONTROL, COORDINATE, NUMBER};
use basrelief_signals::{Signal, Widths};

/// Place, depth, three brightnesses.
impl Signal for Dot {
    fn bits(widths: &Widths) -> u32 {
        2 * COORDINATE + widths.depth + 3 * NUMBER
    }
}

/// A dot, or control; two bits tell which.
impl Signal for Dots {
    fn bits(widths: &Widths) -> u32 {
        2 + Dot::bits(widths).max(CONTROL)
    }
}

/// Control: what is written, or the number of what stands in the registers of circuit (21).
impl Signal for Order {
    fn bits(_: &Widths) -> u32 {
        1 + CONTROL
    }
}

/// Place and one brightness.
impl Signal for Highlight {
    fn bits(_: &Widths) -> u32 {
        2 * COORDINATE + NUMBER
    }
}

impl Signal for Highlights {
    fn bits(widths: &Widths) -> u32 {
        2 + Highlight::bits(widths)
    }
}

/// The number of what stands in the registers of circuit (50).
impl Signal for NormalLoad {
    fn bits(_: &Widths) -> u32 {
        CONTROL
    }
}

impl Signal for Finished {
    fn bits(_: &Widths) -> u32 {
        1
    }
}
