//! Reads the drawing of a machine, so that tests can hold it against the wiring, edge by edge.
//!
//! `[geometry (102)]` is a unit, by its name in the report and its numeral; it may be padded, and drawn again elsewhere.
//! `--polygons-->` is a FIFO: a line of `-`, `|` and `+` (a corner) from unit to unit, with an arrowhead at its consumer and its
//! name in the line or one space right of it. Lines cross without touching. `==z_read, z_write==` between a unit and a
//! `{memory}` names the unit's clients there. All other text is free.

use crate::unit_info::drawn_units;
use std::collections::BTreeSet;

/// What a drawing shows.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Drawing {
    /// Units and their numerals.
    pub(crate) units: BTreeSet<(String, String)>,
    /// Producer, FIFO, consumer.
    pub(crate) fifos: BTreeSet<[String; 3]>,
    /// Unit, client, memory.
    pub(crate) clients: BTreeSet<[String; 3]>,
}

impl Drawing {
    /// Reads a drawing.
    ///
    /// # Errors
    /// Lines that lead nowhere, with their row and column, from 0.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let grid = Grid(text.lines().map(|line| line.chars().collect()).collect());
        let units = drawn_units(text).into_iter().map(|(name, numeral)| (name.to_owned(), numeral.to_owned()));
        let mut drawing = Self { units: units.collect(), ..Self::default() };
        for (row, line) in text.lines().enumerate() {
            drawing.read_clients(line).ok_or(format!("row {row}: expected `[unit] ==client== {{memory}}`: {line}"))?;
            for column in 0..line.chars().count() {
                let Some((way, consumer)) = grid.head((row, column))? else { continue };
                let (fifo, producer) = grid.follow((row, column), way)?;
                drawing.fifos.insert([name(&producer), fifo, name(&consumer)]);
            }
        }
        Ok(drawing)
    }

    fn read_clients(&mut self, line: &str) -> Option<()> {
        let parts: Vec<&str> = line.split("==").collect();
        for [unit, clients, memory] in parts.windows(3).step_by(2).filter_map(|w| <[&str; 3]>::try_from(w).ok()) {
            let unit = unit.strip_suffix("] ")?.rsplit_once('[')?.1;
            let memory = memory.strip_prefix(" {")?.split_once('}')?.0;
            self.clients.extend(clients.split(", ").map(|client| [name(unit), client.to_owned(), name(memory)]));
        }
        Some(())
    }
}

/// Without the numeral.
fn name(drawn: &str) -> String {
    drawn.split(" (").next().unwrap_or_default().trim().to_owned()
}

fn is_name(c: char) -> bool {
    c == '_' || c.is_ascii_lowercase() || c.is_ascii_digit()
}

/// Row and column.
type Cell = (usize, usize);
/// A step along a line, down and right.
type Way = (isize, isize);

struct Grid(Vec<Vec<char>>);

impl Grid {
    fn at(&self, (row, column): Cell) -> char {
        self.0.get(row).and_then(|line| line.get(column)).copied().unwrap_or(' ')
    }

    fn next(&self, (row, column): Cell, (down, right): Way) -> Cell {
        (row.wrapping_add_signed(down), column.wrapping_add_signed(right))
    }

    /// The unit drawn over this cell.
    fn unit(&self, (row, column): Cell) -> Option<String> {
        let line = self.0.get(row)?;
        let open = line.get(..=column)?.iter().rposition(|&c| c == '[')?;
        let close = open + line[open..].iter().position(|&c| c == ']')?;
        (column <= close).then(|| line[open + 1..close].iter().collect::<String>().trim().to_owned())
    }

    /// The unit at which a line that leaves `cell` this way ends; sideways, a space lies between them.
    fn end(&self, cell: Cell, way: Way) -> Option<String> {
        let next = self.next(cell, way);
        if way.0 != 0 { self.unit(next) } else { (self.at(next) == ' ').then(|| self.unit(self.next(next, way)))? }
    }

    /// If this is an arrowhead: the way from it along its line, and the unit that it points at.
    fn head(&self, cell: Cell) -> Result<Option<(Way, String)>, String> {
        let (way, lines): (Way, &[char]) = match self.at(cell) {
            '>' => ((0, -1), &['-']),
            '<' => ((0, 1), &['-']),
            'v' => ((-1, 0), &['|', '+']),
            '^' => ((1, 0), &['|', '+']),
            _ => return Ok(None),
        };
        if !lines.contains(&self.at(self.next(cell, way))) {
            return Ok(None);
        }
        let unit = self.end(cell, (-way.0, -way.1)).ok_or(format!("the arrowhead at {cell:?} points at no unit"))?;
        Ok(Some((way, unit)))
    }

    /// Follows a line from its arrowhead to where it comes from: its name, and the producer.
    fn follow(&self, head: Cell, mut way: Way) -> Result<(String, String), String> {
        let (mut cell, mut name) = (head, String::new());
        loop {
            cell = self.next(cell, way);
            match (self.at(cell), way) {
                ('-', _) | ('|', (0, _)) => (),
                ('|', _) => name.extend(self.beside(cell)),
                ('+', _) => way = self.turn(cell, way).ok_or(format!("the corner at {cell:?} has not one way on"))?,
                (c, (0, 1)) if is_name(c) => name.push(c),
                (c, (0, -1)) if is_name(c) => name.insert(0, c),
                (c, _) => return Err(format!("the line to {head:?} breaks at {cell:?}: `{c}`")),
            }
            if let Some(producer) = self.end(cell, way) {
                return Ok((name, producer));
            }
        }
    }

    /// The name one space right of an upright line.
    fn beside(&self, (row, column): Cell) -> Option<String> {
        let name: String = (column + 2..).map(|c| self.at((row, c))).take_while(|&c| is_name(c)).collect();
        (self.at((row, column + 1)) == ' ' && !name.is_empty()).then_some(name)
    }

    fn turn(&self, cell: Cell, (down, _): Way) -> Option<Way> {
        let (ways, line): ([Way; 2], char) = if down == 0 { ([(-1, 0), (1, 0)], '|') } else { ([(0, -1), (0, 1)], '-') };
        let goes_on = |way: &Way| matches!(self.at(self.next(cell, *way)), c if c == line || c == '+');
        match ways.map(|way| goes_on(&way)) {
            [true, false] => Some(ways[0]),
            [false, true] => Some(ways[1]),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(text: &str) -> Vec<String> {
        Drawing::read(text).unwrap().fifos.into_iter().map(|edge| edge.join(" ")).collect()
    }

    #[test]
    fn lines_turn_cross_and_are_named_in_them_or_right_of_them() {
        let text = "
 [a (1)] --one--+      [ b ] <--five--+
     |          v        | two        |
     |         [c] ------|--three--+  |
     | four              v         |  |
     +----------------> [d] <------+  |
                         |  aside     |
                         +------------+";
        assert_eq!(edges(text), ["a four d", "a one c", "b two d", "c three d", "d five b"]);
    }

    #[test]
    fn clients_are_read_from_a_row() {
        let drawing = Drawing::read(" [a (1)] ==x, y== {m (2)}   [b] ==z== {m (2)}").unwrap();
        let clients: Vec<String> = drawing.clients.iter().map(|c| c.join(" ")).collect();
        assert_eq!(clients, ["a x m", "a y m", "b z m"]);
        let units = [("a", "1"), ("b", "")].map(|(name, numeral)| (name.to_owned(), numeral.to_owned()));
        assert_eq!(drawing.units, units.into());
    }

    #[test]
    fn what_leads_nowhere_is_refused() {
        assert!(Drawing::read(" [a] --x--> b").is_err_and(|e| e.contains("points at no unit")));
        assert!(Drawing::read(" [a]  -x--> [b]").is_err_and(|e| e.contains("breaks")));
        assert!(Drawing::read(" [a] --x--+\n\n       [b] <--+").is_err_and(|e| e.contains("breaks at") || e.contains("corner")));
        assert!(Drawing::read(" [a] ==x== m").is_err_and(|e| e.contains("expected")));
    }
}
