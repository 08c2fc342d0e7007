//! Entries that wait for the end of a list: their memory, and its lines.

use crate::state::HeldItem;
use crate::{DrawOrder, GraphicsProcessor};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{HardwareKind, MemoryPorts};
use basrelief_signals::layout;

/// Client that writes and reads entries.
const ENTRIES: u32 = 1;
/// Size per stamp, beside the entries of its fragments \[bytes\]: the number of its block in the scan of its polygon, and a mask
/// of the block's pixels, 16 bits each. A second scan of the polygon restores the rest of their positions.
const PLACE: u64 = 4;
/// Unit of writes and reads of entries \[bytes\]. One line is gathered, and another is prefetched (assumed: as lines of caches
/// and of pixels).
const LINE: u64 = 64;

impl GraphicsProcessor {
    /// Returns the bytes of a stamp of this many fragments.
    fn held_bytes(&self, fragments: u64) -> u64 {
        PLACE + fragments * u64::from(self.entry_bits.div_ceil(8))
    }

    /// Stores a stamp. An entry is written with its line, when the line is full.
    pub(crate) fn hold(&mut self, stamp: HeldItem, traffic: &mut MemoryPorts) {
        let (fragments, is_bump) = (stamp.fragments() as u64, matches!(stamp, HeldItem::Bump(_)));
        self.state.waiting += fragments;
        if self.state.waiting > u64::from(self.config.hold_fragments) {
            return traffic.fault(format!(
                "graphics processor: more fragments of one frame wait than `graphics.hold_fragments` = {}; raise it, or set `graphics.draw` = streamed",
                self.config.hold_fragments
            ));
        }
        if is_bump {
            self.state.counters.held += fragments;
            let from = self.state.bytes_held / LINE * LINE;
            self.state.bytes_held += self.held_bytes(fragments);
            request(from, self.state.bytes_held / LINE * LINE, |address, bytes| traffic.write(ENTRIES, address, bytes));
        }
        self.state.held.push_back(stamp);
    }

    /// Ends the list: writes the partly filled line.
    pub(crate) fn end_list(&mut self, traffic: &mut MemoryPorts) {
        self.state.drawing = true;
        let held = self.state.bytes_held;
        request(held / LINE * LINE, held, |address, bytes| traffic.write(ENTRIES, address, bytes));
    }

    /// Removes the oldest waiting item, and reads the missing lines of its entries.
    pub(crate) fn take_held(&mut self, traffic: &mut MemoryPorts) -> Option<HeldItem> {
        let held = self.state.held.pop_front()?;
        if let HeldItem::Bump(stamp) = &held {
            let read_to = |bytes: u64| bytes.next_multiple_of(LINE).min(self.state.bytes_held);
            let drawn = self.state.bytes_drawn + self.held_bytes(stamp.len() as u64);
            request(read_to(self.state.bytes_drawn), read_to(drawn), |address, bytes| traffic.read(ENTRIES, address, bytes));
            self.state.bytes_drawn = drawn;
        }
        if self.state.held.is_empty() {
            self.state.drawing = false;
            (self.state.waiting, self.state.bytes_held, self.state.bytes_drawn) = (0, 0, 0);
        }
        Some(held)
    }

    /// Returns the lines that a stamp of entries can complete or begin. The end of the list needs one line.
    pub(crate) fn largest_hold(&self) -> u32 {
        if self.config.draw == DrawOrder::Streamed {
            return 0;
        }
        self.held_bytes(u64::from(self.stamp)).div_ceil(LINE) as u32 + 1
    }

    pub(crate) fn tell_held(&self, stats: &mut UnitStats) {
        stats.figure("results_held", self.state.counters.held, "pixels", "Pixels of bump targets held until the list was over");
        if self.config.draw == DrawOrder::AfterList {
            stats.hardware(HardwareKind::Registers, "lines of entries, one written and one read", 2_u32, 8 * LINE as u32);
        }
    }
}

/// Issues a request for each line that begins between bytes `from` and `to`.
fn request(from: u64, to: u64, mut issue: impl FnMut(u64, u32)) {
    let mut at = from;
    while at < to {
        let bytes = LINE.min(to - at);
        issue(layout::HELD_RESULTS + at, bytes as u32);
        at += bytes;
    }
}
