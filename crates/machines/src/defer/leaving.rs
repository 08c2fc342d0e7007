//! User input at a time (475).
//!
//! What is drawn must not depend on a cycle; so times become counts of tiles, which runs ahead of the run find.

use super::DeferConfig;
use basrelief_deferred_renderer::RenderMode;

/// What a run ahead of the run has shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunAhead {
    /// Of each picture: cycles from the one before, and whether it was the last of its view.
    pub pictures: Vec<(u64, bool)>,
    /// The cycle at which each tile had come.
    pub came: Vec<u64>,
    /// Tiles loaded for each view.
    pub tiles: Vec<u64>,
}

impl DeferConfig {
    /// Whether the user acts at times: there must be a run ahead.
    pub fn acts_at_times(&self) -> bool {
        self.defer.mode == RenderMode::Progressive && !self.defer.left_at_ms.is_empty()
    }

    /// Cycles for which the user has only looked ahead of each view, in all, by the pictures that a run has shown: the device is done with
    /// the view before, and has nothing to do. The run's own cycles leave them out.
    fn looked(&self, pictures: &[(u64, bool)]) -> Vec<u64> {
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

    /// The cycle at which each picture is shown, counted from the start, with those for which the user only looks.
    pub fn shown_at(&self, pictures: &[(u64, bool)]) -> Vec<u64> {
        let looked = self.looked(pictures);
        let (mut now, mut view) = (0, 0);
        let at = pictures.iter().map(|(cycles, is_last)| {
            now += cycles;
            let at = now + looked[view];
            view += usize::from(*is_last);
            at
        });
        at.collect()
    }

    /// This machine for the first run ahead, of so many views: none is left.
    #[must_use]
    pub fn never_left(&self, views: usize) -> Self {
        let mut told = self.clone();
        told.defer.left_at_tile = vec![0; views];
        told
    }

    /// This machine, with one view more that is left: the first of those that were not left in this run of it though they should have been.
    /// Up to there it has run as it should. None where there is no such view.
    #[must_use]
    pub fn left_once_more(&self, ahead: &RunAhead) -> Option<Self> {
        let mut came = &ahead.came[..];
        let views = self.looked(&ahead.pictures).into_iter().zip(&ahead.tiles).zip(&self.defer.left_at_ms);
        for (view, ((looked, tiles), ms)) in views.enumerate() {
            let (own, others) = came.split_at_checked(usize::try_from(*tiles).ok()?)?;
            came = others;
            let there = own.iter().filter(|cycle| **cycle + looked <= self.cycle_of(*ms)).count();
            let is_left = self.defer.left_at_tile.get(view).is_none_or(|tile| *tile > 0);
            if there < own.len() && !is_left {
                let mut told = self.clone();
                told.defer.left_at_tile[view] = there as u32 + 1;
                return Some(told);
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

    /// Two views of three pictures each, a millisecond apart, and two tiles ahead of each picture.
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

    #[test]
    fn a_view_is_left_in_place_of_the_first_tile_that_has_not_come_by_then() {
        let at = |ms: &[f64]| left_at(ms).left_once_more(&ahead()).map(|told| told.defer.left_at_tile);
        assert_eq!(at(&[0.0]), Some(vec![1, 0]));
        assert_eq!(at(&[0.3]), Some(vec![2, 0]), "the first has just come");
        assert_eq!(at(&[0.99]), Some(vec![3, 0]), "behind the first picture's tiles");
        assert_eq!(at(&[2.59]), Some(vec![6, 0]));
        assert_eq!(at(&[2.6]), None, "all are there: the view is shown to its end");
        assert_eq!(at(&[1.5, 9.0]), Some(vec![4, 0]), "one after the other");
        assert_eq!(at(&[]), None);
    }

    #[test]
    fn the_next_view_begins_no_sooner_than_the_user_turns_to_it() {
        let config = left_at(&[7.0, 8.0]);
        let ms = |cycles: &[u64]| cycles.iter().map(|c| *c as f64 / 1e5).collect::<Vec<_>>();
        assert_eq!(ms(&config.shown_at(&ahead().pictures)), [1.0, 2.0, 3.0, 8.0, 9.0, 10.0], "4 ms are only looked");
        assert_eq!(config.left_once_more(&ahead()).unwrap().defer.left_at_tile, [0, 3], "of the second, 1 ms in");
        assert_eq!(ms(&left_at(&[2.0]).shown_at(&ahead().pictures)), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "or later");
    }
}
