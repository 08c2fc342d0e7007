//! User input at a time (475).
//!
//! What is drawn must not depend on a cycle; so times become counts of pictures, which a run ahead of the run finds.

use super::DeferConfig;
use basrelief_deferred_renderer::RenderMode;

impl DeferConfig {
    /// Whether the user acts at times: there must be a run ahead.
    pub fn has_events(&self) -> bool {
        self.defer.mode == RenderMode::Progressive && !self.defer.events_ms.is_empty()
    }

    /// After how many pictures each viewpoint is left, 0 where no event falls into it, by the pictures that a run has shown: cycles of
    /// each from the one before, and whether it was the last of its viewpoint. Several events that fall between two pictures are one.
    pub fn views_left(&self, shown: impl IntoIterator<Item = (u64, bool)>) -> Vec<u32> {
        let mut events = self.defer.events_ms.iter().map(|ms| self.cycle_of(*ms)).peekable();
        let (mut views, mut now, mut pictures) = (Vec::new(), 0, 0);
        let mut left = 0;
        for (cycles, is_last) in shown {
            now += cycles;
            pictures += 1;
            while events.next_if(|event| *event <= now).is_some() {
                left = if left == 0 { pictures } else { left };
            }
            if is_last {
                views.push(std::mem::take(&mut left));
                pictures = 0;
            }
        }
        views
    }

    fn cycle_of(&self, ms: f64) -> u64 {
        (ms * self.clock.hz as f64 / 1e3) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_falls_behind_the_first_picture_shown_then_or_later() {
        let at = |events: &[f64]| {
            let mut config = DeferConfig::default();
            config.defer.events_ms = events.to_vec();
            // Two viewpoints of three pictures each, a millisecond apart.
            let shown = (0..6).map(|i| (100_000, i % 3 == 2));
            config.views_left(shown)
        };
        assert_eq!(at(&[]), [0, 0]);
        assert_eq!(at(&[0.0]), [1, 0]);
        assert_eq!(at(&[1.0, 1.001]), [1, 0], "then, or later; the second is the first viewpoint's still");
        assert_eq!(at(&[1.2, 1.4, 5.0]), [2, 2], "two between two pictures are one");
        assert_eq!(at(&[3.0, 9.0]), [3, 0]);
    }
}
