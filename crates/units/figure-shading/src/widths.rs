//! Bit widths of the device's tokens.

use crate::signals::{FigureFlow, FinishedPolygon, NormalLoad, RegisterOrder, ShadedDot, SpecularDot, SpecularFlow};
use basrelief_signals::width::{CONTROL, COORDINATE, NUMBER};
use basrelief_signals::{Attribution, BitWidth, PixelSet, SignalWidths};

/// Position, depth, three brightnesses.
impl BitWidth for ShadedDot {
    fn bits(widths: &SignalWidths) -> u32 {
        2 * COORDINATE + widths.depth + 3 * NUMBER
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// A dot, or control. Two bits distinguish them.
impl BitWidth for FigureFlow {
    fn bits(widths: &SignalWidths) -> u32 {
        2 + ShadedDot::bits(widths).max(CONTROL)
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Figure(figure) => Attribution::polygon(&figure.polygon),
            Self::Dot(dot) => dot.attribution(),
            Self::End => Attribution::Inherited,
            Self::FrameEnd => Attribution::Whole,
        }
    }
}

/// Control: a register write, or the number of the data in the registers of circuit (21).
impl BitWidth for RegisterOrder {
    fn bits(_: &SignalWidths) -> u32 {
        1 + CONTROL
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Write(_) => Attribution::Inherited,
            Self::Pass(signal) => signal.attribution(),
        }
    }
}

/// Position and one brightness.
impl BitWidth for SpecularDot {
    fn bits(_: &SignalWidths) -> u32 {
        2 * COORDINATE + NUMBER
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

impl BitWidth for SpecularFlow {
    fn bits(widths: &SignalWidths) -> u32 {
        2 + SpecularDot::bits(widths)
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Start { .. } | Self::End => Attribution::Inherited,
            Self::Dot(dot) => dot.attribution(),
        }
    }
}

/// The number of the data in the registers of circuit (50).
impl BitWidth for NormalLoad {
    fn bits(_: &SignalWidths) -> u32 {
        CONTROL
    }

    fn attribution(&self) -> Attribution {
        Attribution::polygon(&self.polygon)
    }
}

impl BitWidth for FinishedPolygon {
    fn bits(_: &SignalWidths) -> u32 {
        1
    }
}
