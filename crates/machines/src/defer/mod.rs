//! Rate-limited renderer (HP, 1998; JP 2000-057370).
//!
//! Figure 1, as wired by [`DeferredRenderer`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod leaving;
mod machine;
mod memories;
mod spec;

pub use crate::config::ClockConfig;
pub use crate::front::{FrontEnd, SceneFront, TraceFront};
pub use crate::problem::ConfigProblem;
pub use check::warnings;
pub use config::{CacheConfigs, DeferConfig, FifoConfigs, MemoryConfigs};
pub use leaving::RunAhead;
pub use machine::DeferredRenderer;
pub use spec::DeferLog;

/// Name of the machine.
pub const NAME: &str = "defer";

/// Figure 1 as text.
pub const DIAGRAM: &str = include_str!("diagram.txt");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PictureMachine as _;
    use basrelief_kernel::HardwareKind;

    crate::unit_info::diagram_tests!(DeferredRenderer, [DeferConfig::default()]);

    #[test]
    fn units_behind_the_path_report_their_hardware() {
        let mut config = DeferConfig::default();
        config.defer.mode = basrelief_deferred_renderer::RenderMode::Progressive;
        config.tile.encoding = basrelief_deferred_renderer::TileEncoding::Jpeg;
        let front = SceneFront::new(std::iter::empty(), &config);
        let facts = DeferredRenderer::new(front, &config).unwrap().facts();
        let of = |unit: &str| facts.all_hardware().iter().filter(|h| h.place == unit).collect::<Vec<_>>();
        let holds = |unit: &str, kind| of(unit).iter().filter(|h| h.kind == kind).map(|h| h.bits()).sum::<u64>();
        let counts = |unit: &str, kind| of(unit).iter().filter(|h| h.kind == kind).map(|h| h.count).sum::<u64>();
        let computes =
            ["expander", "cells", "reference-buffer", "identification", "tile-lists", "final-rasterization", "pixel-buffer"];
        for unit in computes {
            assert!(counts(unit, HardwareKind::Adder) > 0, "{unit}");
        }
        let tile = 64 * 64 * 24;
        assert_eq!(holds("path", HardwareKind::Table), 8 * tile, "one receive buffer per request in flight");
        assert_eq!(holds("expander", HardwareKind::LineBuffer), 3 * tile, "two wait, one is expanded");
        assert_eq!(holds("tile-lists", HardwareKind::Table), 2 * (1 << 30) / (4 * 64 * 64), "two bits a tile");
        assert_eq!((counts("cells", HardwareKind::Divider), counts("cells", HardwareKind::Power)), (17 + 1, 0));
        let tables = |about: &str| facts.all_hardware().iter().filter(|h| h.about.starts_with(about)).count();
        assert_eq!(["pages (132)", "layers: size"].map(tables), [1, 1], "both passes use the same tables");
        assert_eq!(holds("final-rasterization", HardwareKind::Registers) / 16 / 128, 1, "a block of cells");
    }
}
