//! Reads the drawing of a machine as a grid of characters: what stands where. The notation is that of `diagram.txt` of the
//! machines, whose tests hold drawing and wiring against each other; here nothing is followed, only drawn again.

/// What a drawing shows, by place.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Sheet {
    /// Size of the grid.
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// `[ unit (numeral) ]`.
    pub(super) boxes: Vec<Placed>,
    /// `{memory (numeral)}`.
    pub(super) memories: Vec<Placed>,
    /// `==client, client==`.
    pub(super) ports: Vec<Placed>,
    /// Names in wires or one blank right of them.
    pub(super) names: Vec<Placed>,
    /// All other words.
    pub(super) notes: Vec<Placed>,
    /// Lines and corners.
    pub(super) wires: Vec<Wire>,
}

/// A text and the cells it has, brackets included.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Placed {
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) width: usize,
    /// As drawn, without brackets; blanks around it are kept, so that it stands where it was drawn.
    pub(super) text: String,
}

/// A cell of a wire: the sides of the cell to which it runs from its middle, and the side at which an arrow ends there.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Wire {
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) sides: Vec<Side>,
    pub(super) head: Option<Side>,
}

/// Of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
    Up,
    Down,
}

use Side::{Down, Left, Right, Up};

impl Side {
    const ALL: [Self; 4] = [Left, Right, Up, Down];

    /// Down and right.
    pub(super) fn step(self) -> (isize, isize) {
        match self {
            Left => (0, -1),
            Right => (0, 1),
            Up => (-1, 0),
            Down => (1, 0),
        }
    }

    fn opposite(self) -> Self {
        match self {
            Left => Right,
            Right => Left,
            Up => Down,
            Down => Up,
        }
    }
}

struct Grid(Vec<Vec<char>>);

impl Grid {
    fn at(&self, row: usize, column: usize) -> char {
        self.0.get(row).and_then(|line| line.get(column)).copied().unwrap_or(' ')
    }

    fn beside(&self, row: usize, column: usize, side: Side) -> char {
        let (down, right) = side.step();
        self.at(row.wrapping_add_signed(down), column.wrapping_add_signed(right))
    }

    /// The wire in this cell, if there is one.
    fn wire(&self, row: usize, column: usize) -> Option<Wire> {
        let near = |side| self.beside(row, column, side);
        let between = |a, b, line| near(a) == line && near(b) == line;
        let crossed = |a, b, line| if between(a, b, line) { Side::ALL.to_vec() } else { vec![] };
        let (sides, head) = match self.at(row, column) {
            // A single one joins two words.
            '-' if [Left, Right].iter().any(|&s| "-+|<>".contains(near(s))) => (or(crossed(Up, Down, '|'), [Left, Right]), None),
            '|' => (or(crossed(Left, Right, '-'), [Up, Down]), None),
            '+' => (Side::ALL.into_iter().filter(|&s| self.runs_to(near(s), s)).collect(), None),
            c => {
                let points = Side::ALL.into_iter().find(|&s| c == arrow(s))?;
                let tail = points.opposite();
                (vec![tail], self.runs_to(near(tail), tail).then_some(points))
            }
        };
        // An arrow without its line is a letter, and a corner without lines a sign.
        let is = !sides.is_empty() && (head.is_some() || "-|+".contains(self.at(row, column)));
        is.then_some(Wire { row, column, sides, head })
    }

    /// Whether a corner goes on to a neighbour on this side.
    fn runs_to(&self, neighbour: char, side: Side) -> bool {
        let line = if matches!(side, Left | Right) { '-' } else { '|' };
        [line, '+', arrow(side)].contains(&neighbour)
    }
}

/// What points to a side.
fn arrow(side: Side) -> char {
    match side {
        Left => '<',
        Right => '>',
        Up => '^',
        Down => 'v',
    }
}

fn or(sides: Vec<Side>, otherwise: [Side; 2]) -> Vec<Side> {
    if sides.is_empty() { otherwise.to_vec() } else { sides }
}

impl Sheet {
    /// Reads a drawing; there is none that cannot be read, since all text is free.
    pub(super) fn read(text: &str) -> Self {
        let grid = Grid(text.lines().map(|line| line.chars().collect()).collect());
        let columns = grid.0.iter().map(Vec::len).max().unwrap_or(0);
        let mut sheet = Self { columns, rows: grid.0.len(), ..Self::default() };
        for row in 0..grid.0.len() {
            sheet.read_row(&grid, row);
        }
        sheet
    }

    fn read_row(&mut self, grid: &Grid, row: usize) {
        let line = grid.0[row].as_slice();
        let mut column = 0;
        while column < line.len() {
            column += match line[column] {
                '[' => place(&mut self.boxes, (line, row, column), "[", "]"),
                '{' => place(&mut self.memories, (line, row, column), "{", "}"),
                '=' => place(&mut self.ports, (line, row, column), "==", "=="),
                ' ' => 1,
                _ => self.read_cell(grid, row, column),
            };
        }
    }

    /// A cell of a wire, or a word; how many cells that is.
    fn read_cell(&mut self, grid: &Grid, row: usize, column: usize) -> usize {
        if let Some(wire) = grid.wire(row, column) {
            self.wires.push(wire);
            return 1;
        }
        let rest = column..grid.0[row].len();
        let word = rest.take_while(|&c| !" [{=".contains(grid.at(row, c)) && grid.wire(row, c).is_none());
        let text: String = word.map(|c| grid.at(row, c)).collect();
        // Brackets and `=` have been read before.
        let width = text.chars().count().max(1);
        let wired = |c: usize| grid.wire(row, c).is_some();
        let in_line = (column > 0 && wired(column - 1)) || wired(column + width);
        let beside = column > 1 && grid.at(row, column - 1) == ' ' && grid.at(row, column - 2) == '|';
        let list = if in_line || beside { &mut self.names } else { &mut self.notes };
        list.push(Placed { row, column, width, text });
        width
    }
}

/// What stands between two marks, and how many cells it takes; without its end it is a sign like any other.
fn place(list: &mut Vec<Placed>, (line, row, column): (&[char], usize, usize), open: &str, close: &str) -> usize {
    let rest: String = line[column..].iter().collect();
    let inside = rest.strip_prefix(open).and_then(|rest| rest.split_once(close)).map(|(inside, _)| inside);
    let Some(inside) = inside else { return 1 };
    let width = inside.chars().count() + open.len() + close.len();
    list.push(Placed { row, column, width, text: inside.to_owned() });
    width
}

impl Placed {
    /// Without the numeral.
    pub(super) fn name(&self) -> &str {
        self.text.split(" (").next().unwrap_or_default().trim()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(list: &[Placed]) -> Vec<&str> {
        list.iter().map(|placed| placed.text.trim()).collect()
    }

    #[test]
    fn what_stands_where() {
        let sheet = Sheet::read(" [a (1)] --one--> [  b  ] ==x, y== {m (2)}   a-b side\n     | two\n     v");
        assert_eq!(texts(&sheet.boxes), ["a (1)", "b"]);
        assert_eq!((sheet.boxes[1].name(), sheet.boxes[1].column, sheet.boxes[1].width), ("b", 18, 7));
        assert_eq!((texts(&sheet.memories), texts(&sheet.ports)), (vec!["m (2)"], vec!["x, y"]));
        assert_eq!((texts(&sheet.names), texts(&sheet.notes)), (vec!["one", "two"], vec!["a-b", "side"]));
        assert_eq!((sheet.columns, sheet.rows), (53, 3));
    }

    #[test]
    fn wires_turn_cross_and_end_in_heads() {
        let sheet = Sheet::read("--+  |\n  | -|-\n  v  |");
        let at = |row, column| sheet.wires.iter().find(|w| (w.row, w.column) == (row, column)).unwrap();
        assert_eq!(at(0, 2).sides, [Left, Down]);
        assert_eq!(at(1, 5).sides, Side::ALL);
        assert_eq!((at(2, 2).sides.as_slice(), at(2, 2).head), ([Up].as_slice(), Some(Down)));
    }

    #[test]
    fn broken_marks_are_signs() {
        let sheet = Sheet::read("[open = {x v + ");
        assert_eq!(texts(&sheet.notes), ["open", "x", "v", "+"]);
        assert_eq!(Sheet::read(""), Sheet::default());
    }
}
