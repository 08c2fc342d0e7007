//! Bit widths of the renderer's tokens.

use crate::config::WRAP_BITS;
use crate::tokens::{
    CellBlock, CellFlow, EncodedTile, ExpandedTile, MarkFlow, PassFlow, PassRound, PlacedCell, ResponseContent, StoreOrder,
    TileMark, TileRequest, TileResponse,
};
use basrelief_signals::width::{CONTROL, COORDINATE, NUMBER};
use basrelief_signals::{Attribution, BitWidth, PixelSet, SignalWidths, Stamp};

/// Width of a cell on the way to the reference buffer (126).
const CELL: u32 = 16 + WRAP_BITS + 3 * 16 + 3 * NUMBER;
/// Width of the page and number of a tile.
const TILE: u32 = 16 + NUMBER;
/// Marks that travel side by side.
const MARKS: u32 = 4;

impl BitWidth for PlacedCell {
    fn bits(_: &SignalWidths) -> u32 {
        2 * COORDINATE + CELL
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// Cells or control. Two bits distinguish them.
impl BitWidth for CellFlow {
    fn bits(widths: &SignalWidths) -> u32 {
        2 + Stamp::<PlacedCell>::bits(widths).max(CONTROL)
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Page(_) => Attribution::Inherited,
            Self::Cells(cells) => cells.attribution(),
            Self::FrameEnd => Attribution::Whole,
        }
    }
}

/// Position, and 4 x 4 cells with a mask.
impl BitWidth for CellBlock {
    fn bits(_: &SignalWidths) -> u32 {
        2 * COORDINATE + 16 * (1 + CELL)
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::block(self.at, self.mask))
    }
}

impl BitWidth for PassFlow {
    fn bits(widths: &SignalWidths) -> u32 {
        3 + CellBlock::bits(widths).max(CONTROL)
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Page(_) => Attribution::Inherited,
            Self::Begin | Self::End => Attribution::Whole,
            Self::Cells(block) => block.attribution(),
        }
    }
}

/// Tile, pixels that need it, distance.
impl BitWidth for TileMark {
    fn bits(_: &SignalWidths) -> u32 {
        TILE + 5 + NUMBER
    }
}

impl BitWidth for MarkFlow {
    fn bits(widths: &SignalWidths) -> u32 {
        2 + MARKS * (1 + TileMark::bits(widths))
    }

    /// Returns the pixels of the block that needs the tiles.
    fn attribution(&self) -> Attribution {
        match self {
            Self::Page(_) | Self::Marks(_) => Attribution::Inherited,
            Self::Frame | Self::End => Attribution::Whole,
        }
    }
}

/// The number of a tile. Announcements use the same wire.
impl BitWidth for TileRequest {
    fn bits(_: &SignalWidths) -> u32 {
        2 + TILE
    }
}

impl BitWidth for StoreOrder {
    fn bits(_: &SignalWidths) -> u32 {
        2 + TILE
    }
}

impl BitWidth for PassRound {
    fn bits(_: &SignalWidths) -> u32 {
        1
    }
}

/// The tile number. Its bytes lie in the receive buffer of the path.
impl BitWidth for EncodedTile {
    fn bits(_: &SignalWidths) -> u32 {
        TILE
    }
}

/// The tile number. Its texels lie in the buffer of the expander.
impl BitWidth for ExpandedTile {
    fn bits(_: &SignalWidths) -> u32 {
        TILE
    }
}

/// Kind and size. The bytes lie in the receive buffer of the path.
impl BitWidth for TileResponse {
    fn bits(widths: &SignalWidths) -> u32 {
        2 + NUMBER + EncodedTile::bits(widths).max(CONTROL)
    }

    fn attribution(&self) -> Attribution {
        match &self.content {
            ResponseContent::Asked(control) | ResponseContent::Mesh(control) => control.attribution(),
            ResponseContent::Tile(_) => Attribution::Whole,
        }
    }
}
