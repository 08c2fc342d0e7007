//! How wide the renderer's signals are.

use crate::config::WRAP_BITS;
use crate::tokens::{
    CellBlock, CellFlow, Content, EncodedTile, ExpandedTile, Mark, MarkFlow, Order, Parcel, PassFlow, PlacedCell, Request, Round,
};
use basrelief_signals::width::{CONTROL, COORDINATE, NUMBER};
use basrelief_signals::{About, Pixels, Signal, Stamp, Widths};

/// Cell of the reference buffer (126), on the way there.
const CELL: u32 = 16 + WRAP_BITS + 3 * 16 + 3 * NUMBER;
/// Page and number of a tile.
const TILE: u32 = 16 + NUMBER;
/// Marks that travel side by side.
const MARKS: u32 = 4;

impl Signal for PlacedCell {
    fn bits(_: &Widths) -> u32 {
        2 * COORDINATE + CELL
    }

    fn about(&self) -> About {
        About::Pixels(Pixels::one(self.x, self.y))
    }
}

/// Cells or control; two bits tell which.
impl Signal for CellFlow {
    fn bits(widths: &Widths) -> u32 {
        2 + Stamp::<PlacedCell>::bits(widths).max(CONTROL)
    }

    fn about(&self) -> About {
        match self {
            Self::Frame(frame) => About::frame(frame),
            Self::Page(_) => About::Made,
            Self::Cells(cells) => cells.about(),
            Self::FrameEnd => About::Whole,
        }
    }
}

/// Place, and 4 x 4 cells, each there or not.
impl Signal for CellBlock {
    fn bits(_: &Widths) -> u32 {
        2 * COORDINATE + 16 * (1 + CELL)
    }

    fn about(&self) -> About {
        About::Pixels(Pixels::block(self.at, self.mask))
    }
}

impl Signal for PassFlow {
    fn bits(widths: &Widths) -> u32 {
        3 + CellBlock::bits(widths).max(CONTROL)
    }

    fn about(&self) -> About {
        match self {
            Self::Frame(frame) => About::frame(frame),
            Self::Page(_) => About::Made,
            Self::Begin | Self::End => About::Whole,
            Self::Cells(block) => block.about(),
        }
    }
}

/// Tile, pixels that want it, distance.
impl Signal for Mark {
    fn bits(_: &Widths) -> u32 {
        TILE + 5 + NUMBER
    }
}

impl Signal for MarkFlow {
    fn bits(widths: &Widths) -> u32 {
        2 + MARKS * (1 + Mark::bits(widths))
    }

    /// Marks are about the pixels of the block that wants them.
    fn about(&self) -> About {
        match self {
            Self::Page(_) | Self::Marks(_) => About::Made,
            Self::Frame | Self::End => About::Whole,
        }
    }
}

/// The number of a tile: what is announced goes by the same wire.
impl Signal for Request {
    fn bits(_: &Widths) -> u32 {
        2 + TILE
    }
}

impl Signal for Order {
    fn bits(_: &Widths) -> u32 {
        2 + TILE
    }
}

impl Signal for Round {
    fn bits(_: &Widths) -> u32 {
        1
    }
}

/// Tile; its bytes stand in the receive buffer of the path.
impl Signal for EncodedTile {
    fn bits(_: &Widths) -> u32 {
        TILE
    }
}

/// Tile; its texels stand in the buffer of the expander.
impl Signal for ExpandedTile {
    fn bits(_: &Widths) -> u32 {
        TILE
    }
}

/// What it is, and its bytes; they themselves stand in the receive buffer of the path.
impl Signal for Parcel {
    fn bits(widths: &Widths) -> u32 {
        2 + NUMBER + EncodedTile::bits(widths).max(CONTROL)
    }

    fn about(&self) -> About {
        match &self.content {
            Content::Asked(control) | Content::Mesh(control) => control.about(),
            Content::Tile(_) => About::Whole,
        }
    }
}
