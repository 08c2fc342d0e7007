//! MIP-map selector (320).

use crate::config::{MipConfig, MipMode};
use crate::signals::{GradientPacket, LevelPacket};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use basrelief_signals::{Control, Flow, Texture};
use serde::{Deserialize, Serialize};

/// Bits of the fraction of a level, and of the address that looks it up.
const FRACTION_BITS: u32 = 8;
/// Width of a level: 4 bits, and the fraction.
const LEVEL_BITS: u32 = 4 + FRACTION_BITS;

/// Counters of the MIP-map selector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MipMapSelectorCounters {
    /// Levels selected, one for each run of equal gradients.
    pub selections: u64,
}

/// State of the MIP-map selector between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MipMapSelectorState {
    /// Width and height of level 0 of the polygon's texture \[texels\].
    pub size: [f32; 2],
    /// Number of the texture's last level.
    pub last: f32,
    /// Counters.
    pub counters: MipMapSelectorCounters,
}

/// MIP-map selector (320): takes gradients and emits map selects (claim 9).
///
/// `level = log2(max(|du/dx|, |dv/dx|))` in texels of level 0 per pixel, clamped to the pyramid. A gradient of zero gives level
/// 0. (Derived: maps halve u and v from level to level, so that at this level a pixel is one texel wide.)
#[derive(Clone, Debug, Default)]
pub struct MipMapSelector {
    /// Parameters.
    pub config: MipConfig,
    /// State between steps.
    pub state: MipMapSelectorState,
}

/// Returns the level for this change of u, v per pixel, in a texture of this size whose last level is `last`.
pub fn level([du, dv]: [f32; 2], [width, height]: [f32; 2], last: f32, mode: MipMode) -> f32 {
    let texels = (du.abs() * width).max(dv.abs() * height);
    // Up to one texel per pixel the level is the finest. NaN fails both comparisons.
    let level = if texels > 1.0 { libm::log2f(texels).min(last) } else { 0.0 };
    match mode {
        MipMode::Off => 0.0,
        // Half way between two levels it is the finer one, as in OpenGL.
        MipMode::Nearest => ((level + 0.5).ceil() - 1.0).clamp(0.0, last),
        MipMode::Trilinear => level,
    }
}

impl MipMapSelector {
    /// Creates a MIP-map selector in its power-on state.
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
    basrelief_kernel::unit_info!("selects a level by du, dv");
    type In = Option<Flow<GradientPacket>>;
    type Out = Option<Flow<LevelPacket>>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
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

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.config.latency, 1_u64);
        stats.figure("mip_selections", self.state.counters.selections, "pixels", "Pixels for which a level was selected");
        if self.config.mode != MipMode::Off {
            stats.hardware(HardwareKind::Multiplier, "du, dv by the size", 2_u32, LEVEL_BITS);
            stats.hardware(HardwareKind::Adder, "the larger of two, clamp", 2_u32, LEVEL_BITS);
            stats.hardware(HardwareKind::Table, "fraction of the logarithm", 1_u32 << FRACTION_BITS, FRACTION_BITS);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Claim: as claim_9_level_is_constant_per_segment.
    #[test]
    fn level_is_log2_of_texels_per_pixel() {
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
