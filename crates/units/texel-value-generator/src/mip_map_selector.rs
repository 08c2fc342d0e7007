//! MIP-map selector (320).

use crate::config::{MipConfig, MipMode};
use crate::signals::{GradientPacket, LevelPacket};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, HardwareKind, Step, Traffic, Unit};
use basrelief_signals::{Control, Flow, Texture};
use serde::{Deserialize, Serialize};

/// Bits of the fraction of a level, and of what it is looked up by.
const FRACTION_BITS: u32 = 8;
/// A level: 4 bits, and the fraction.
const LEVEL_BITS: u32 = 4 + FRACTION_BITS;

/// What the MIP-map selector has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MipMapSelectorCounters {
    /// Levels selected, one for each run of equal gradients.
    pub selections: u64,
}

/// Everything the MIP-map selector remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MipMapSelectorState {
    /// Width and height of level 0 of the polygon's texture \[texels\].
    pub size: [f32; 2],
    /// Number of its last level.
    pub last: f32,
    /// What it has counted.
    pub counters: MipMapSelectorCounters,
}

/// MIP-map selector (320): gradients in, map select out (claim 9).
///
/// `level = log2(max(|du/dx|, |dv/dx|))` in texels of level 0 per pixel, clamped to the pyramid; a gradient of zero is level 0.
/// (Derived: maps halve u and v from level to level, so that at this level a pixel is a texel wide.)
#[derive(Clone, Debug, Default)]
pub struct MipMapSelector {
    /// Parameters.
    pub config: MipConfig,
    /// Everything it remembers.
    pub state: MipMapSelectorState,
}

/// Level for this change of u, v per pixel, in a texture of this size whose last level has this number.
pub fn level([du, dv]: [f32; 2], [width, height]: [f32; 2], last: f32, mode: MipMode) -> f32 {
    let texels = (du.abs() * width).max(dv.abs() * height);
    // Up to one texel per pixel it is the finest; NaN is neither.
    let level = if texels > 1.0 { libm::log2f(texels).min(last) } else { 0.0 };
    match mode {
        MipMode::Off => 0.0,
        // Half way it is the finer one, as in OpenGL.
        MipMode::Nearest => ((level + 0.5).ceil() - 1.0).clamp(0.0, last),
        MipMode::Trilinear => level,
    }
}

impl MipMapSelector {
    /// A MIP-map selector at power-on.
    pub fn new(config: MipConfig) -> Self {
        Self { config, state: MipMapSelectorState::default() }
    }

    fn take(&mut self, control: &Control) {
        let Control::Polygon(polygon) = control else { return };
        let first = |t: &Texture| t.levels.first().map_or([1.0; 2], |image| [image.width as f32, image.height as f32]);
        let texture = polygon.material.color_texture.as_deref();
        self.state.size = texture.map_or([1.0; 2], first);
        self.state.last = texture.map_or(0.0, |t| t.levels.len().saturating_sub(1) as f32);
    }

    fn select(&mut self, packet: &GradientPacket) -> LevelPacket {
        let mut levels = LevelPacket::default();
        if self.config.mode == MipMode::Off {
            return levels;
        }
        let mut known: Option<([f32; 2], f32)> = None;
        for i in packet.packet.positions() {
            let gradient = packet.gradient[i];
            levels.level[i] = match known {
                Some((same, level)) if same == gradient => level,
                _ => {
                    self.state.counters.selections += 1;
                    level(gradient, self.state.size, self.state.last, self.config.mode)
                }
            };
            known = Some((gradient, levels.level[i]));
        }
        levels
    }
}

impl Unit for MipMapSelector {
    basrelief_kernel::role!("selects a level by du, dv");
    type In = Option<Flow<GradientPacket>>;
    type Out = Option<Flow<LevelPacket>>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut Traffic) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(Flow::Item(packet)) => {
                let levels = self.select(&packet);
                Step::over(packet.packet.pixels(), 1, latency, Some(Flow::Item(levels)))
            }
            Some(Flow::Control(control)) => {
                self.take(&control);
                Step::after(latency, Some(Flow::Control(control)))
            }
            None => Step::after(latency, None),
        }
    }

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, self.config.latency, 1_u64);
        facts.figure("mip_selections", self.state.counters.selections, "pixels", "Pixels for which a level was selected");
        if self.config.mode != MipMode::Off {
            facts.hardware(HardwareKind::Multiplier, "du, dv by the size", 2_u32, LEVEL_BITS);
            facts.hardware(HardwareKind::Adder, "the larger of two, clamp", 2_u32, LEVEL_BITS);
            facts.hardware(HardwareKind::Table, "fraction of the logarithm", 1_u32 << FRACTION_BITS, FRACTION_BITS);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_halves_u_and_v_as_often_as_a_pixel_has_texels() {
        let of = |gradient, mode| level(gradient, [256.0, 64.0], 8.0, mode);
        for (texels, expected) in [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (2.0, 1.0), (8.0, 3.0), (256.0, 8.0), (1e9, 8.0)] {
            assert_eq!(of([texels / 256.0, 0.0], MipMode::Trilinear), expected);
            assert_eq!(of([0.0, -texels / 64.0], MipMode::Trilinear), expected);
            assert_eq!(of([texels / 256.0, texels / 64.0], MipMode::Nearest), expected);
            assert_eq!(of([texels / 256.0, 0.0], MipMode::Off), 0.0);
        }
        assert_eq!(of([3.0 / 256.0, 0.0], MipMode::Nearest), 2.0, "log2(3) is 1.58");
        assert!((of([3.0 / 256.0, 0.0], MipMode::Trilinear) - 1.584_962_5).abs() < 1e-6);
        assert_eq!(of([f32::NAN, f32::NAN], MipMode::Trilinear), 0.0);
    }
}
