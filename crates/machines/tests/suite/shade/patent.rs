//! Statements of the patent about the whole device: paths, shortcuts, buffers, and their costs.

use crate::common::covered_by_bump;
use crate::shade::recipe::{display_lists, frame, material, object, polygon, sun, unit};
use crate::shade::runs::{Ran, config, machine, replay, run, small_demo, timed};
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::{Engine, Hardware, HardwareKind, MemoryPorts, Unit};
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_machines::shade::warnings;
use basrelief_machines::{FrontConfig, MachineEngines as _};
use basrelief_signals::{Control, Draw, Lighting, Material, Polygon};
use proptest::prelude::*;
use std::sync::Arc;

const SQUARE: [[f32; 3]; 4] = [[2.0, 2.0, 0.5], [34.0, 2.0, 0.5], [34.0, 26.0, 0.5], [2.0, 26.0, 0.5]];

/// A frame of `count` equal squares, one behind the other, with these normals.
fn squares(count: usize, normals: [[f32; 3]; 4]) -> Vec<Control> {
    let material = material(Lighting { n: 50.0, ..Lighting::default() });
    let square = |i| polygon(&SQUARE.map(|[x, y, _]| [x, y, 0.1 + 0.01 * i as f32]), &normals.map(unit), &material);
    let begin = [frame(0, [40, 30], vec![sun([0.0, 0.0, 1.0], 1.0)]), object(0)];
    begin.into_iter().chain((0..count).map(square)).chain([Control::FrameEnd]).collect()
}

/// Normals of four kinds of polygons: a highlight in the middle, a highlight everywhere, no highlight, and flat.
const SHINY: [[f32; 3]; 4] = [[-0.1, 0.0, 1.0], [0.1, 0.0, 1.0], [0.1, 0.1, 1.0], [-0.1, 0.1, 1.0]];
const DULL: [[f32; 3]; 4] = [[0.9, 0.0, 0.1], [0.8, 0.0, 0.1], [0.8, 0.1, 0.1], [0.9, 0.1, 0.1]];
const FLAT: [[f32; 3]; 4] = [[0.1, 0.0, 1.0]; 4];

const DOTS: u64 = 32 * 24;

/// All polygons and dots take this path.
fn assert_path(ran: &Ran, path: &str, polygons: u64) {
    assert_eq!(ran.count(&format!("polygons_{path}")), polygons, "{path}");
    assert_eq!(ran.count(&format!("dots_{path}")), polygons * DOTS, "{path}");
}

// Claim: as claim_1_registers_select_brightness_source.
#[test]
fn section_6_the_six_paths() {
    for (normals, settings, path) in [
        (SHINY, &[("shade.mode", "polyhedron")][..], "polyhedron"),
        (SHINY, &[("shade.mode", "brightness")], "brightness"),
        (SHINY, &[], "normal"),
        (DULL, &[], "gate_closed"),
        (FLAT, &[], "flat"),
        (FLAT, &[("shade.mode", "brightness"), ("shade.flat_in_brightness_mode", "true")], "flat"),
    ] {
        assert_path(&timed(&squares(3, normals), settings), path, 3);
    }
    let plane = |_| squares(1, FLAT)[2].clone();
    let list = [squares(1, FLAT)[..2].to_vec(), (0..3).map(plane).collect(), vec![Control::FrameEnd]].concat();
    let ran = timed(&list, &[("frame_memory.depth_test", "false")]);
    assert_path(&ran, "flat", 1);
    assert_path(&ran, "reused", 2);
}

// Claim: shade, six routes: Each route costs less than the full one. The power is the bottleneck of the full route. Full normal
// interpolation gives the same image within one step.
#[test]
fn each_path_costs_less_than_the_full_path() {
    let total = |normals, settings: &[(&str, &str)]| timed(&squares(8, normals), settings).report.total;
    let full = total(SHINY, &[]);
    assert!(total(DULL, &[]) < full);
    assert!(total(SHINY, &[("shade.mode", "brightness")]) < full);
    assert!(total(SHINY, &[("shade.mode", "polyhedron")]) < full);
    // A flat polygon takes the mean, and a polygon on the same plane as the previous one reuses its result.
    let flat = total(FLAT, &[]);
    assert!(flat < total(FLAT, &[("shortcut.flatness.enabled", "false")]));
    let on_one_plane = ("shortcut.same_plane.constant_tolerance", "1");
    assert!(total(FLAT, &[on_one_plane]) < flat);
}

// Claim: as register_18_closes_gate_or_skips_circuit_50.
#[test]
fn short_cut_1_only_not_starting_circuit_50_saves_cycles() {
    let run = |settings: &[(&str, &str)]| timed(&squares(8, DULL), settings);
    let off = run(&[("shortcut.specular_negligible.enabled", "false")]);
    let gate = run(&[("shade.specular_skip", "gate")]);
    let no_start = run(&[]);
    assert_eq!(gate.frames, no_start.frames);
    assert!(gate.difference(&off) <= 1);
    assert_eq!((gate.count("gate_blocked"), gate.count("gate_passed")), (8 * DOTS, 0));
    assert_eq!(gate.count("normal_interpolation_needed_cycles"), 0);
    assert!(gate.count("normal_interpolation_started_cycles") > 0);
    assert_eq!(no_start.count("normal_interpolation_started_cycles"), 0);
    assert_eq!(off.count("normal_interpolation_needed_cycles"), off.count("normal_interpolation_started_cycles"));
    assert!(no_start.report.total < gate.report.total, "{} {}", no_start.report.total, gate.report.total);
}

// Claim: as polygon_waits_for_a_free_buffer.
#[test]
fn second_buffer_overlaps_transfer_and_drawing() {
    let run = |buffers| timed(&squares(8, SHINY), &[("host.buffers", buffers)]);
    let (single, double) = (run("1"), run("2"));
    assert_eq!(single.frames, double.frames);
    assert!(double.report.total < single.report.total);
    for (ran, buffers) in [(&single, 1), (&double, 2)] {
        let fifo = ran.report.fifos.iter().find(|f| f.name == "normals").expect("wired");
        assert!(fifo.high_water() < buffers.max(2), "{} polygons wait in front of circuit (50)", fifo.high_water());
    }
}

// Claim: as each_path_costs_less_than_the_full_path.
#[test]
fn the_power_of_circuit_50_limits_the_full_path() {
    let total = |settings: &[(&str, &str)]| timed(&squares(8, SHINY), settings).report.total;
    let iteration = total(&[]);
    // n = 50: five squarings and two products, of two cycles each.
    assert!(iteration >= 8 * DOTS * 14);
    assert!(total(&[("operators.multiply.latency", "4")]) >= 8 * DOTS * 28);
    assert!(total(&[("normal_interpolation.pipelined", "true")]) < iteration / 4);
    let table = timed(&squares(8, SHINY), &[("normal_interpolation.power", "table")]);
    assert!(table.report.total < iteration / 3, "though 1024 entries take seven multiplications each");
    assert_eq!(table.count("power_table_fills"), 1);
}

// Claim: as each_path_costs_less_than_the_full_path.
#[test]
fn full_normal_interpolation_draws_the_same_picture() {
    let run = |normals, settings: &[(&str, &str)]| timed(&squares(8, normals), settings);
    let full = [
        ("normal_interpolation.inner_products", "2"),
        ("shortcut.specular_negligible.enabled", "false"),
        ("shortcut.flatness.enabled", "false"),
    ];
    let table = ("normal_interpolation.power", "table");
    for power in [&[][..], &[table]] {
        let [shiny, dull] = [SHINY, DULL].map(|normals| (run(normals, power), run(normals, &[&full[..], power].concat())));
        for (hybrid, full) in [&shiny, &dull] {
            assert!(hybrid.difference(full) <= 1);
            let decisions = hybrid.count("process_15_cycles") + hybrid.count("process_17_cycles");
            let cpu = hybrid.report.units.iter().find(|unit| unit.name == "microcomputer").expect("a CPU");
            let waits: u64 = cpu.account.memory.iter().sum();
            assert!(hybrid.report.total <= full.report.total + decisions + waits, "a decision waits for its operands");
        }
        assert!(dull.0.report.total < dull.1.report.total);
    }
    let pipelined = |products| {
        let settings = [("normal_interpolation.inner_products", products), table];
        run(SHINY, &settings).count("normal_interpolation_started_cycles")
    };
    assert_eq!(pipelined("2") - pipelined("1"), 8 * DOTS, "a cycle more per dot");
}

// Claim: as each_path_costs_less_than_the_full_path.
#[test]
fn each_light_occupies_circuit_50_and_process_22_again() {
    let run = |lights: usize| {
        let mut list = squares(8, SHINY);
        list[0] = frame(0, [40, 30], vec![sun([0.0, 0.0, 1.0], 0.5); lights]);
        timed(&list, &[])
    };
    for lights in 1..4 {
        let ran = run(lights);
        // Set-up of two triangles of 21 sums, 14 cycles per power, and the end.
        let started = 8 * (2 * 21 + DOTS * 14 * lights as u64 + 1);
        assert_eq!(ran.count("normal_interpolation_started_cycles"), started);
        // Four points: normal, Kd, Ka*Ia and colour; per light L and Is, an inner product, a comparison, a product and a sum.
        assert_eq!(ran.count("process_22_cycles"), 8 * 4 * (27 + 33 * lights as u64));
    }
}

// Claim: as coverage_is_that_of_the_rasterizer_in_every_mode.
#[test]
fn without_a_depth_test_the_last_dot_stays() {
    let colour = |ks| material(Lighting { ka: 1.0, kd: 0.0, ks, n: 1.0 });
    let square = |z: f32, ks| polygon(&SQUARE.map(|[x, y, _]| [x, y, z]), &FLAT.map(unit), &colour(ks));
    let begin = frame(0, [40, 30], vec![sun([0.0, 0.0, 1.0], 1.0)]);
    let list = [begin, object(0), square(0.2, 1.0), square(0.7, 0.0), Control::FrameEnd];
    let blue = |settings: &[(&str, &str)]| timed(&list, settings).frames[0].rgb[15 * 40 + 20][2];
    assert_eq!(blue(&[]), 255, "the near one, with its highlight");
    assert_eq!(blue(&[("frame_memory.depth_test", "false")]), 77, "0.3 of the base colour");
}

#[test]
fn unsupported_input_is_a_warning() {
    let mut list = squares(2, FLAT);
    assert_eq!(warnings(&timed(&list, &[]).facts), [""; 0], "defaults hold full rate");
    let short = warnings(&timed(&list, &[("fifo.interpolated.depth", "2")]).facts);
    assert!(short.len() == 1 && short[0].contains("fifo.interpolated.depth = 2"), "{short:?}");
    let Control::Polygon(first) = &list[2] else { unreachable!() };
    let texture = Arc::new(basrelief_signals::Texture {
        id: 0,
        name: "t".into(),
        sampler: Default::default(),
        levels: Vec::new(),
        offset: 0,
        elsewhere: None,
    });
    let material = Arc::new(Material { color_texture: Some(texture), ..Material::clone(&first.material) });
    let line = Polygon { vertices: first.vertices[..2].to_vec(), ..Polygon::clone(first) };
    list[2] = Control::Polygon(Arc::new(Polygon { material, ..Polygon::clone(first) }));
    list.insert(2, Control::Polygon(Arc::new(line)));
    let said = warnings(&timed(&list, &[]).facts);
    assert!(said[0].contains("1 polygons have a colour texture") && said[1].contains("1 polygons have fewer"), "{said:?}");
}

// Claim: as process_cycles_follow_cpu_table.
#[test]
fn renormalising_costs_circuit_50_cycles() {
    let run = |settings: &[(&str, &str)]| timed(&squares(8, SHINY), settings);
    let pipelined = ("normal_interpolation.pipelined", "true");
    let started = |ran: &Ran| ran.count("normal_interpolation_started_cycles");
    let (plain, unit) = (run(&[pipelined]), run(&[pipelined, ("shade.renormalise", "true")]));
    assert_eq!(started(&unit) - started(&plain), 8 * DOTS * 10, "a square root of 11 cycles in place of a cycle");
    assert!(unit.report.total > plain.report.total + 8 * DOTS * 9);
}

// Claim: as registers_14_16_18_set_the_passing_polygon.
#[test]
fn memory_12_and_the_registers_show_in_the_report() {
    let ran = timed(&squares(8, SHINY), &[]);
    let local = ran.report.memories.iter().find(|m| m.name == "local").expect("wired");
    let bytes = |name: &str| {
        let port = local.ports.iter().find(|p| p.client == name).expect("wired");
        (port.counts.read_bytes, port.counts.write_bytes)
    };
    let (read, written) = bytes("host_write");
    assert!(read == 0 && written >= 8 * 4 * 25, "{written}");
    assert!(bytes("cpu").0 > written, "a number is read more often than once");
    let registers = ran.report.units.iter().find(|u| u.name == "registers").expect("wired");
    // The mode once; two registers per polygon; the polygons themselves, the frame and its end.
    assert_eq!(registers.account.busy, 1 + 2 * 8 + 8 + 2);
    let writes = ["register_14_writes", "register_16_writes", "register_18_writes"];
    assert_eq!(writes.map(|name| ran.count(name)), [1, 8, 8]);
}

#[test]
fn a_slower_cpu_takes_longer_and_draws_the_same() {
    let runs = ["1", "5", "40"].map(|scale| timed(&squares(8, DULL), &[("cpu.scale", scale)]));
    assert!(runs.iter().all(|ran| ran.frames == runs[0].frames));
    assert!(runs.is_sorted_by_key(|ran| ran.report.total));
    assert_eq!(runs[2].count("process_15_cycles"), 40 * runs[0].count("process_15_cycles"));
}

/// Units of the device between the host computer (100) and the frame memory (300).
const CIRCUITS: [&str; 9] = [
    "host-interface",
    "microcomputer",
    "registers",
    "interpolation",
    "normal-interpolation",
    "gate",
    "adder",
    "selector-53",
    "selector-28",
];

#[test]
fn hardware_of_circuits_follows_parameters() {
    let hardware = |settings: &[(&str, &str)]| {
        let config = config(settings);
        machine(replay(&[], &config), &config).unit_stats().all_hardware().to_vec()
    };
    let all = hardware(&[]);
    for circuit in CIRCUITS {
        assert!(all.iter().any(|h| h.place == circuit), "{circuit}");
    }
    let count = |all: &[Hardware], place: &str, kind| {
        all.iter().filter(|h| h.place == place && h.kind == kind).map(|h| h.count).sum::<u64>()
    };
    let of_50 = |settings: &[(&str, &str)], kind| count(&hardware(settings), "normal-interpolation", kind);
    assert_eq!(count(&all, "adder", HardwareKind::Adder), 3);
    assert_eq!(count(&hardware(&[("adder.initiation_interval", "3")]), "adder", HardwareKind::Adder), 1);
    let multipliers = |settings: &[(&str, &str)]| of_50(settings, HardwareKind::Multiplier);
    assert_eq!(multipliers(&[("normal_interpolation.pipelined", "true")]) - multipliers(&[]), 17);
    assert_eq!(of_50(&[], HardwareKind::SquareRoot), 0);
    assert_eq!(of_50(&[("shade.renormalise", "true")], HardwareKind::SquareRoot), 1);
    let table = ("normal_interpolation.power", "table");
    assert_eq!(multipliers(&[table]) - multipliers(&[]), 1, "one to the address, one to fill it");
    assert_eq!(of_50(&[table], HardwareKind::Table), 1024);
    let bits = |all: &[Hardware], place: &str| all.iter().filter(|h| h.place == place).map(Hardware::bits).sum::<u64>();
    assert_eq!(bits(&all, "registers"), 2 + 1 + 1);
    assert!(bits(&hardware(&[("host.buffers", "2")]), "microcomputer") > bits(&all, "microcomputer"));
}

/// Returns the display list of a demo on the bump-mapping processor.
fn recorded(demo: &str) -> Vec<Control> {
    let mut geometry = FrontConfig::from(&BumpProcessorConfig::default()).geometry_processor();
    let draws = SceneDraws::new(small_demo(demo));
    draws.filter_map(|draw: Draw| geometry.step(Some(draw), &mut MemoryPorts::default()).out).collect()
}

// Claim: as replay_gives_same_image_from_any_machine.
#[test]
fn traces_of_either_machine_cover_the_same_pixels() {
    for demo in ["sphere", "mixed"] {
        let list = recorded(demo);
        let config = config(&[]);
        let ran = run(replay(&list, &config), &config, Engine::Timed);
        assert_eq!(ran.frames.iter().map(|f| f.covered.clone()).collect::<Vec<_>>(), covered_by_bump(&list));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 2, ..ProptestConfig::default() })]

    // Claim: shade, 1, memory: The selected value is stored at its address in (300). Pixels equal those of the rasterizer in every
    // mode.
    #[test]
    fn coverage_is_that_of_the_rasterizer_in_every_mode(
        list in display_lists(), mode in prop::sample::select(vec!["normal", "brightness", "polyhedron"]),
    ) {
        let ran = timed(&list, &[("shade.mode", mode)]);
        prop_assert_eq!(ran.frames.iter().map(|f| f.covered.clone()).collect::<Vec<_>>(), covered_by_bump(&list));
    }

    // Claim: shade, short cuts: At the default thresholds no output changes by more than one step, on demos and on random lists.
    #[test]
    fn shortcuts_change_outputs_by_at_most_their_rounding(list in display_lists()) {
        let whole = timed(&list, &[]);
        for cut in ["specular_negligible", "same_plane", "flatness"] {
            let key = format!("shortcut.{cut}.enabled");
            let without = timed(&list, &[(key.as_str(), "false")]);
            prop_assert!(whole.difference(&without) <= 1, "{}: {}", cut, whole.difference(&without));
        }
    }
}
