//! Tokens between the units of the rendering device (100).

use crate::{ReferenceCell, TexturePage};
use basrelief_signals::{Control, Frame, Stamp};
use smallvec::SmallVec;
use std::sync::Arc;

/// A cell and its pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlacedCell {
    /// Column, from the left.
    pub x: u16,
    /// Row, from the top.
    pub y: u16,
    /// Cell to be stored in the reference buffer (126).
    pub cell: ReferenceCell,
}

/// Token from initial rasterization (454) to reference buffer (126).
#[derive(Clone, Debug, PartialEq)]
pub enum CellFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// A page is set up (452).
    Page(Arc<TexturePage>),
    /// Cells of pixels in front of all earlier ones.
    Cells(Stamp<PlacedCell>),
    /// The frame is rasterized.
    FrameEnd,
}

/// The drawn pixels of one 4 x 4 block of the reference buffer (126).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellBlock {
    /// Column and row of the block \[blocks of 4 x 4 pixels\].
    pub at: [u16; 2],
    /// Mask of drawn pixels: bit 4 * row + column.
    pub mask: u16,
    /// Cells, indexed by bit number.
    pub cells: [ReferenceCell; 16],
}

impl CellBlock {
    /// Returns the drawn pixels: bit number, and cell.
    #[inline]
    pub fn drawn(&self) -> impl Iterator<Item = (usize, &ReferenceCell)> {
        self.cells.iter().enumerate().filter(|(i, _)| self.mask & 1 << i != 0)
    }
}

/// Token from reference buffer (126) to the units that read its passes.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "nearly all tokens are blocks; they are built in their slot")]
pub enum PassFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// A page is set up.
    Page(Arc<TexturePage>),
    /// A pass begins.
    Begin,
    /// A block. The identification (461) gets only blocks with drawn pixels.
    Cells(CellBlock),
    /// The pass is complete.
    End,
}

/// A needed tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileMark {
    /// Page of the tile.
    pub page: u16,
    /// Number of the tile.
    pub tile: u32,
    /// Pixels of the block that need it.
    pub pixels: u32,
    /// Square of the distance of the block's centre to that of the screen \[pixels^2\].
    pub distance: u32,
}

/// Distinct tiles that the pixels of one block need.
pub type TileMarks = SmallVec<[TileMark; 4]>;

/// Token to the tile load list (136).
#[derive(Clone, Debug, PartialEq)]
pub enum MarkFlow {
    /// A frame begins.
    Frame,
    /// A page is set up.
    Page(Arc<TexturePage>),
    /// Tiles whose state N becomes L.
    Marks(TileMarks),
    /// All tiles are marked.
    End,
}

/// Token from tile load list (136) to server (110).
#[derive(Clone, Debug, PartialEq)]
pub enum TileRequest {
    /// Tiles that will be requested next, for a server with prefetching.
    Announce(Arc<[(Arc<TexturePage>, u32)]>),
    /// A requested tile.
    Tile(Arc<TexturePage>, u32),
    /// No further request for this frame.
    End,
}

/// Token from tile load list (136) to texture-data memory (130): orders for its tiles, in sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreOrder {
    /// Store the next tile of the path.
    Load {
        /// Page of the tile.
        page: u16,
        /// Number of the tile.
        tile: u32,
    },
    /// Average a tile from its sources.
    Synthesize {
        /// Page of the tile.
        page: u16,
        /// Number of the tile.
        tile: u32,
    },
    /// All tiles are present: colour the picture.
    End,
    /// The view is left: colour with the present tiles, for the last time.
    Left,
}

/// Token from tile load list (136) to reference buffer (126).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PassRound {
    /// Another pass follows.
    Again,
    /// The frame is complete.
    Done,
}

/// A tile as encoded for the path.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedTile {
    /// Page of the tile.
    pub page: Arc<TexturePage>,
    /// Number of the tile.
    pub tile: u32,
    /// Encoded bytes.
    pub bytes: Arc<[u8]>,
}

/// An expanded tile.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpandedTile {
    /// Page of the tile.
    pub page: Arc<TexturePage>,
    /// Number of the tile.
    pub tile: u32,
    /// Texels, row by row.
    pub texels: Arc<[[u8; 4]]>,
}

/// Token from the server (110) to the path.
#[derive(Clone, Debug, PartialEq)]
pub struct TileResponse {
    /// Size on the path \[bytes\].
    pub bytes: u64,
    /// Content.
    pub content: ResponseContent,
}

/// Content of a token of the server.
#[derive(Clone, Debug, PartialEq)]
pub enum ResponseContent {
    /// The first part of a polygon mesh, for which the device waits.
    Asked(Control),
    /// A further part of a mesh.
    Mesh(Control),
    /// A requested tile.
    Tile(EncodedTile),
}
