//! Tests of the list of machines.

use basrelief_machines::shade::ShadeConfig;
use basrelief_machines::{MACHINES, MachineConfig, MachineInfo};
use basrelief_parameters::value_of;
use basrelief_scene::DEMOS;

#[test]
fn every_demo_belongs_to_one_machine() {
    let mut made_for: Vec<&str> = MACHINES.iter().flat_map(|m| m.demos).copied().collect();
    let mut all: Vec<&str> = DEMOS.iter().map(|d| d.name).collect();
    made_for.sort_unstable();
    all.sort_unstable();
    assert_eq!(made_for, all);
    assert_eq!(MachineInfo::of_demo("goblet@8").name, "shade");
    assert_eq!(MachineInfo::of_demo("coin").name, "bump");
}

#[test]
fn default_configuration_is_the_one_without_settings() {
    for machine in MACHINES {
        assert_eq!(machine.default_config(), machine.load("", &[]).unwrap(), "{}", machine.name);
    }
}

#[test]
fn ablation_disables_each_shortcut_then_all() {
    let variants = MachineConfig::from(ShadeConfig::default()).ablations();
    let off = |c: &MachineConfig| {
        let MachineConfig::Shade(c) = c else { panic!("another machine") };
        let s = &c.shortcut;
        [!s.specular_negligible.enabled, !s.flatness.enabled, !s.same_plane.enabled]
    };
    let switched: Vec<[bool; 3]> = variants.iter().map(|(_, c)| off(c)).collect();
    assert_eq!(switched, [[false; 3], [true, false, false], [false, true, false], [false, false, true], [true; 3]]);
    assert_eq!(variants[0].0, "as configured");
    assert!(MachineConfig::default().ablations().is_empty());
}

#[test]
fn machine_is_found_by_name_and_loads_its_defaults() {
    for machine in MACHINES {
        let config = MachineInfo::named(machine.name).unwrap().load("", &[]).unwrap();
        assert_eq!(config.machine().name, machine.name);
        let first = &machine.parameters()[0];
        assert_eq!(value_of(&config.to_value(), &first.key), Some(&first.default));
    }
    assert_eq!(MachineConfig::default().machine().name, MACHINES[0].name);
    assert!(MachineInfo::named("lathe").unwrap_err().contains("expected bump, shade, texel, defer"));
}

// Claim: images: No stored value takes fewer bytes than its content.
#[test]
fn sizes_start_at_their_content() {
    // RGB and RGBA of 8 bits, single precision, two sides of 15 bits.
    let content = [("pixel_bytes", 3), ("graphics.texel_bytes", 3), ("normal_mapping.texel_bytes", 3)];
    let content = content.into_iter().chain([("look_up.texel_bytes", 4), ("number_bytes", 4), ("texture_size_bytes", 4)]);
    for (name, bytes) in content {
        let mut found = 0;
        for machine in MACHINES {
            for key in machine.parameters().into_iter().map(|p| p.key).filter(|key| key.ends_with(name)) {
                let with = |bytes: i32| {
                    let config =
                        machine.load("", &[(key.as_str(), bytes.to_string().as_str())]).map_err(|error| error.to_string())?;
                    config.check().map_err(|error| error.to_string())
                };
                assert_eq!(with(bytes), Ok(()), "{key}");
                let error = with(bytes - 1).expect_err(&key);
                assert!(error.contains(&key) && error.contains(&format!("is {}", bytes - 1)), "{error}");
                assert!(
                    error.contains(&format!("expected {bytes}..=")) || error.contains(&format!("set it to {bytes} or more")),
                    "{error}"
                );
                found += 1;
            }
        }
        assert!(found > 0, "{name}");
    }
}
