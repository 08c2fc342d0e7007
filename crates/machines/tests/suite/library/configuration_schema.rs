//! JSON schemas of configurations.

use basrelief_machines::MACHINES;
use serde_json::{Value, json};

#[test]
fn schema_refuses_values_out_of_range() {
    let validator = jsonschema::validator_for(&MACHINES[0].schema()).unwrap();
    for (config, is_valid) in [
        (json!({ "replacement": { "lanes": 64 } }), true),
        (json!({ "replacement": { "lanes": 0 } }), false),
        (json!({ "replacement": { "lanes": 65537 } }), false),
        (json!({ "fifo": { "pixels": { "depth": 0 } } }), false),
        (json!({ "memory": { "graphics": { "part": "ddr-400" } } }), true),
        (json!({ "memory": { "graphics": { "part": "ddr-4000" } } }), false),
    ] {
        assert_eq!(validator.is_valid(&config), is_valid, "{config}");
    }
}

#[test]
fn default_configurations_match_their_schemas() {
    for machine in MACHINES {
        let validator = jsonschema::validator_for(&machine.schema()).unwrap();
        let config: Value = machine.load("", &[]).unwrap().to_value();
        let errors: Vec<String> = validator.iter_errors(&config).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{}: {errors:?}", machine.name);
    }
}
