//! User input at given times (475).
//!
//! The work of the machine must not depend on cycles (law 6). Preliminary runs therefore convert times to tile counts.

use super::DeferConfig;
use basrelief_deferred_renderer::RenderMode;

/// Results of a preliminary run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunAhead {
    /// For each picture: cycles since the previous picture, and whether it was the last of its view.
    pub pictures: Vec<(u64, bool)>,
    /// Cycle of arrival of each tile.
    pub came: Vec<u64>,
    /// Tiles loaded for each view.
    pub tiles: Vec<u64>,
}

impl DeferConfig {
    /// True if the user leaves views at given times, which needs preliminary runs.
    pub fn acts_at_times(&self) -> bool {
        self.defer.mode == RenderMode::Progressive && !self.defer.left_at_ms.is_empty()
    }

    /// Returns the idle cycles before each view, accumulated. The device has then finished the previous view, but the user has not left it
    /// yet. The cycles of the run do not contain them.
    fn idle_cycles(&self, pictures: &[(u64, bool)]) -> Vec<u64> {
        let mut times = self.defer.left_at_ms.iter().map(|ms| self.cycle_of(*ms));
        let (mut now, mut in_all, mut looked) = (0, 0, vec![0]);
        for (cycles, is_last) in pictures {
            now += cycles;
            if *is_last {
                in_all += times.next().map_or(0, |time| time.saturating_sub(now + in_all));
                looked.push(in_all);
            }
        }
        looked
    }

    /// Returns the cycle at which each picture is shown, from the start, including idle cycles.
    pub fn shown_at(&self, pictures: &[(u64, bool)]) -> Vec<u64> {
        let looked = self.idle_cycles(pictures);
        let (mut now, mut view) = (0, 0);
        let at = pictures.iter().map(|(cycles, is_last)| {
            now += cycles;
            let at = now + looked[view];
            view += usize::from(*is_last);
            at
        });
        at.collect()
    }

    /// Returns the machine for the first preliminary run, in which no view is left.
    #[must_use]
    pub fn never_left(&self, views: usize) -> Self {
        let mut next = self.clone();
        next.defer.left_at_tile = vec![0; views];
        next
    }

    /// Returns the machine with one more view left: the first view that was not left in this run but should have been. The run is correct
    /// up to there. Returns `None` if there is no such view.
    #[must_use]
    pub fn left_once_more(&self, ahead: &RunAhead) -> Option<Self> {
        let mut came = &ahead.came[..];
        let views = self.idle_cycles(&ahead.pictures).into_iter().zip(&ahead.tiles).zip(&self.defer.left_at_ms);
        for (view, ((looked, tiles), ms)) in views.enumerate() {
            let (own, others) = came.split_at_checked(usize::try_from(*tiles).ok()?)?;
            came = others;
            let there = own.iter().filter(|cycle| **cycle + looked <= self.cycle_of(*ms)).count();
            let is_left = self.defer.left_at_tile.get(view).is_none_or(|tile| *tile > 0);
            if there < own.len() && !is_left {
                let mut next = self.clone();
                next.defer.left_at_tile[view] = there as u32 + 1;
                return Some(next);
            }
        }
        None
    }

    fn cycle_of(&self, ms: f64) -> u64 {
        (ms * self.clock.hz as f64 / 1e3) as u64
    }
}
