//! Origin of a token or a step.

use basrelief_signals::PixelSet;
use std::num::NonZeroU64;

/// TokenSample of tokens that are traced one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TokenSample {
    /// Sampling interval: the first of every `every` tokens is traced.
    pub every: NonZeroU64,
    /// True to trace polygons, until their fragments are created. False to trace fragments: stamps, spans or pixels, depending on the
    /// machine.
    pub polygons: bool,
}

/// Numbers of a polygon, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PolygonNumbers {
    /// In the run.
    pub(crate) run: usize,
    /// In its frame.
    pub(crate) frame: u32,
}

/// Frame, object, polygon and pixels of a token, as far as known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TokenOrigin {
    /// Frame number.
    pub(crate) frame: Option<u32>,
    /// Object number.
    pub(crate) object: Option<u32>,
    pub(crate) polygon: Option<PolygonNumbers>,
    pub(crate) pixels: Option<PixelSet>,
    /// MIP level of each pixel, 4 bits each, by position in the token.
    pub(crate) levels: Option<u64>,
    /// Number of the traced token that this token comes from.
    pub(crate) life: Option<u64>,
}

impl TokenOrigin {
    /// Returns the origin of a token of a whole frame.
    pub(crate) fn whole(frame: Option<u32>) -> Self {
        Self { frame, ..Self::default() }
    }

    /// Returns this origin with pixels.
    #[must_use]
    pub(super) fn at(self, pixels: PixelSet) -> Self {
        let levels = pixels.levels.map(|levels| (0..).zip(levels).map(|(i, level)| u64::from(level) << (4 * i)).sum());
        Self { pixels: Some(pixels), levels, ..self }
    }

    /// Returns the finer of two origins, or `self` if both are equally fine. Levels and trace are those of either origin.
    #[must_use]
    pub(super) fn or_finer(self, other: Self) -> Self {
        let (levels, life) = (self.levels.or(other.levels), self.life.or(other.life));
        let finer = if other.fineness() > self.fineness() { other } else { self };
        Self { levels, life, ..finer }
    }

    /// True if the sample may contain this token.
    pub(super) fn is_candidate(&self, sample: TokenSample) -> bool {
        if sample.polygons { self.polygon.is_some() } else { self.pixels.is_some() }
    }

    /// Returns the MIP level of the first pixel.
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
    fn finer_origin_of_two_wins() {
        let frame = TokenOrigin::whole(Some(3));
        let polygon = TokenOrigin { object: Some(1), polygon: Some(PolygonNumbers { run: 7, frame: 2 }), ..frame };
        let pixel = polygon.at(PixelSet::one(4, 5));
        assert_eq!(frame.or_finer(polygon), polygon);
        assert_eq!(pixel.or_finer(polygon), pixel);
        let other = TokenOrigin { levels: Some(9), ..polygon.at(PixelSet::one(6, 5)) };
        assert_eq!(pixel.or_finer(other), TokenOrigin { levels: Some(9), ..pixel }, "the first, with the levels of the second");
    }
}
