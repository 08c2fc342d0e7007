//! Units of the machines: wiring against block diagram, roles, source files and hardware.

use super::connections::DiagramConnections;
use crate::common::{config, replay, run, scene_front};
use basrelief_kernel::{Engine, Hardware, HardwareKind, MemoryReport, StageTopology, topology};
use basrelief_machines::bump::{BumpProcessor, BumpProcessorConfig};
use basrelief_machines::defer::{DeferConfig, DeferredRenderer};
use basrelief_machines::shade::{FigureShadingDevice, ShadeConfig};
use basrelief_machines::texel::{TexelMachineConfig, TextureMappingSystem};
use basrelief_machines::{MachineSpec, PictureMachine, UnitInfo, bump, defer, shade, texel, units};
use basrelief_signals::Scene;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Wiring of a machine under one configuration.
struct MachineWiring {
    stages: Vec<StageTopology>,
    memories: Vec<MemoryReport>,
}

impl MachineWiring {
    fn of(mut machine: impl PictureMachine) -> Self {
        Self { stages: topology(&mut machine), memories: run(machine, Engine::Timed).report.memories }
    }

    /// Returns producer, FIFO and consumer of each edge.
    fn fifos(&self) -> impl Iterator<Item = [String; 3]> + '_ {
        let from = self.stages.iter().flat_map(|stage| stage.outputs.iter().map(move |fifo| (&stage.name, fifo)));
        from.flat_map(|(producer, fifo)| {
            let to = self.stages.iter().filter(move |stage| stage.inputs.contains(fifo));
            to.map(move |consumer| [producer.clone(), fifo.clone(), consumer.name.clone()])
        })
    }

    /// Returns unit, client and memory of each memory port. A periodic client has no unit.
    fn clients(&self) -> impl Iterator<Item = [String; 3]> + '_ {
        let from = self.stages.iter().flat_map(|stage| stage.clients.iter().map(move |client| (stage.name.as_str(), client)));
        let ports = self.memories.iter().flat_map(|memory| &memory.ports);
        let periodic = ports.filter(|port| port.periodic.is_some()).map(|port| ("", &port.client));
        from.chain(periodic).flat_map(|(unit, client)| {
            let to = self.memories.iter().filter(move |memory| memory.ports.iter().any(|port| port.client == *client));
            to.map(move |memory| [unit.to_owned(), client.clone(), memory.name.clone()])
        })
    }
}

/// Asserts that `units` are exactly the wired stages, and that the diagram shows exactly these units, their FIFOs and their memory clients.
fn assert_diagram_matches_wiring(drawing: &str, units: &[UnitInfo], all: &[MachineWiring]) {
    let wired: BTreeSet<&str> = all.iter().flat_map(|w| &w.stages).map(|s| s.name.as_str()).collect();
    assert_eq!(units.iter().map(|u| u.name.as_str()).collect::<BTreeSet<_>>(), wired);
    let wiring = DiagramConnections {
        units: units.iter().map(|u| (u.name.clone(), u.numeral.clone())).collect(),
        fifos: all.iter().flat_map(MachineWiring::fifos).collect(),
        clients: all.iter().flat_map(MachineWiring::clients).collect(),
    };
    assert_eq!(DiagramConnections::read(drawing).unwrap(), wiring);
}

/// Asserts that every unit has a role, and that its source file contains it.
fn assert_units_have_roles_and_files(units: &[UnitInfo]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for unit in units {
        assert!(!unit.role.is_empty(), "{} has no role!", unit.name);
        let code = std::fs::read_to_string(root.join(&unit.code)).unwrap_or_else(|e| panic!("{}: {e}", unit.code));
        assert!(code.contains(&format!("unit_info!(\"{}\")", unit.role)), "{} is not in {}", unit.name, unit.code);
    }
}

/// Tests of a machine's units and block diagram: `diagram_tests!(Machine, Config, DIAGRAM, [settings, ...])`. The stages are those of all
/// configurations, with both front ends. The first configuration is the default.
macro_rules! diagram_tests {
    ($test_of:ident, $machine:ident, $config:ty, $diagram:expr, [$($settings:expr),+]) => {
        mod $test_of {
            use super::*;

            fn all_units() -> Vec<UnitInfo> {
                let config: $config = config(&[]);
                let scene = Arc::new(Scene::default());
                let mut of_scene = $machine::new(scene_front(&scene, &config), &config).unwrap();
                let mut of_trace = $machine::new(replay(&[], &config), &config).unwrap();
                units($diagram, &mut of_scene, &mut of_trace)
            }

            #[test]
            fn diagram_matches_wiring() {
                let wirings = |settings: &[(&str, &str)]| {
                    let config: $config = config(settings);
                    let scene = Arc::new(Scene::default());
                    let of_scene = $machine::new(scene_front(&scene, &config), &config).unwrap();
                    let of_trace = $machine::new(replay(&[], &config), &config).unwrap();
                    [MachineWiring::of(of_scene), MachineWiring::of(of_trace)]
                };
                let all = [$(wirings($settings)),+].into_iter().flatten().collect::<Vec<_>>();
                assert_diagram_matches_wiring($diagram, &all_units(), &all);
            }

            #[test]
            fn every_unit_has_a_role_and_a_source_file() {
                assert_units_have_roles_and_files(&all_units());
            }
        }
    };
}

diagram_tests!(of_bump, BumpProcessor, BumpProcessorConfig, bump::DIAGRAM, [&[], &[("rasterizer.early_z", "false")]]);
diagram_tests!(of_shade, FigureShadingDevice, ShadeConfig, shade::DIAGRAM, [&[], &[("frame_memory.depth_test", "false")]]);
diagram_tests!(
    of_texel,
    TextureMappingSystem,
    TexelMachineConfig,
    texel::DIAGRAM,
    [&[], &[("pixel_value_buffer.depth_test", "false")]]
);
diagram_tests!(of_defer, DeferredRenderer, DeferConfig, defer::DIAGRAM, [&[]]);

fn hardware(settings: &[(&str, &str)]) -> Vec<Hardware> {
    let config: TexelMachineConfig = config(settings);
    TextureMappingSystem::new(replay(&[], &config), &config).unwrap().facts().all_hardware().to_vec()
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

/// Names of the ports, caches and displays that a machine has.
fn ports<C: MachineSpec>(settings: &[(&str, &str)]) -> BTreeSet<String> {
    let kinds = [HardwareKind::CacheData, HardwareKind::LineBuffer, HardwareKind::RequestTable];
    let hardware = config::<C>(settings).hardware().unwrap();
    hardware.into_iter().filter(|piece| kinds.contains(&piece.kind)).map(|piece| piece.place).collect()
}

#[test]
fn hardware_that_no_step_uses_is_not_counted() {
    let lost = |all: BTreeSet<String>, rest: BTreeSet<String>| all.difference(&rest).cloned().collect::<Vec<_>>();
    let depth = ["depth", "z_read", "z_write"];
    assert_eq!(lost(ports::<ShadeConfig>(&[]), ports::<ShadeConfig>(&[("frame_memory.depth_test", "false")])), depth);
    let untested = ports::<TexelMachineConfig>(&[("pixel_value_buffer.depth_test", "false")]);
    assert_eq!(lost(ports::<TexelMachineConfig>(&[]), untested), depth);
    let modulated = ports::<TexelMachineConfig>(&[("combiner.mode", "modulate")]);
    assert_eq!(lost(modulated, ports::<TexelMachineConfig>(&[])), ["pixel_read"]);
    let bump = |key, value| lost(ports::<BumpProcessorConfig>(&[(key, value)]), ports::<BumpProcessorConfig>(&[]));
    assert_eq!(bump("graphics.draw", "after_list"), ["held"]);
    assert_eq!(bump("replacement.codebook", "per_object"), ["gathered"]);
    assert_eq!(lost(ports::<ShadeConfig>(&[]), ports::<ShadeConfig>(&[("display.enabled", "false")])), ["scan_out"]);
    let blends = |levels| {
        let config: BumpProcessorConfig = config(&[("brightness.levels", levels)]);
        config.hardware().unwrap().iter().any(|piece| piece.about == "sum of levels")
    };
    assert_eq!(["1", "2"].map(blends), [false, true]);
}

#[test]
fn polygons_wait_with_their_vertices() {
    let slot = |hardware: Vec<Hardware>| hardware.into_iter().find(|piece| piece.place == "polygons").unwrap().width;
    // Token; head of three words; for each corner a position, and attributes that the machine accepts.
    let bits = |attributes: u32| 32 + 8 * (12 + 3 * (16 + attributes));
    let bump: BumpProcessorConfig = config(&[]);
    assert_eq!(slot(bump.hardware().unwrap()), bits(12 + 24 + 8 + 4 + 8), "normal, tangents, texture, colour, brightness");
    let shade: ShadeConfig = config(&[]);
    assert_eq!(slot(shade.hardware().unwrap()), bits(12 + 4), "normal, colour");
}

#[test]
fn display_holds_two_reads() {
    let config: ShadeConfig = config(&[("display.burst_bytes", "512")]);
    let hardware = config.hardware().unwrap();
    let bits: u64 = hardware.iter().filter(|piece| piece.place == "scan_out").map(Hardware::bits).sum();
    assert_eq!(bits, 2 * 512 * 8);
}

#[test]
fn units_behind_the_path_report_their_hardware() {
    let mut config = DeferConfig::default();
    config.defer.mode = basrelief_deferred_renderer::RenderMode::Progressive;
    config.tile.encoding = basrelief_deferred_renderer::TileEncoding::Jpeg;
    let facts = DeferredRenderer::new(replay(&[], &config), &config).unwrap().facts();
    let of = |unit: &str| facts.all_hardware().iter().filter(|h| h.place == unit).collect::<Vec<_>>();
    let holds = |unit: &str, kind| of(unit).iter().filter(|h| h.kind == kind).map(|h| h.bits()).sum::<u64>();
    let counts = |unit: &str, kind| of(unit).iter().filter(|h| h.kind == kind).map(|h| h.count).sum::<u64>();
    let computes = ["expander", "cells", "reference-buffer", "tile-lists", "final-rasterization", "pixel-buffer"];
    for unit in computes {
        assert!(counts(unit, HardwareKind::Adder) > 0, "{unit}");
    }
    assert!(of("identification").is_empty(), "only the mode of best resolution uses it");
    let tile = 64 * 64 * 24;
    assert_eq!(holds("path", HardwareKind::Table), 8 * tile, "one receive buffer per request in flight");
    assert_eq!(holds("expander", HardwareKind::LineBuffer), 3 * tile, "two wait, one is expanded");
    assert_eq!(holds("tile-lists", HardwareKind::Table), 2 * (1 << 30) / (4 * 64 * 64), "two bits a tile");
    assert_eq!((counts("cells", HardwareKind::Divider), counts("cells", HardwareKind::Power)), (17 + 1, 0));
    let tables = |about: &str| facts.all_hardware().iter().filter(|h| h.about.starts_with(about)).count();
    assert_eq!(["pages (132)", "layers: size"].map(tables), [1, 1], "both passes use the same tables");
    assert_eq!(holds("final-rasterization", HardwareKind::Registers) / 16 / 128, 1, "a block of cells");
}
