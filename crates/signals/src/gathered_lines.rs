//! The lines of a picture's memory that a unit has open for writing.

use serde::{Deserialize, Serialize};

/// Lines that gather writes, by number, each once. When there is no room for another, the least recently written one goes:
/// then it is written to memory as a whole. How many there may be is a parameter of the unit, which says so at each touch;
/// here it is a few dozen at most, since a line is looked for one by one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GatheredLines {
    /// The most recently written one last, so that it is found, and the common touch done, with one comparison.
    lines: Vec<u64>,
}

impl GatheredLines {
    /// Whether this line is the most recently written one.
    #[inline(always)]
    pub fn is_newest(&self, line: u64) -> bool {
        self.lines.last() == Some(&line)
    }

    /// Whether this line is being gathered.
    #[inline]
    pub fn contains(&self, line: u64) -> bool {
        self.is_newest(line) || self.place(line).is_some()
    }

    /// Whether none is.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Writes into a line: it is the most recently written one now. Returns the line that had to go, where `room` (>= 1) lines
    /// are gathered already.
    #[inline]
    pub fn touch(&mut self, line: u64, room: u32) -> Option<u64> {
        if self.is_newest(line) { None } else { self.touch_another(line, room) }
    }

    fn touch_another(&mut self, line: u64, room: u32) -> Option<u64> {
        let gone = match self.place(line) {
            Some(own) => {
                self.lines.remove(own);
                None
            }
            None if self.lines.len() < room as usize => None,
            None => self.take(),
        };
        self.lines.push(line);
        gone
    }

    /// Where a line is, looked for among the most recently written first: neighbours are drawn one after the other.
    fn place(&self, line: u64) -> Option<usize> {
        self.lines.iter().rposition(|l| *l == line)
    }

    /// Takes the least recently written line out; `None` where none is gathered.
    pub fn take(&mut self) -> Option<u64> {
        (!self.lines.is_empty()).then(|| self.lines.remove(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_recently_written_line_goes() {
        let mut lines = GatheredLines::default();
        assert_eq!([1, 2, 3, 1, 1].map(|line| lines.touch(line, 3)), [None; 5]);
        assert_eq!([4, 1, 5].map(|line| lines.touch(line, 3)), [Some(2), None, Some(3)]);
        assert_eq!([1, 2, 3, 4, 5].map(|line| lines.contains(line)), [true, false, false, true, true]);
        assert_eq!(std::array::from_fn(|_| lines.take()), [Some(4), Some(1), Some(5), None]);
        assert!(lines.is_empty());
    }

    #[test]
    fn with_room_for_one_a_line_goes_when_it_is_left() {
        let mut lines = GatheredLines::default();
        assert_eq!([7, 7, 8, 7].map(|line| lines.touch(line, 1)), [None, None, Some(7), Some(8)]);
    }
}
