//! CLUTs (122): brightness by index.

use crate::{BrightnessConfig, BrightnessSource, Components};
use basrelief_shading::{LEVELS, LightVector, TableError, TableSet, brightness};
use basrelief_signals::Lighting;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Reference normals, one list per MIP level.
pub(crate) type ReferenceBook = Arc<Vec<Vec<[i16; 3]>>>;

/// Inputs of the entries of a CLUT. If none of them changes, nothing is recalculated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClutKey {
    /// Coefficients of the material.
    pub lighting: Lighting,
    /// Lights as seen from the object. A directional light does not depend on the object's position.
    pub lights: Vec<LightVector>,
    /// Number of reference normals if the object fixes it.
    pub entries: Option<u32>,
    /// Code book that replaces the fixed tables.
    pub book: Option<ReferenceBook>,
}

/// Calculated levels of the CLUTs (122) of a set. Only levels that some fragment needed are calculated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClutLevels {
    /// `[ambient + diffuse (+ specular), specular]` of each entry, one list per level.
    levels: [Vec<[f32; 2]>; LEVELS],
    /// Mask of the calculated levels.
    calculated: u8,
}

impl ClutLevels {
    /// Returns the brightness by index.
    #[inline]
    pub fn entries(&self, level: u8) -> &[[f32; 2]] {
        &self.levels[usize::from(level).min(LEVELS - 1)]
    }

    /// Returns true if a level has been calculated.
    #[inline]
    pub fn has(&self, level: u8) -> bool {
        self.calculated & 1 << level.min(LEVELS as u8 - 1) != 0
    }

    /// Sets the entries of a level.
    pub(crate) fn set(&mut self, level: u8, entries: Vec<[f32; 2]>) {
        let level = level.min(LEVELS as u8 - 1);
        self.calculated |= 1 << level;
        self.levels[usize::from(level)] = entries;
    }
}

/// Computes the entries of a level.
///
/// # Errors
/// Returns an error if the object fixes a number of entries for which no table exists.
pub(crate) fn calculate(
    level: u8,
    config: &BrightnessConfig,
    key: &ClutKey,
    normals: &mut NormalTables,
) -> Result<Vec<[f32; 2]>, TableError> {
    let scale = EntryScale::new(config, key);
    let list = match &key.book {
        Some(book) => book.get(usize::from(level)).map_or(&[][..], Vec::as_slice),
        None => normals.of(level, key.entries)?,
    };
    Ok(list.iter().map(|&n| scale.entry(n, key)).collect())
}

/// Conversion of brightness to CLUT entries.
pub(crate) struct EntryScale {
    combined: bool,
    /// Full scale of each value: the largest possible brightness, with every light facing the surface and the viewer (assumed).
    full: [f32; 2],
    /// Steps of full scale. `None` if entries are exact.
    steps: Option<f32>,
}

impl EntryScale {
    pub(crate) fn new(config: &BrightnessConfig, key: &ClutKey) -> Self {
        let light: f32 = key.lights.iter().map(|l| l.intensity).sum();
        let Lighting { ka, kd, ks, .. } = key.lighting;
        let combined = config.components == Components::Combined;
        let full = if combined { [ka + (kd + ks) * light, 0.0] } else { [ka + kd * light, ks * light] };
        let steps = (config.source == BrightnessSource::Clut).then(|| ((1_u32 << config.bits.min(16)) - 1) as f32);
        Self { combined, full, steps }
    }

    /// Returns the full scale of the first value.
    pub(crate) fn full_scale(&self) -> f32 {
        self.full[0]
    }

    /// Returns the steps of full scale in the first value of an entry.
    pub(crate) fn steps_of(&self, value: f32) -> u64 {
        (value / self.full[0] * self.steps.unwrap_or(0.0)).round() as u64
    }

    fn entry(&self, normal: [i16; 3], key: &ClutKey) -> [f32; 2] {
        let unit = Vec3::from(normal.map(|c| f32::from(c) / 32_767.0));
        let [diffuse, specular] = brightness(unit, &key.lighting, &key.lights);
        let exact = if self.combined { [diffuse + specular, 0.0] } else { [diffuse, specular] };
        match self.steps {
            Some(steps) => std::array::from_fn(|i| quantize(exact[i], self.full[i], steps)),
            None => exact,
        }
    }
}

/// Rounds `value` to one of `steps` steps of `full`, and clamps it. Returns 0 if full scale is not a positive number.
fn quantize(value: f32, full: f32, steps: f32) -> f32 {
    if full > 0.0 && full.is_finite() { (value / full * steps).round().clamp(0.0, steps) / steps * full } else { 0.0 }
}

/// Reference normals of the fixed tables, cached for the last requested object. They follow from the configuration.
#[derive(Clone, Debug)]
pub(crate) struct NormalTables {
    set: TableSet,
    /// Lists for an object that fixes `object` entries: all levels or none.
    lists: Vec<Vec<[i16; 3]>>,
    object: Option<u32>,
}

impl NormalTables {
    pub(crate) fn new(set: TableSet) -> Self {
        Self { set, lists: Vec::new(), object: None }
    }

    /// Returns the entries of the largest level.
    pub(crate) fn largest(&self, key: &ClutKey) -> usize {
        match &key.book {
            Some(book) => book.iter().map(Vec::len).max().unwrap_or(0),
            None => (0..LEVELS as u8).map(|level| self.set.entries(level, key.entries)).max().unwrap_or(0) as usize,
        }
    }

    pub(crate) fn set(&self) -> &TableSet {
        &self.set
    }

    /// Returns the bytes of a reference normal in memory (120).
    pub(crate) fn entry_bytes(&self) -> u32 {
        self.set.entry_bytes()
    }

    fn of(&mut self, level: u8, object: Option<u32>) -> Result<&[[i16; 3]], TableError> {
        if self.lists.is_empty() || self.object != object {
            let list = |level| self.set.normals(level, self.set.entries(level, object));
            self.lists = (0..LEVELS as u8).map(list).collect::<Result<_, _>>()?;
            self.object = object;
        }
        Ok(self.lists.get(usize::from(level)).map_or(&[], Vec::as_slice))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn quantization_error_is_within_half_a_step(v in 0f32..1.3, bits in 4u32..=16) {
            let steps = ((1 << bits) - 1) as f32;
            let q = quantize(v, 1.3, steps);
            // Half a step, and the rounding of q and v to single precision. At 16 bits a step is only 166 of its units.
            prop_assert!((q - v).abs() <= 0.5 * 1.3 / steps + f32::EPSILON, "{v} became {q}");
            prop_assert!((q / 1.3 * steps - (q / 1.3 * steps).round()).abs() < 0.02);
        }
    }

    #[test]
    fn value_beyond_full_scale_saturates() {
        assert_eq!(quantize(2.0, 1.3, 255.0), 1.3);
        assert_eq!(quantize(2.0, 0.0, 255.0), 0.0);
    }
}
