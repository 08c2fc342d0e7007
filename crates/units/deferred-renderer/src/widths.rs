//! Bit widths of the renderer's tokens.

use crate::ReferenceCell;
use crate::config::WRAP_BITS;
use crate::tokens::{
    CellBlock, CellFlow, EncodedTile, ExpandedTile, MarkFlow, PassFlow, PassRound, PlacedCell, ResponseContent, StoreOrder,
    TileMark, TileMarks, TileRequest, TileResponse,
};
use basrelief_signals::width::{CONTROL, COORDINATE, NUMBER, position};
use basrelief_signals::{Attribution, BitWidth, Control, Frame, PixelSet, SignalWidths, Stamp, WireFields};
use std::sync::Arc;

/// Lists the fields of a cell on the way to the reference buffer (126).
fn cell(wire: &mut WireFields, cell: Option<&ReferenceCell>) {
    wire.number("page", 16, cell.map(|cell| cell.page_field()));
    for i in 0..2 {
        wire.number(&format!("wrap_{i}"), WRAP_BITS / 2, cell.map(|cell| cell.wrap[i] as u32));
    }
    for i in 0..3 {
        wire.number(&format!("coefficient_{i}"), 16, cell.map(|cell| cell.coefficients()[i]));
    }
    wire.real("s", NUMBER, cell.map(|cell| cell.coordinates[0]));
    wire.real("t", NUMBER, cell.map(|cell| cell.coordinates[1]));
    wire.real("depth", NUMBER, cell.map(|cell| cell.depth));
}

/// Lists page and number of a tile.
fn tile(wire: &mut WireFields, tile: Option<(u16, u32)>) {
    wire.number("page", 16, tile.map(|(page, _)| page));
    wire.number("tile", NUMBER, tile.map(|(_, tile)| tile));
}

/// Lists the number of a control token, and the size of a frame.
fn control(wire: &mut WireFields, frame: Option<&Arc<Frame>>, page: Option<u16>) {
    let number = frame.map(|frame| frame.index).or(page.map(u32::from));
    wire.number("number", CONTROL, number);
    wire.setup("width", COORDINATE, frame.map(|frame| frame.width));
    wire.setup("height", COORDINATE, frame.map(|frame| frame.height));
}

/// Content of a token of cells or control.
enum FlowContent<'a, T> {
    Frame(&'a Arc<Frame>),
    Page(u16),
    Cells(&'a T),
    /// Control without data, as the token numbers it.
    Other(u32),
}

impl<'a> From<&'a CellFlow> for FlowContent<'a, Stamp<PlacedCell>> {
    fn from(flow: &'a CellFlow) -> Self {
        match flow {
            CellFlow::Frame(frame) => Self::Frame(frame),
            CellFlow::Page(page) => Self::Page(page.number),
            CellFlow::Cells(cells) => Self::Cells(cells),
            CellFlow::FrameEnd => Self::Other(3),
        }
    }
}

impl<'a> From<&'a PassFlow> for FlowContent<'a, CellBlock> {
    fn from(flow: &'a PassFlow) -> Self {
        match flow {
            PassFlow::Frame(frame) => Self::Frame(frame),
            PassFlow::Page(page) => Self::Page(page.number),
            PassFlow::Cells(block) => Self::Cells(block),
            PassFlow::Begin => Self::Other(3),
            PassFlow::End => Self::Other(4),
        }
    }
}

impl<T: BitWidth> FlowContent<'_, T> {
    /// Lists the kind of content, `bits` wide, and then the content.
    fn fields(content: Option<Self>, bits: u32, widths: &SignalWidths, wire: &mut WireFields) {
        let kind = content.as_ref().map(|content| match content {
            Self::Frame(_) => 0,
            Self::Page(_) => 1,
            Self::Cells(_) => 2,
            Self::Other(kind) => *kind,
        });
        let (cells, frame, page) = match content {
            Some(Self::Cells(cells)) => (Some(cells), None, None),
            Some(Self::Frame(frame)) => (None, Some(frame), None),
            Some(Self::Page(page)) => (None, None, Some(page)),
            Some(Self::Other(_)) | None => (None, None, None),
        };
        wire.number("kind", bits, kind);
        wire.one_of(&mut [&mut |wire| control(wire, frame, page), &mut |wire| T::fields(cells, widths, wire)]);
    }

    fn attribution(self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Page(_) => Attribution::Inherited,
            Self::Cells(cells) => cells.attribution(),
            Self::Other(_) => Attribution::Whole,
        }
    }
}

/// Marks that travel side by side.
const MARKS: usize = 4;
/// Marks of a token on recorded wires. A block has more marks only if its pixels need more tiles.
const RECORDED_MARKS: usize = 16;

/// Lists the fields of mark number `i` of a token, and whether the token has it.
fn mark(wire: &mut WireFields, i: usize, marks: Option<&TileMarks>, widths: &SignalWidths) {
    let mark = marks.map(|marks| marks.get(i));
    wire.part(&i.to_string(), |wire| {
        wire.flag("valid", mark.map(|mark| mark.is_some()));
        TileMark::fields(mark.flatten(), widths, wire);
    });
}

impl BitWidth for PlacedCell {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        position(wire, token.map(|placed| [placed.x, placed.y]));
        cell(wire, token.map(|placed| &placed.cell));
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// Cells or control. Two bits distinguish them.
impl BitWidth for CellFlow {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        FlowContent::fields(token.map(FlowContent::from), 2, widths, wire);
    }

    fn attribution(&self) -> Attribution {
        FlowContent::from(self).attribution()
    }
}

/// Position, and 4 x 4 cells with a mask.
impl BitWidth for CellBlock {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        position(wire, token.map(|block| block.at));
        wire.number("mask", 16, token.map(|block| block.mask));
        for i in 0..16 {
            wire.part(&i.to_string(), |wire| cell(wire, token.map(|block| &block.cells[i])));
        }
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::block(self.at, self.mask))
    }
}

/// Cells or control. Three bits distinguish them.
impl BitWidth for PassFlow {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        FlowContent::fields(token.map(FlowContent::from), 3, widths, wire);
    }

    fn attribution(&self) -> Attribution {
        FlowContent::from(self).attribution()
    }
}

/// Tile, pixels that need it, distance.
impl BitWidth for TileMark {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        tile(wire, token.map(|mark| (mark.page, mark.tile)));
        wire.number("pixels", 5, token.map(|mark| mark.pixels));
        wire.number("distance", NUMBER, token.map(|mark| mark.distance));
    }
}

impl BitWidth for MarkFlow {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let marks = match token {
            Some(Self::Marks(marks)) => Some(marks),
            _ => None,
        };
        wire.number(
            "kind",
            2,
            token.map(|flow| match flow {
                Self::Frame => 0_u32,
                Self::Page(_) => 1,
                Self::Marks(_) => 2,
                Self::End => 3,
            }),
        );
        (0..MARKS).for_each(|i| mark(wire, i, marks, widths));
        wire.recorded_only(|wire| (MARKS..RECORDED_MARKS).for_each(|i| mark(wire, i, marks, widths)));
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
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.number(
            "kind",
            2,
            token.map(|request| match request {
                Self::Announce(_) => 0_u32,
                Self::Tile(..) => 1,
                Self::End => 2,
            }),
        );
        tile(
            wire,
            match token {
                Some(Self::Tile(page, tile)) => Some((page.number, *tile)),
                _ => None,
            },
        );
    }
}

impl BitWidth for StoreOrder {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        let (kind, of) = token
            .map(|order| match *order {
                Self::Load { page, tile } => (0_u32, Some((page, tile))),
                Self::Synthesize { page, tile } => (1, Some((page, tile))),
                Self::End => (2, None),
                Self::Left => (3, None),
            })
            .unzip();
        wire.number("kind", 2, kind);
        tile(wire, of.flatten());
    }
}

impl BitWidth for PassRound {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.flag("again", token.map(|round| *round == Self::Again));
    }
}

/// The tile number. Its bytes lie in the receive buffer of the path.
impl BitWidth for EncodedTile {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        tile(wire, token.map(|tile| (tile.page.number, tile.tile)));
    }
}

/// The tile number. Its texels lie in the buffer of the expander.
impl BitWidth for ExpandedTile {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        tile(wire, token.map(|tile| (tile.page.number, tile.tile)));
    }
}

/// Kind and size. The bytes lie in the receive buffer of the path.
impl BitWidth for TileResponse {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let (kind, tile, mesh) = match token.map(|response| &response.content) {
            None => (None, None, None),
            Some(ResponseContent::Asked(mesh)) => (Some(0), None, Some(mesh)),
            Some(ResponseContent::Mesh(mesh)) => (Some(1), None, Some(mesh)),
            Some(ResponseContent::Tile(tile)) => (Some(2_u32), Some(tile), None),
        };
        wire.number("kind", 2, kind);
        wire.number("bytes", NUMBER, token.map(|response| response.bytes));
        wire.one_of(&mut [&mut |wire| Control::fields(mesh, widths, wire), &mut |wire| EncodedTile::fields(tile, widths, wire)]);
    }

    fn attribution(&self) -> Attribution {
        match &self.content {
            ResponseContent::Asked(control) | ResponseContent::Mesh(control) => control.attribution(),
            ResponseContent::Tile(_) => Attribution::Whole,
        }
    }
}
