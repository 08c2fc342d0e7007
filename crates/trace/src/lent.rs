//! Tokens whose memory is counted until the last clone is dropped.

use crate::error::CommandFault;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_signals::{Control, Frame, ObjectInfo, Polygon};
use std::collections::VecDeque;
use std::sync::{Arc, Weak};

/// Memory of a token beside its content \[bytes\]: counters, places in lists, and its entry here.
const TOKEN: usize = 128;

/// Tokens that a machine holds. Most machines hold as many as their FIFOs; some keep the list of a whole frame.
pub(crate) struct LentTokens {
    frames: LentKind<Frame>,
    objects: LentKind<ObjectInfo>,
    polygons: LentKind<Polygon>,
}

impl LentTokens {
    pub(crate) fn new(budget: &MemoryPool) -> Self {
        Self { frames: LentKind::new(budget), objects: LentKind::new(budget), polygons: LentKind::new(budget) }
    }

    /// Counts a token.
    pub(crate) fn lend(&mut self, control: &Control) -> Result<(), CommandFault> {
        match control {
            Control::Frame(frame) => self.frames.lend(frame, size_of_val(&*frame.lights), "frames under way", "lights"),
            Control::Object(object) => self.objects.lend(object, object.name.len(), "objects under way", "name"),
            Control::Polygon(polygon) => {
                self.polygons.lend(polygon, size_of_val(&*polygon.vertices), "polygons under way", "position")
            }
            Control::FrameEnd | Control::CodeBook(_) | Control::Criterion(_) => Ok(()),
        }
    }
}

/// Tokens of one kind, in order.
struct LentKind<T> {
    out: VecDeque<(Weak<T>, u64)>,
    held: MemoryReservation,
}

impl<T> LentKind<T> {
    fn new(budget: &MemoryPool) -> Self {
        Self { out: VecDeque::new(), held: budget.empty_reservation() }
    }

    fn lend(&mut self, token: &Arc<T>, bytes: usize, what: &str, field: &'static str) -> Result<(), CommandFault> {
        // Tokens return in almost the order in which they were given out.
        while let Some((first, bytes)) = self.out.front()
            && first.strong_count() == 0
        {
            self.held.give_back(*bytes);
            self.out.pop_front();
        }
        let bytes = (TOKEN + size_of::<T>() + bytes) as u64;
        self.held.try_grow(bytes, what).map_err(CommandFault::over_budget(field))?;
        self.out.push_back((Arc::downgrade(token), bytes));
        Ok(())
    }
}
