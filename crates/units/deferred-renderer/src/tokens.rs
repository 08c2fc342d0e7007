//! What travels between the units of the rendering device (100).

use crate::{Cell, Page};
use basrelief_signals::{Control, Frame, Stamp};
use smallvec::SmallVec;
use std::sync::Arc;

/// A cell and its pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlacedCell {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// What the reference buffer (126) shall hold.
    pub cell: Cell,
}

/// Initial rasterization (454) to reference buffer (126).
#[derive(Clone, Debug, PartialEq)]
pub enum CellFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// A page is set up (452).
    Page(Arc<Page>),
    /// Cells of pixels that are in front of all before them.
    Cells(Stamp<PlacedCell>),
    /// The frame is rasterized.
    FrameEnd,
}

/// The drawn pixels of one 4 x 4 block of the reference buffer (126).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellBlock {
    /// Column and row of the block \[blocks of 4 x 4 pixels\].
    pub at: [u16; 2],
    /// Which pixels are drawn: bit 4 * row + column.
    pub mask: u16,
    /// Their cells, by the number of their bit.
    pub cells: [Cell; 16],
}

impl CellBlock {
    /// Drawn pixels: number of their bit, and cell.
    #[inline]
    pub fn drawn(&self) -> impl Iterator<Item = (usize, &Cell)> {
        self.cells.iter().enumerate().filter(|(i, _)| self.mask & 1 << i != 0)
    }
}

/// Reference buffer (126) to who passes over it.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "nearly all tokens are blocks; they are built in their slot")]
pub enum PassFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// A page is set up.
    Page(Arc<Page>),
    /// A pass begins.
    Begin,
    /// A block; to the identification (461) only if it holds drawn pixels.
    Cells(CellBlock),
    /// The pass is complete.
    End,
}

/// A tile that is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mark {
    /// Its page.
    pub page: u16,
    /// Its number.
    pub tile: u32,
    /// Pixels of the block that want it.
    pub pixels: u32,
    /// Square of the distance of the block's centre to that of the screen \[pixels^2\].
    pub distance: u32,
}

/// Tiles that the pixels of one block want: distinct.
pub type Marks = SmallVec<[Mark; 4]>;

/// To the tile load list (136).
#[derive(Clone, Debug, PartialEq)]
pub enum MarkFlow {
    /// A frame begins.
    Frame,
    /// A page is set up.
    Page(Arc<Page>),
    /// N becomes L.
    Marks(Marks),
    /// All are marked.
    End,
}

/// Tile load list (136) to server (110).
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// The tiles that will be asked for next, for a server that looks ahead.
    Announce(Arc<[(Arc<Page>, u32)]>),
    /// A tile.
    Tile(Arc<Page>, u32),
    /// No more for this frame.
    End,
}

/// Tile load list (136) to texture-data memory (130): what becomes of its tiles, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The next tile of the path is this one: store it.
    Load {
        /// Page.
        page: u16,
        /// Number.
        tile: u32,
    },
    /// Average its sources.
    Synthesize {
        /// Page.
        page: u16,
        /// Number.
        tile: u32,
    },
    /// All tiles are there: colour.
    End,
    /// The view is left: colour with what is there, for the last time.
    Left,
}

/// Tile load list (136) to reference buffer (126).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Round {
    /// Another pass.
    Again,
    /// The frame is complete.
    Done,
}

/// A tile as it travels.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedTile {
    /// Its page.
    pub page: Arc<Page>,
    /// Its number.
    pub tile: u32,
    /// As encoded.
    pub bytes: Arc<[u8]>,
}

/// A tile, expanded.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpandedTile {
    /// Its page.
    pub page: Arc<Page>,
    /// Its number.
    pub tile: u32,
    /// Row by row.
    pub texels: Arc<[[u8; 4]]>,
}

/// What the server (110) sends.
#[derive(Clone, Debug, PartialEq)]
pub struct Parcel {
    /// What it takes on the path \[bytes\].
    pub bytes: u64,
    /// What it is.
    pub content: Content,
}

/// Content of a parcel.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The first of a polygon mesh: the device waits for it.
    Asked(Control),
    /// What follows.
    Mesh(Control),
    /// A tile that was asked for.
    Tile(EncodedTile),
}
