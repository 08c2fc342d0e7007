//! How wide the device's signals are.

use crate::signals::{Dot, Finished, Highlight, Highlights, NormalLoad, Order, Signal as Dots};
use basrelief_signals::width::{CONTROL, COORDINATE, NUMBER};
use basrelief_signals::{About, Pixels, Signal, Widths};

/// Place, depth, three brightnesses.
impl Signal for Dot {
    fn bits(widths: &Widths) -> u32 {
        2 * COORDINATE + widths.depth + 3 * NUMBER
    }

    fn about(&self) -> About {
        About::Pixels(Pixels::one(self.x, self.y))
    }
}

/// A dot, or control; two bits tell which.
impl Signal for Dots {
    fn bits(widths: &Widths) -> u32 {
        2 + Dot::bits(widths).max(CONTROL)
    }

    fn about(&self) -> About {
        match self {
            Self::Frame(frame) => About::frame(frame),
            Self::Figure(figure) => About::polygon(&figure.polygon),
            Self::Dot(dot) => dot.about(),
            Self::End => About::Made,
            Self::FrameEnd => About::Whole,
        }
    }
}

/// Control: what is written, or the number of what stands in the registers of circuit (21).
impl Signal for Order {
    fn bits(_: &Widths) -> u32 {
        1 + CONTROL
    }

    fn about(&self) -> About {
        match self {
            Self::Write(_) => About::Made,
            Self::Pass(signal) => signal.about(),
        }
    }
}

/// Place and one brightness.
impl Signal for Highlight {
    fn bits(_: &Widths) -> u32 {
        2 * COORDINATE + NUMBER
    }

    fn about(&self) -> About {
        About::Pixels(Pixels::one(self.x, self.y))
    }
}

impl Signal for Highlights {
    fn bits(widths: &Widths) -> u32 {
        2 + Highlight::bits(widths)
    }

    fn about(&self) -> About {
        match self {
            Self::Start { .. } | Self::End => About::Made,
            Self::Dot(dot) => dot.about(),
        }
    }
}

/// The number of what stands in the registers of circuit (50).
impl Signal for NormalLoad {
    fn bits(_: &Widths) -> u32 {
        CONTROL
    }

    fn about(&self) -> About {
        About::polygon(&self.polygon)
    }
}

impl Signal for Finished {
    fn bits(_: &Widths) -> u32 {
        1
    }
}
