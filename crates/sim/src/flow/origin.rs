//! Whom a step is for.

use crate::following::Sample;
use basrelief_signals::PixelSet;

/// Numbers of a polygon, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Polygon {
    /// In the run.
    pub(crate) run: usize,
    /// In its frame.
    pub(crate) frame: u32,
}

/// Frame, object, polygon, pixels, as far as a token has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Origin {
    /// Number of the frame.
    pub(crate) frame: Option<u32>,
    /// Number of the object.
    pub(crate) object: Option<u32>,
    pub(crate) polygon: Option<Polygon>,
    pub(crate) pixels: Option<PixelSet>,
    /// MIP level of each pixel, 4 bits each, by place in the token.
    pub(crate) levels: Option<u64>,
    /// Number of the token whose life is told that this comes from.
    pub(crate) life: Option<u64>,
}

impl Origin {
    /// The frame as a whole.
    pub(crate) fn whole(frame: Option<u32>) -> Self {
        Self { frame, ..Self::default() }
    }

    /// What this becomes where a token is about pixels of its own.
    #[must_use]
    pub(super) fn at(self, pixels: PixelSet) -> Self {
        let levels = pixels.levels.map(|levels| (0..).zip(levels).map(|(i, level)| u64::from(level) << (4 * i)).sum());
        Self { pixels: Some(pixels), levels, ..self }
    }

    /// Of two tokens taken together the one that says more, and the first where both say as much; levels are those of either.
    #[must_use]
    pub(super) fn or_finer(self, other: Self) -> Self {
        let (levels, life) = (self.levels.or(other.levels), self.life.or(other.life));
        let finer = if other.fineness() > self.fineness() { other } else { self };
        Self { levels, life, ..finer }
    }

    /// Whether it is one of those to choose from.
    pub(super) fn is_of(&self, sample: Sample) -> bool {
        if sample.polygons { self.polygon.is_some() } else { self.pixels.is_some() }
    }

    /// MIP level of its first pixel.
    pub(crate) fn level(&self) -> Option<u8> {
        let (place, _) = self.pixels?.places().next()?;
        Some((self.levels? >> (4 * (place & 15)) & 15) as u8)
    }

    fn fineness(&self) -> usize {
        let has = [self.frame.is_some(), self.object.is_some(), self.polygon.is_some(), self.pixels.is_some()];
        has.iter().rposition(|has| *has).map_or(0, |at| at + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_tokens_the_one_counts_that_says_more() {
        let frame = Origin::whole(Some(3));
        let polygon = Origin { object: Some(1), polygon: Some(Polygon { run: 7, frame: 2 }), ..frame };
        let pixel = polygon.at(PixelSet::one(4, 5));
        assert_eq!(frame.or_finer(polygon), polygon);
        assert_eq!(pixel.or_finer(polygon), pixel);
        let other = Origin { levels: Some(9), ..polygon.at(PixelSet::one(6, 5)) };
        assert_eq!(pixel.or_finer(other), Origin { levels: Some(9), ..pixel }, "the first, with the levels of the second");
    }
}
