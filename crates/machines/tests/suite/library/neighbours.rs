//! Neighbours of parameter values.

use basrelief_machines::{MACHINES, ParameterInfo};
use serde_json::{Value, json};

fn of(machine: usize, key: &str, value: Value, fits: &dyn Fn(&Value) -> bool) -> Vec<Value> {
    let described = MACHINES[machine].load("", &[]).unwrap().described();
    ParameterInfo { value, ..described.into_iter().find(|p| p.key == key).unwrap() }.neighbours(fits)
}

#[test]
fn numbers_are_halved_and_raised_by_half_within_range() {
    let depths = |n: u64| of(0, "fifo.shaded.depth", json!(n), &|_| true);
    assert_eq!(depths(64), [32, 96]);
    assert_eq!(depths(7), [4, 11]);
    assert_eq!(depths(2), [1, 3]);
    assert_eq!(depths(1), [2]);
    assert_eq!(depths(60_000), [30_000, 65_536]);
    assert_eq!(depths(65_536), [32_768]);
    assert_eq!(of(0, "memory.graphics.cap", json!(0), &|_| true), [1]);
    assert_eq!(of(1, "shade.ia", json!(1.0), &|_| true), [0.5, 1.5]);
    assert_eq!(of(1, "shade.ia", json!(12.0), &|_| true), [6.0, 16.0]);
    assert_eq!(of(1, "shade.ia", json!(0.0), &|_| true), [0.0; 0]);
    // In binary, 1.5 x 1.4 is 2.0999999999999996.
    assert_eq!(of(0, "area.memory_bit", json!(1.4), &|_| true), [0.7, 2.1]);
}

#[test]
fn powers_of_two_double_where_1_5_times_does_not_fit() {
    let is_power = |value: &Value| value.as_u64().is_some_and(u64::is_power_of_two);
    assert_eq!(of(0, "cache.clut.line_bytes", json!(64), &is_power), [32, 128]);
    // If neither value fits, 1.5 times is returned.
    assert_eq!(of(0, "cache.clut.line_bytes", json!(64), &|value| *value == 64), [32, 96]);
    assert_eq!(of(0, "cache.clut.line_bytes", json!(48), &is_power), [24, 72]);
}

#[test]
fn choices_and_switches_have_neighbours_but_texts_do_not() {
    assert_eq!(of(0, "memory.graphics.part", json!("ddr-400"), &|_| true), ["sdr-133", "ddr2-667"]);
    // An ideal part cannot be built.
    assert_eq!(of(0, "memory.graphics.part", json!("sram"), &|_| true), ["edram-ps2"]);
    assert_eq!(of(0, "memory.graphics.part", json!("ideal"), &|_| true), [""; 0]);
    assert_eq!(of(0, "reference.filter", json!("trilinear"), &|_| true), ["bilinear"]);
    assert_eq!(of(0, "rasterizer.early_z", json!(true), &|_| true), [false]);
    assert_eq!(of(0, "ideal.units", json!(""), &|_| true), [""; 0]);
    assert_eq!(of(3, "defer.left_at_ms", json!([]), &|_| true), [""; 0]);
    assert_eq!(of(3, "defer.left_at_tile", json!([4, 2]), &|_| true), [json!([2, 1]), json!([6, 3])]);
}
