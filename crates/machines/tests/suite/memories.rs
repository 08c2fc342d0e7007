//! Memories of all machines: parts, layers of settings, and assumptions of law 4.

use basrelief_kernel::{MemoryConfig, MemoryPart};
use basrelief_machines::bump::{BumpProcessor, BumpProcessorConfig};
use basrelief_machines::defer::{DeferConfig, DeferredRenderer};
use basrelief_machines::shade::{FigureShadingDevice, ShadeConfig};
use basrelief_machines::texel::{TexelMachineConfig, TextureMappingSystem};
use basrelief_machines::{ConfigProblem, FrontConfig, FrontEnd, MACHINES};
use basrelief_parameters::{ConfigError, Parameter, Parameters, load, resolved};

fn bump(toml: &str, set: &[(&str, &str)]) -> BumpProcessorConfig {
    load(toml, set).unwrap_or_else(|e| panic!("{e}"))
}

fn graphics(toml: &str, set: &[(&str, &str)]) -> MemoryConfig {
    bump(toml, set).memory.graphics
}

#[test]
fn part_fills_values_without_a_machine_default() {
    let m = graphics("", &[("memory.graphics.part", "sdr-133")]);
    // 22.5, 20, 20 and 45 ns at 200 MHz; 64 bytes in eight clocks of 7.5 ns.
    assert_eq!([m.cl, m.rcd, m.rp, m.ras, m.burst_bytes, m.burst_cycles], [5, 4, 4, 9, 64, 12]);
    let default = graphics("", &[]);
    assert_eq!([m.channels, m.channel_bytes, m.window, m.cap, m.outstanding], [4, 256, 8, 16, 32], "a part has its window");
    assert_eq!((default.part, default.cl, default.channels), (MemoryPart::Ddr400, 3, 4));
    // Values that are not set stay.
    assert_eq!(bump("", &[("memory.graphics.part", "sdr-133")]).memory.normal_map, bump("", &[]).memory.normal_map);
}

#[test]
fn config_of_a_report_follows_another_part_and_clock() {
    for machine in MACHINES {
        let memory = machine.load("", &[]).unwrap().memories().unwrap()[0].0.clone();
        let [part, cl, channels] = ["part", "cl", "channels"].map(|field| format!("memory.{memory}.{field}"));
        let given = [(&*cl, "9"), (&*channels, "2")];
        let first = machine.load("", &given).unwrap();
        let report = serde_json::json!({"machine": machine.name, "config": first.to_value()}).to_string();
        let text = machine.config_text(report, |_| unreachable!()).unwrap();
        assert_eq!(machine.load(&text, &[]).unwrap().to_value(), first.to_value());
        for change in [(&*part, "sdr-100"), ("clock.hz", "100000000")] {
            let expected = machine.load("", &[given[0], given[1], change]).unwrap().to_value();
            assert_eq!(machine.load(&text, &[change]).unwrap().to_value(), expected, "{} {change:?}", machine.name);
        }
    }
}

#[test]
fn explicit_values_win_over_a_part_in_any_order() {
    let [part, cl] = [("memory.graphics.part", "sdr-133"), ("memory.graphics.cl", "2")];
    let set = graphics("", &[part, cl]);
    assert_eq!((set.part, set.cl, set.rcd), (MemoryPart::Sdr133, 2, 4));
    assert_eq!(graphics("", &[cl, part]), set);
    assert_eq!(graphics("[memory.graphics]\ncl = 2\npart = \"sdr-133\"", &[]), set);
    assert_eq!(graphics("[memory.graphics]\npart = \"sdr-133\"", &[cl]), set);
    assert_eq!(graphics("[memory.graphics]\ncl = 2", &[part]), set);
    // The last of several parts wins, with all its values.
    assert_eq!(graphics("[memory.graphics]\npart = \"xdr-3200\"", &[part, cl]), set);
    assert_eq!(graphics("", &[("memory.graphics.part", "ideal"), part, cl]), set);
    // The last of several values wins.
    assert_eq!(graphics("[memory.graphics]\ncl = 9", &[part, cl]), set);
}

#[test]
fn parts_follow_the_clock_and_custom_values_do_not() {
    let slow = graphics("", &[("clock.hz", "100000000")]);
    assert_eq!([slow.cl, slow.rcd, slow.ras, slow.refi, slow.burst_bytes, slow.burst_cycles], [2, 2, 4, 780, 64, 2]);
    let custom = graphics("", &[("clock.hz", "100000000"), ("memory.graphics.part", "custom")]);
    assert_eq!(custom, MemoryConfig { part: MemoryPart::Custom, ..graphics("", &[]) });
    let shade: ShadeConfig = load("[clock]\nhz = 50_000_000", &[]).unwrap();
    assert_eq!([shade.memory.frame.cl, shade.memory.frame.rfc, shade.memory.frame.refi], [2, 8, 781]);
}

#[test]
fn ideal_part_has_all_channels_unless_the_user_sets_them() {
    let ideal = graphics("", &[("memory.graphics.part", "ideal")]);
    assert_eq!([ideal.channels, ideal.window, ideal.outstanding, ideal.cl, ideal.refi], [64, 256, 4096, 0, 0]);
    assert_eq!(graphics("", &[("memory.graphics.channels", "2"), ("memory.graphics.part", "ideal")]).channels, 2);
}

#[test]
fn unfit_or_unknown_part_is_rejected_with_alternatives() {
    let error = |set: &[(&str, &str)]| load::<BumpProcessorConfig>("", set).unwrap_err();
    let unfit = error(&[("clock.hz", "3000000")]);
    assert!(matches!(&unfit, ConfigError::Unfit { key, .. } if key == "memory.graphics.part"), "{unfit}");
    assert!(unfit.to_string().contains("11.9 MHz or more") && unfit.to_string().contains("edo-60"), "{unfit}");
    let unknown = error(&[("memory.graphics.part", "ddr-500")]).to_string();
    assert!(unknown.contains("memory.graphics.part") && unknown.contains("ddr-400"), "{unknown}");
    // A part that is not used need not fit.
    let set = [("clock.hz", "3000000"), ("memory.graphics.part", "fpm-80")];
    assert_eq!(graphics("", &set).part, MemoryPart::Fpm80);
}

fn no_draws(config: impl Into<FrontConfig>) -> FrontEnd {
    FrontEnd::of_scene(std::iter::empty(), config)
}

/// Builds each machine with this setting of its memory, and passes on the error.
fn refused(field: &str, value: &str, beside: &str) -> Vec<ConfigProblem> {
    fn config<C: Parameters>(memory: &str, field: &str, value: &str, beside: &str) -> C {
        let text = format!("[memory.{memory}]\n{field} = {value}\n{beside}");
        load(&text, &[]).unwrap_or_else(|e| panic!("{e}"))
    }
    let bump: BumpProcessorConfig = config("graphics", field, value, beside);
    let shade: ShadeConfig = config("frame", field, value, beside);
    let texel: TexelMachineConfig = config("pixel", field, value, beside);
    let defer: DeferConfig = config("reference", field, value, beside);
    let problems = [
        BumpProcessor::new(no_draws(&bump), &bump).err(),
        FigureShadingDevice::new(no_draws(&shade), &shade).err(),
        TextureMappingSystem::new(no_draws(&texel), &texel).err(),
        DeferredRenderer::new(no_draws(&defer), &defer).err(),
    ];
    problems.into_iter().flatten().collect()
}

#[test]
fn invalid_memory_timing_is_rejected_with_a_hint() {
    for (field, value, beside, cure) in [
        ("refi", "17", "rfc = 14\nrcd = 3", "set it to 18 or more, or to 0"),
        ("row_bytes", "32", "burst_bytes = 64\nburst_cycles = 4", "set it to 64 or more"),
        ("channel_bytes", "32", "channels = 2\nburst_bytes = 64\nburst_cycles = 4", "set it to 64 or more"),
    ] {
        let problems = refused(field, value, beside);
        assert_eq!(problems.len(), 4, "{field}: {problems:?}");
        for problem in problems {
            assert!(problem.key.ends_with(&format!(".{field}")) && problem.message.contains(cure), "{problem}");
        }
    }
    assert!(refused("refi", "18", "rfc = 14\nrcd = 3").is_empty());
    assert!(refused("refi", "0", "rfc = 14\nrcd = 3").is_empty());
    assert!(refused("row_bytes", "64", "burst_bytes = 64\nburst_cycles = 4\nchannel_bytes = 64").is_empty());
    // One channel receives all bytes.
    assert!(refused("channel_bytes", "4", "channels = 1").is_empty());
}

fn parameter<C: Parameters>(config: &C, key: &str) -> Parameter {
    resolved(config).into_iter().find(|p| p.key == key).unwrap_or_else(|| panic!("no {key}"))
}

#[test]
fn every_memory_value_has_a_provenance() {
    let default = BumpProcessorConfig::default();
    let says = |config: &BumpProcessorConfig, key: &str, words: &[&str]| {
        let p = parameter(config, key);
        let text = format!("{}: {}", p.provenance.kind(), p.provenance.text());
        words.iter().for_each(|word| assert!(text.contains(word), "{key}: `{word}` is not in `{text}`"));
    };
    says(&default, "memory.graphics.rcd", &["derived: tRCD: 15 ns", "rounded up at 200 MHz", "JESD79"]);
    says(&default, "memory.graphics.wtr", &["derived: tWTR: 2 clocks of 200 MHz, 10 ns"]);
    says(&default, "memory.graphics.refi", &["7800 ns, rounded down"]);
    says(&default, "memory.graphics.burst_cycles", &["64 bytes in 4 cycles: 3.2 GB/s; the part has 3.2"]);
    says(&default, "memory.graphics.part", &["assumed: graphics boards of 2005", "ddr-400: DDR-400 3-3-3"]);
    says(&default, "memory.graphics.channels", &["assumed: 256 bits"]);
    says(&default, "memory.normal_map.rcd", &["assumed: an array of its time"]);
    says(&default, "clock.hz", &["assumed: 2005"]);
    let set = bump("", &[("memory.graphics.part", "gddr3-1400"), ("memory.graphics.cl", "2"), ("memory.graphics.channels", "8")]);
    says(&set, "memory.graphics.part", &["set; the default is \"ddr-400\"", "HYB18H512321AF"]);
    says(&set, "memory.graphics.cl", &["set by the user; the memory part has 4: CL: 11 clocks of 700 MHz"]);
    says(&set, "memory.graphics.channels", &["set; the default is 4 (assumed: 256 bits"]);
    says(&set, "memory.graphics.burst_bytes", &["28 bytes in 1 cycles: 5.6 GB/s"]);
    let custom = bump("", &[("memory.graphics.part", "custom")]);
    says(&custom, "memory.graphics.rcd", &["no memory part is selected", "the default part is ddr-400"]);
    let clock = bump("", &[("clock.hz", "100000000")]);
    says(&clock, "memory.graphics.cl", &["derived: CL: 3 clocks of 200 MHz, 15 ns, rounded up at 100 MHz"]);
}

#[test]
fn every_memory_has_a_default_part_and_credits() {
    fn parts<C: Parameters>() -> Vec<serde_json::Value> {
        let value = basrelief_parameters::to_json(&C::default()).unwrap();
        value["memory"].as_object().unwrap().values().map(|memory| memory["part"].clone()).collect()
    }
    assert_eq!(parts::<BumpProcessorConfig>(), ["ddr-400", "edram-ps2", "sram"]);
    // Static RAM of the microcomputer (12), with explicit values.
    assert_eq!(parts::<ShadeConfig>(), ["fpm-80", "custom"]);
    assert_eq!(parts::<TexelMachineConfig>(), ["edo-60"; 3]);
    assert_eq!(parts::<DeferConfig>(), ["sdr-100"; 3]);
    // The defaults equal an empty configuration: all default parts fit the default clock.
    assert_eq!(bump("", &[]), BumpProcessorConfig::default());
    assert_eq!(load::<ShadeConfig>("", &[]).unwrap(), ShadeConfig::default());
    assert_eq!(load::<TexelMachineConfig>("", &[]).unwrap(), TexelMachineConfig::default());
    assert_eq!(load::<DeferConfig>("", &[]).unwrap(), DeferConfig::default());
}

/// A pixel or texel of fewer bytes would move fewer bytes and leave the picture as it is.
#[test]
fn pixels_and_texels_have_room_for_their_colours() {
    fn refuses<C: Parameters>(key: &str) -> bool {
        load::<C>("", &[(key, "2")]).is_err() && load::<C>("", &[(key, "4")]).is_ok()
    }
    let refuse: [fn(&str) -> bool; 4] =
        [refuses::<BumpProcessorConfig>, refuses::<ShadeConfig>, refuses::<TexelMachineConfig>, refuses::<DeferConfig>];
    let mut checked = 0;
    for (machine, refuses) in MACHINES.iter().zip(refuse) {
        let keys = machine.parameters().into_iter().map(|parameter| parameter.key);
        for key in keys.filter(|key| key.ends_with("pixel_bytes") || key.ends_with("texel_bytes")) {
            assert!(refuses(&key), "{}: {key}", machine.name);
            checked += 1;
        }
    }
    assert!(checked >= 6, "{checked}");
}
