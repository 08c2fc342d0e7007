//! Memory lines of a picture that a unit has open for writing.

use serde::{Deserialize, Serialize};

/// Set of memory lines that gather writes, each held once. If there is no room for another line, the least recently written one
/// is written to memory as a whole. Each touch passes the number of lines, a parameter of the unit. It is a few dozen at most,
/// because the search is linear.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GatheredLines {
    /// Lines in order of their last write. The newest is last, so one comparison handles the common touch.
    lines: Vec<u64>,
}

impl GatheredLines {
    /// Returns true if `line` is the most recently written one.
    #[inline(always)]
    pub fn is_newest(&self, line: u64) -> bool {
        self.lines.last() == Some(&line)
    }

    /// Returns true if `line` is being gathered.
    #[inline]
    pub fn contains(&self, line: u64) -> bool {
        self.is_newest(line) || self.place(line).is_some()
    }

    /// Returns true if no line is being gathered.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Writes into a line, which becomes the most recently written one. Returns the evicted line if `room` (>= 1) lines were
    /// gathered already.
    #[inline]
    pub fn touch(&mut self, line: u64, room: u32) -> Option<u64> {
        if self.is_newest(line) { None } else { self.touch_another(line, room) }
    }

    #[inline]
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

    /// Returns the position of a line. The search starts at the most recently written one, because neighbours are drawn one after
    /// the other.
    fn place(&self, line: u64) -> Option<usize> {
        self.lines.iter().rposition(|l| *l == line)
    }

    /// Removes the least recently written line. Returns `None` if no line is gathered.
    pub fn take(&mut self) -> Option<u64> {
        (!self.lines.is_empty()).then(|| self.lines.remove(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_recently_written_line_is_evicted() {
        let mut lines = GatheredLines::default();
        assert_eq!([1, 2, 3, 1, 1].map(|line| lines.touch(line, 3)), [None; 5]);
        assert_eq!([4, 1, 5].map(|line| lines.touch(line, 3)), [Some(2), None, Some(3)]);
        assert_eq!([1, 2, 3, 4, 5].map(|line| lines.contains(line)), [true, false, false, true, true]);
        assert_eq!(std::array::from_fn(|_| lines.take()), [Some(4), Some(1), Some(5), None]);
        assert!(lines.is_empty());
    }

    #[test]
    fn room_for_one_evicts_on_every_change_of_line() {
        let mut lines = GatheredLines::default();
        assert_eq!([7, 7, 8, 7].map(|line| lines.touch(line, 1)), [None, None, Some(7), Some(8)]);
    }
}
