//! Tests of the list of machines.

use super::*;
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
        assert_eq!(config.to_value().pointer(&format!("/{}", first.key.replace('.', "/"))), Some(&first.default));
    }
    assert_eq!(MachineConfig::default().machine().name, MACHINES[0].name);
    assert!(MachineInfo::named("lathe").unwrap_err().contains("expected bump, shade, texel, defer"));
}
