//! Texture mapping system with the texel value generator (Sun Microsystems, 1994).
//!
//! Figure 3, as wired by [`TextureMappingSystem`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod machine;
mod memories;
mod spec;

pub use crate::config::ClockConfig;
pub use crate::front::{FrontEnd, SceneFront, TraceFront};
pub use crate::problem::ConfigProblem;
pub use basrelief_texel_value_generator::{DisplacementMap, FrameLog, SpanRecord};
pub use check::warnings;
pub use config::{CacheConfigs, FifoConfigs, MemoryConfigs, PixelValueBufferConfig, TexelMachineConfig};
pub use machine::TextureMappingSystem;
pub use spec::TexelLog;

/// Name of the machine.
pub const NAME: &str = "texel";

/// Figure 3 as text.
pub const DIAGRAM: &str = include_str!("diagram.txt");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PictureMachine as _;
    use basrelief_kernel::{Hardware, HardwareKind};

    fn hardware(settings: &[(&str, &str)]) -> Vec<Hardware> {
        let config: TexelMachineConfig = basrelief_parameters::load("", settings).unwrap();
        let front = SceneFront::new(std::iter::empty(), &config);
        TextureMappingSystem::new(front, &config).unwrap().facts().all_hardware().to_vec()
    }

    fn count(all: &[Hardware], place: &str, kind: HardwareKind) -> u64 {
        all.iter().filter(|h| h.place == place && h.kind == kind).map(|h| h.count).sum()
    }

    /// Widest operator of this kind in a unit \[bits\].
    fn width(all: &[Hardware], place: &str, kind: HardwareKind) -> u32 {
        all.iter().filter(|h| h.place == place && h.kind == kind).map(|h| h.width).max().unwrap_or_default()
    }

    #[test]
    fn hardware_of_generator_follows_parameters() {
        use HardwareKind::{Adder, Divider, Multiplier, SquareRoot, Table};
        let all = hardware(&[]);
        for unit in ["step-calculator", "approximate-calculator", "texture-look-up", "illuminance", "combiner", "depth-test"] {
            assert!(count(&all, unit, Adder) + count(&all, unit, Multiplier) > 0, "{unit}");
        }
        // The patent saves divisions, so the hardware of the dividers must follow from the parameters.
        assert_eq!((count(&all, "divider", Divider), width(&all, "divider", Divider)), (2, 29));
        let many = hardware(&[("divider.count", "5"), ("texel.coordinate_bits", "33")]);
        assert_eq!((count(&many, "divider", Divider), width(&many, "divider", Divider)), (5, 33));
        let reciprocal = hardware(&[("divider.division", "reciprocal")]);
        assert!(count(&reciprocal, "divider", Multiplier) > count(&all, "divider", Multiplier));
        // The step calculator has the hardware of its equation only with the adaptive method.
        let steps = |all: &[Hardware]| [Divider, SquareRoot, Table].map(|kind| count(all, "step-calculator", kind));
        assert_eq!(steps(&all), [1, 1, 0]);
        assert_eq!(steps(&hardware(&[("texel.step_table", "256")])), [1, 0, 256]);
        assert_eq!(steps(&hardware(&[("texel.method", "fixed")])), [0, 0, 0]);
        let short = hardware(&[("texel.longest_segment", "64")]);
        assert_eq!([&all, &short].map(|all| count(all, "approximate-calculator", Table)), [1024, 64]);
        let mip = |per| hardware(&[("mip.mode", "trilinear"), ("mip.per", per)]);
        assert_eq!(["segment", "pixel"].map(|per| count(&mip(per), "approximate-calculator", Divider)), [0, 1]);
        let filters = |samples| count(&hardware(&[("look_up.samples_per_cycle", samples)]), "texture-look-up", Multiplier);
        assert!(filters("2") > filters("1"));
    }

    fn without_depth_test() -> TexelMachineConfig {
        let mut config = TexelMachineConfig::default();
        config.pixel_value_buffer.depth_test = false;
        config
    }

    crate::unit_info::diagram_tests!(TextureMappingSystem, [TexelMachineConfig::default(), without_depth_test()]);
}
