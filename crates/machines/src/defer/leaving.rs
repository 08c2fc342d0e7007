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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two views of three pictures each, at intervals of a millisecond, with two tiles before each picture.
    fn ahead() -> RunAhead {
        let pictures = (0..6).map(|i| (100_000, i % 3 == 2)).collect();
        let came = (0..6).flat_map(|i| [100_000 * i + 30_000, 100_000 * i + 60_000]).collect();
        RunAhead { pictures, came, tiles: vec![6, 6] }
    }

    fn left_at(ms: &[f64]) -> DeferConfig {
        let mut config = DeferConfig::default();
        config.defer.left_at_ms = ms.to_vec();
        config.never_left(2)
    }

    // Claim: as user_times_become_stable_tile_counts_475.
    #[test]
    fn view_is_left_before_the_first_tile_that_is_late() {
        let at = |ms: &[f64]| left_at(ms).left_once_more(&ahead()).map(|next| next.defer.left_at_tile);
        assert_eq!(at(&[0.0]), Some(vec![1, 0]));
        assert_eq!(at(&[0.3]), Some(vec![2, 0]), "the first has just come");
        assert_eq!(at(&[0.99]), Some(vec![3, 0]), "after the tiles of the first picture");
        assert_eq!(at(&[2.59]), Some(vec![6, 0]));
        assert_eq!(at(&[2.6]), None, "all tiles have arrived, so the view is complete");
        assert_eq!(at(&[1.5, 9.0]), Some(vec![4, 0]), "one after the other");
        assert_eq!(at(&[]), None);
    }

    // Claim: as user_times_become_stable_tile_counts_475.
    #[test]
    fn next_view_begins_when_the_user_turns_to_it() {
        let config = left_at(&[7.0, 8.0]);
        let ms = |cycles: &[u64]| cycles.iter().map(|c| *c as f64 / 1e5).collect::<Vec<_>>();
        assert_eq!(ms(&config.shown_at(&ahead().pictures)), [1.0, 2.0, 3.0, 8.0, 9.0, 10.0], "4 ms are idle");
        assert_eq!(config.left_once_more(&ahead()).unwrap().defer.left_at_tile, [0, 3], "1 ms into the second view");
        assert_eq!(ms(&left_at(&[2.0]).shown_at(&ahead().pictures)), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "or later");
    }
}
