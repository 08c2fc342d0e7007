//! Presets: each loads, its parameters fit together, and it matches its description.

use basrelief_sim::{MACHINES, MachineConfig, MachineInfo};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Returns machine and text of each preset, by name. Presets without a machine's name are paths of `defer`.
fn presets() -> BTreeMap<String, (&'static MachineInfo, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../presets");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let named = files.map(|path| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let machine = name.split('-').next().filter(|_| name.contains('-')).unwrap_or("defer");
        (name.clone(), (MachineInfo::named(machine).unwrap(), std::fs::read_to_string(path).unwrap()))
    });
    named.collect()
}

fn load(name: &str) -> MachineConfig {
    let (machine, text) = presets().remove(name).unwrap_or_else(|| panic!("there is no preset {name}"));
    let config = machine.load(&text, &[]).unwrap_or_else(|e| panic!("{name}: {e}"));
    config.check().unwrap_or_else(|e| panic!("{name}: {e}"));
    config
}

#[test]
fn every_preset_loads_and_names_its_machine() {
    for (name, (machine, text)) in presets() {
        load(&name);
        assert!(text.starts_with(&format!("# Machine `{}`", machine.name)), "{name}");
    }
}

#[test]
fn every_machine_has_an_era_and_an_ideal_preset() {
    for (machine, era) in [("bump", "2005"), ("shade", "1989"), ("texel", "1994"), ("defer", "1998")] {
        let default = MachineInfo::named(machine).unwrap().load("", &[]).unwrap();
        assert_eq!(load(&format!("{machine}-{era}")), default, "{machine}");
        let ideal = load(&format!("{machine}-ideal")).to_value();
        let memories = ideal["memory"].as_object().unwrap();
        assert!(memories.values().all(|m| m["part"] == "ideal" && m["cl"] == 0 && m["channels"] == 64), "{machine}");
    }
    assert_eq!(MACHINES.len(), 4, "a machine without an era");
}

#[test]
fn board_of_1998_has_one_channel_of_3_2_gb_per_s() {
    let config = load("bump-1998").to_value();
    let graphics = &config["memory"]["graphics"];
    let number = |key: &str| graphics[key].as_u64().unwrap();
    assert_eq!(
        [number("channels"), number("burst_bytes"), number("burst_cycles"), number("cl"), number("rtp")],
        [1, 64, 4, 6, 4]
    );
    assert_eq!(config["clock"], MachineConfig::default().to_value()["clock"]);
}

/// The configuration in a report, loaded again, gives the same machine.
#[test]
fn configuration_with_all_values_is_the_same_machine() {
    let settings: &[&[(&str, &str)]] = &[
        &[],
        &[("memory.graphics.part", "gddr3-1400"), ("memory.graphics.cl", "2")],
        &[("clock.hz", "133000000"), ("memory.graphics.burst_cycles", "9"), ("memory.graphics.rtp", "1")],
        &[("memory.graphics.part", "custom"), ("memory.normal_map.part", "custom"), ("clock.hz", "77")],
        &[("memory.normal_map.part", "ideal"), ("memory.normal_map.channels", "2")],
    ];
    let bump = MachineInfo::named("bump").unwrap();
    let configs = settings.iter().map(|set| bump.load("", set).unwrap());
    for config in configs.chain(presets().keys().map(|name| load(name))) {
        let text = toml(&config.to_value());
        let again = config.machine().load(&text, &[]).unwrap_or_else(|e| panic!("{e}: {text}"));
        assert_eq!(again, config);
    }
}

/// A value as TOML, in tables.
fn toml(value: &Value) -> String {
    fn lines(value: &Value, path: &str, text: &mut String) {
        match value {
            Value::Object(fields) => fields.iter().for_each(|(name, value)| {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                lines(value, &path, text);
            }),
            value => *text += &format!("{path} = {value}\n"),
        }
    }
    let mut text = String::new();
    lines(value, "", &mut text);
    text
}
