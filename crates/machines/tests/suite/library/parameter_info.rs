//! Descriptions of parameters.

use basrelief_machines::{AllowedValues, MACHINES, ParameterInfo};

fn of(machine: usize, key: &str) -> ParameterInfo {
    let config = MACHINES[machine].load("", &[]).unwrap();
    config.described().into_iter().find(|p| p.key == key).unwrap()
}

#[test]
fn allowed_values_are_data() {
    assert_eq!(of(0, "replacement.lanes").takes, AllowedValues::Integer { min: 1.0, max: 65536.0 });
    assert_eq!(of(0, "replacement.entries").takes, AllowedValues::Integer { min: 1.0, max: 65536.0 });
    assert_eq!(of(0, "depth.clear_flags").takes, AllowedValues::Switch);
    assert_eq!(of(0, "ideal.units").takes, AllowedValues::Text);
    assert!(matches!(of(1, "shade.ia").takes, AllowedValues::Number { min: 0.0, .. }));
    let AllowedValues::Choice { choices } = of(0, "memory.graphics.part").takes else { panic!("no choice") };
    assert!(choices.iter().any(|c| c.name == "ddr-400" && !c.about.is_empty()));
}

#[test]
fn numbers_have_bounds_and_choices_have_their_default() {
    for machine in MACHINES {
        for ParameterInfo { key, default, takes, .. } in machine.load("", &[]).unwrap().described() {
            match takes {
                AllowedValues::Choice { choices } => assert!(choices.iter().any(|c| default == c.name), "{key}"),
                AllowedValues::Integer { min, max } | AllowedValues::Number { min, max } => {
                    assert!((min..=max).contains(&default.as_f64().unwrap()), "{key}");
                }
                AllowedValues::Switch => assert!(default.is_boolean(), "{key}"),
                AllowedValues::Text => assert!(default.is_string() || default.is_array(), "{key} is {default}"),
            }
        }
    }
}
