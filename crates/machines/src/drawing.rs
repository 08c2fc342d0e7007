//! Reads the drawing of a machine, so that tests can hold it against the wiring, edge by edge.
//!
//! `[geometry (102)]` is a unit, by its name in the report and its numeral; it may be padded, and drawn again elsewhere.
//! `--polygons-->` is a FIFO: a line of `-`, `|` and `+` (a corner) from unit to unit, with an arrowhead at its consumer and its
//! name in the line or one space right of it. Lines cross without touching. `==z_read, z_write==` between a unit and a
//! `{memory}` names the unit's clients there. All other text is free.

use std::collections::BTreeSet;

/// What a drawing shows.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Drawing {
    /// Units, with their numerals as drawn.
    pub(crate) units: BTreeSet<String>,
    /// Producer, FIFO, consumer.
    pub(crate) fifos: BTreeSet<[String; 3]>,
    /// Unit, client, memory.
    pub(crate) clients: BTreeSet<[String; 3]>,
}

/// Row and column.
type Cell = (usize, usize);
/// One step along a line, in rows and columns.
type Direction = (isize, isize);

struct Grid(Vec<Vec<char>>);

impl Grid {
    fn at(&self, (row, column): Cell) -> char {
        self.0.get(row).and_then(|r| r.get(column)).copied().unwrap_or(' ')
    }

    fn next(&self, (row, column): Cell, (down, right): Direction) -> Cell {
        let step = |from: usize, by: isize| from.checked_add_signed(by).unwrap_or(usize::MAX);
        (step(row, down), step(column, right))
    }

    /// The unit drawn over this cell.
    fn unit(&self, (row, column): Cell) -> Option<String> {
        let line = self.0.get(row)?;
        let open = (0..=column.min(line.len())).rev().find(|&i| matches!(self.at((row, i)), '[' | ']'))?;
        let open = if open == column && self.at((row, open)) == ']' { line[..column].iter().rposition(|&c| c == '[')? } else { open };
        let close = open + line[open..].iter().position(|&c| c == ']')?;
        let text: String = line[open + 1..close].iter().collect();
        (line[open] == '[' && column <= close).then(|| text.trim().to_owned())
    }

    /// The unit at which a line that leaves `cell` in this direction ends there; sideways, a space lies between them.
    fn end(&self, cell: Cell, way: Direction) -> Option<String> {
        let next = self.next(cell, way);
        if way.0 != 0 { self.unit(next) } else { (self.at(next) == ' ').then(|| self.unit(self.next(next, way)))? }
    }

    /// Follows a line from the arrowhead at `cell` to where it comes from: the name in it, and the producer.
    fn follow(&self, mut cell: Cell, mut way: Direction) -> Result<(String, String), String> {
        let head = cell;
        let mut name = String::new();
        loop {
            if let Some(producer) = self.end(cell, way) {
                let name = if way.1 > 0 { name } else { name.chars().rev().collect() };
                return Ok((name, producer));
            }
            cell = self.next(cell, way);
            match (self.at(cell), way) {
                ('|', (0, _)) | ('-', _) => (),
                ('|', _) => self.beside(cell).into_iter().for_each(|label| name = label.chars().rev().collect()),
                ('+', _) => way = self.turn(cell, way).ok_or(format!("the corner at {cell:?} has not one way on"))?,
                (c, (0, right)) if is_name(c) => {
                    if right > 0 { name.push(c) } else { name.insert(0, c) }
                    name = if right > 0 { name } else { name };
                }
                (c, _) => return Err(format!("the line to {head:?} breaks at {cell:?}: `{c}`")),
            }
        }
    }

    /// The name one space right of an upright line.
    fn beside(&self, (row, column): Cell) -> Option<String> {
        let name: String = (column + 2..).map(|c| self.at((row, c))).take_while(|&c| is_name(c)).collect();
        (self.at((row, column + 1)) == ' ' && !name.is_empty()).then_some(name)
    }
    
    fn turn(&self, cell: Cell, (down, _): Direction) -> Option<Direction> {
        let ways: [(Direction, char); 2] = if down == 0 { [((-1, 0), '|'), ((1, 0), '|')] } else { [((0, -1), '-'), ((0, 1), '-')] };
        let mut on = ways.into_iter().filter(|&(way, line)| matches!(self.at(self.next(cell, way)), c if c == line || c == '+'));
        on.next().map(|(way, _)| way).filter(|_| on.next().is_none())
    }
}

fn is_name(c: char) -> bool {
    c == '_' || c.is_ascii_lowercase() || c.is_ascii_digit()
}
