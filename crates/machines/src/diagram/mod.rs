//! Parser of the machines' block diagrams (`diagram.txt`).
//!
//! | notation | meaning |
//! |---|---|
//! | `[geometry (102)]` | a unit, with its name in the report and its numeral; it may be padded, and drawn more than once |
//! | `--polygons-->` | a FIFO: a line of `-`, <code>&#124;</code> and `+` (a corner) from unit to unit, with an arrowhead at its consumer |
//! | `==z_read, z_write==` | memory clients, between a unit and a `{memory}`; behind a memory: clients of no unit |
//! | any other text | a note |
//!
//! The name of a FIFO stands in its line, or one blank to the right of a vertical line. Lines cross without touching.

/// Contents of a block diagram, by place.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct BlockDiagram {
    /// Width \[characters\].
    pub columns: usize,
    /// Height \[lines\].
    pub rows: usize,
    /// Units: `[name (numeral)]`.
    pub units: Vec<PlacedText>,
    /// Memories: `{name (numeral)}`.
    pub memories: Vec<PlacedText>,
    /// Memory clients: `==client, client==`.
    pub clients: Vec<PlacedText>,
    /// Names of FIFOs.
    pub fifos: Vec<PlacedText>,
    /// All other words.
    pub notes: Vec<PlacedText>,
    /// Lines, corners and arrowheads.
    pub wires: Vec<WireCell>,
}

/// A text and its place.
#[derive(Debug, PartialEq, Eq)]
pub struct PlacedText {
    /// Row, from 0.
    pub row: usize,
    /// First column, from 0, with the brackets.
    pub column: usize,
    /// Width with the brackets \[characters\].
    pub width: usize,
    /// The text without its brackets. Blanks within the brackets are kept, so that the text can be drawn at its place.
    pub text: String,
}

/// A character of a wire.
#[derive(Debug, PartialEq, Eq)]
pub struct WireCell {
    /// Row, from 0.
    pub row: usize,
    /// Column, from 0.
    pub column: usize,
    /// Sides of the cell that the wire reaches from its centre.
    pub sides: Vec<CellSide>,
    /// Direction of the arrowhead in this cell.
    pub arrow: Option<CellSide>,
}

/// A side of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellSide {
    /// Left.
    Left,
    /// Right.
    Right,
    /// Up.
    Up,
    /// Down.
    Down,
}

use CellSide::{Down, Left, Right, Up};

impl CellSide {
    /// All four sides.
    pub const ALL: [Self; 4] = [Left, Right, Up, Down];

    /// Steps down and to the right that lead to the neighbour on this side.
    pub fn step(self) -> (isize, isize) {
        match self {
            Left => (0, -1),
            Right => (0, 1),
            Up => (-1, 0),
            Down => (1, 0),
        }
    }

    /// The opposite side.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Left => Right,
            Right => Left,
            Up => Down,
            Down => Up,
        }
    }

    fn is_horizontal(self) -> bool {
        matches!(self, Left | Right)
    }

    fn arrowhead(self) -> char {
        match self {
            Left => '<',
            Right => '>',
            Up => '^',
            Down => 'v',
        }
    }
}

impl PlacedText {
    /// The name, without its numeral.
    pub fn name(&self) -> &str {
        name_and_numeral(&self.text).0
    }
}

impl BlockDiagram {
    /// Reads a diagram. Every text is one, because all other text is a note.
    pub fn read(text: &str) -> Self {
        let grid = CharGrid(text.lines().map(|line| line.chars().collect()).collect());
        let columns = grid.0.iter().map(Vec::len).max().unwrap_or(0);
        let mut diagram = Self { columns, rows: grid.0.len(), ..Self::default() };
        for row in 0..grid.0.len() {
            diagram.read_row(&grid, row);
        }
        diagram
    }

    fn read_row(&mut self, grid: &CharGrid, row: usize) {
        let line = grid.0[row].as_slice();
        let mut column = 0;
        while column < line.len() {
            let (list, open, close) = match line[column] {
                '[' => (&mut self.units, "[", "]"),
                '{' => (&mut self.memories, "{", "}"),
                '=' => (&mut self.clients, "==", "=="),
                ' ' => {
                    column += 1;
                    continue;
                }
                _ => {
                    column += self.read_cell(grid, row, column);
                    continue;
                }
            };
            let text = enclosed(&line[column..], open, close);
            let width = text.as_ref().map_or(1, |text| text.chars().count() + open.len() + close.len());
            list.extend(text.map(|text| PlacedText { row, column, width, text }));
            column += width;
        }
    }

    /// Reads a wire cell or a word, and returns its width.
    fn read_cell(&mut self, grid: &CharGrid, row: usize, column: usize) -> usize {
        if let Some(wire) = grid.wire(row, column) {
            self.wires.push(wire);
            return 1;
        }
        let rest = column..grid.0[row].len();
        let word = rest.take_while(|&c| !" [{=".contains(grid.at(row, c)) && grid.wire(row, c).is_none());
        let text: String = word.map(|c| grid.at(row, c)).collect();
        let width = text.chars().count().max(1);
        let is_wire = |c: usize| grid.wire(row, c).is_some();
        let in_line = (column > 0 && is_wire(column - 1)) || is_wire(column + width);
        let beside = column > 1 && grid.at(row, column - 1) == ' ' && grid.at(row, column - 2) == '|';
        let list = if in_line || beside { &mut self.fifos } else { &mut self.notes };
        list.push(PlacedText { row, column, width, text });
        width
    }
}

/// Name and numeral of every unit that a diagram shows, `[name (numeral)]`; the numeral may be empty.
pub fn drawn_units(diagram: &str) -> Vec<(&str, &str)> {
    let boxes = diagram.split('[').skip(1).filter_map(|rest| Some(rest.split_once(']')?.0));
    boxes.map(name_and_numeral).collect()
}

/// The numeral of a unit in a diagram; empty if it has none.
pub fn numeral_of<'a>(diagram: &'a str, unit: &str) -> &'a str {
    drawn_units(diagram).into_iter().find(|(name, _)| *name == unit).map_or("", |(_, numeral)| numeral)
}

fn name_and_numeral(text: &str) -> (&str, &str) {
    let text = text.trim();
    text.strip_suffix(')').and_then(|text| text.split_once(" (")).unwrap_or((text, ""))
}

/// The text between two marks at the beginning of a line; `None` if one of the marks is missing.
fn enclosed(line: &[char], open: &str, close: &str) -> Option<String> {
    let line: String = line.iter().collect();
    Some(line.strip_prefix(open)?.split_once(close)?.0.to_owned())
}

struct CharGrid(Vec<Vec<char>>);

impl CharGrid {
    fn at(&self, row: usize, column: usize) -> char {
        self.0.get(row).and_then(|line| line.get(column)).copied().unwrap_or(' ')
    }

    /// The wire in this cell, if there is one.
    fn wire(&self, row: usize, column: usize) -> Option<WireCell> {
        let near = |side: CellSide| {
            let (down, right) = side.step();
            self.at(row.wrapping_add_signed(down), column.wrapping_add_signed(right))
        };
        // A line that is crossed runs to all four sides.
        let line = |own: [CellSide; 2], other: [CellSide; 2], crossing: char| {
            if other.iter().all(|&side| near(side) == crossing) { CellSide::ALL.to_vec() } else { own.to_vec() }
        };
        let (sides, arrow) = match self.at(row, column) {
            // A single `-` joins two words.
            '-' if [Left, Right].iter().any(|&side| "-+|<>".contains(near(side))) => (line([Left, Right], [Up, Down], '|'), None),
            '|' => (line([Up, Down], [Left, Right], '-'), None),
            '+' => (CellSide::ALL.into_iter().filter(|&side| continues(near(side), side)).collect(), None),
            c => {
                let points = CellSide::ALL.into_iter().find(|&side| c == side.arrowhead())?;
                let tail = points.opposite();
                (vec![tail], continues(near(tail), tail).then_some(points))
            }
        };
        // An arrowhead without a line is a letter, and a corner without lines is a plus sign.
        let is_wire = !sides.is_empty() && (arrow.is_some() || "-|+".contains(self.at(row, column)));
        is_wire.then_some(WireCell { row, column, sides, arrow })
    }
}

/// Returns true if a corner or an arrowhead is connected to this neighbour.
fn continues(neighbour: char, side: CellSide) -> bool {
    let line = if side.is_horizontal() { '-' } else { '|' };
    [line, '+', side.arrowhead()].contains(&neighbour)
}
