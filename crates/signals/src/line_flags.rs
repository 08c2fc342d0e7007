//! Flags of the memory lines of a picture that are clear.

use serde::{Deserialize, Serialize};

/// State of the lines of a frame: which of them are clear, because nothing was drawn into them. A clear line has a flag, or is written
/// with the background. A picture may have more lines than there are flags; the lines beyond are written at the beginning of the
/// frame.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LineFlags {
    /// The flags. True: the line is clear.
    clear: Vec<bool>,
    /// The next flag that the end of the frame examines.
    next: usize,
    /// The next line without a flag to write, and the number of lines.
    unflagged: [u64; 2],
}

impl LineFlags {
    /// Begins a frame of `lines` lines, and sets up to `flags` flags, `per_cycle` (>= 1) in a cycle. Returns the cycles, >= 1.
    pub fn begin(&mut self, lines: u64, flags: u32, per_cycle: u32) -> u64 {
        let flagged = lines.min(flags.into());
        self.clear.clear();
        self.clear.resize(flagged as usize, true);
        (self.next, self.unflagged) = (0, [flagged, lines]);
        flagged.div_ceil(per_cycle.max(1).into()).max(1)
    }

    /// Returns the number of flags of the frame.
    pub fn count(&self) -> u64 {
        self.clear.len() as u64
    }

    /// Returns true if a line has a flag and is clear.
    #[inline]
    pub fn is_clear(&self, line: u64) -> bool {
        self.clear.get(line as usize).is_some_and(|clear| *clear)
    }

    /// Records that a line is drawn into.
    #[inline]
    pub fn draw(&mut self, line: u64) {
        if let Some(clear) = self.clear.get_mut(line as usize) {
            *clear = false;
        }
    }

    /// Returns true if lines without flags are still to be written.
    #[inline]
    pub fn has_unflagged(&self) -> bool {
        self.unflagged[0] < self.unflagged[1]
    }

    /// Returns the next line without a flag to write.
    pub fn take_unflagged(&mut self) -> Option<u64> {
        let [next, lines] = &mut self.unflagged;
        (*next < *lines).then(|| std::mem::replace(next, *next + 1))
    }

    /// Finds the next clear line at the end of the frame, and resets its flag. `per_cycle` (>= 1) flags are examined in a cycle. Returns
    /// the line, or `None` if no clear line is left, and the cycles, >= 1.
    pub fn take_clear(&mut self, per_cycle: u32) -> (Option<u64>, u64) {
        let per_cycle = per_cycle.max(1) as usize;
        let from = self.next;
        let found = self.clear[from..].iter().position(|clear| *clear).map(|at| from + at);
        self.next = found.map_or(self.clear.len(), |line| line + 1);
        if let Some(line) = found {
            self.clear[line] = false;
        }
        let last = found.unwrap_or(self.clear.len().saturating_sub(1));
        (found.map(|line| line as u64), (last / per_cycle).saturating_sub(from / per_cycle).max(1) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clear_lines_are_found_in_order() {
        let mut flags = LineFlags::default();
        assert_eq!(flags.begin(10, 8, 4), 2);
        [0, 1, 2, 3, 6, 9].into_iter().for_each(|line| flags.draw(line));
        assert!(flags.is_clear(4) && !flags.is_clear(6) && !flags.is_clear(8));
        assert_eq!([(); 3].map(|()| flags.take_unflagged()), [Some(8), Some(9), None]);
        assert!(!flags.has_unflagged());
        assert_eq!([(); 4].map(|()| flags.take_clear(4)), [(Some(4), 1), (Some(5), 1), (Some(7), 1), (None, 1)]);
    }

    #[test]
    fn cycles_follow_from_flags_per_cycle() {
        let mut flags = LineFlags::default();
        assert_eq!(flags.begin(300, u32::MAX, 64), 5);
        (0..299).for_each(|line| flags.draw(line));
        assert_eq!(flags.take_clear(64), (Some(299), 4));
        assert_eq!([flags.begin(300, 0, 64), flags.begin(0, 8, 64)], [1, 1]);
        assert_eq!(flags.take_clear(64), (None, 1));
    }
}
