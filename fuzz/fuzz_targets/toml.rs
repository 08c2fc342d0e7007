//! Configuration texts and single settings: no input may panic.
//!
//! Input: TOML, then optionally a zero byte and `key=value` settings, one per line.

#![no_main]

use basrelief_parameters::{load, parameter_groups, parameters};
use libfuzzer_sys::fuzz_target;

parameters! {
    /// One parameter of each type.
    pub struct Leaf {
        /// A number.
        count: u32 = 8, unit: "entries", Assumed("fuzzing"), range: 1..=4096;
        /// A fraction.
        share: f64 = 0.5, unit: "", Assumed("fuzzing"), range: 0.0..=1.0;
        /// A switch.
        on: bool = false, unit: "", Assumed("fuzzing");
        /// A text.
        name: String = "none".into(), unit: "", Assumed("fuzzing");
        /// One per level.
        levels: Vec<u32> = vec![256, 128], unit: "entries", Assumed("fuzzing");
    }
}

parameter_groups! {
    /// Configuration of two groups.
    pub struct Config {
        /// First group.
        first: Leaf = Leaf::default(),
        /// Second group.
        second: Leaf = Leaf::default(),
    }
}

fuzz_target!(|input: &str| {
    let (text, settings) = input.split_once('\0').unwrap_or((input, ""));
    let settings: Vec<(&str, &str)> = settings.lines().filter_map(|line| line.split_once('=')).collect();
    if let Err(error) = load::<Config>(text, &settings) {
        assert!(!error.to_string().is_empty());
    }
});
