//! Width of u and v.

use crate::common::scene_front;
use crate::texel::runs::{config, figure, functional};
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::Scene;
use std::sync::Arc;

/// Returns the largest displacement in the first picture of a demo at its usual size, with u and v of this many bits \[pixels\].
fn displacement(scene: &Arc<Scene>, bits: u32) -> f64 {
    let config = config(&[("texel.coordinate_bits", &bits.to_string())]);
    figure(&functional(scene_front(scene, &config), &config).1, "displacement_largest")
}

/// True if both demos keep the configured bound.
fn keeps_bound(bits: u32) -> bool {
    let bound = TexelMachineConfig::default().texel.error_bound;
    ["corridor", "turntable"].iter().all(|name| {
        let scene = demo(name, &ViewOptions { frames: Some(1), ..ViewOptions::default() }).unwrap();
        displacement(&Arc::new(scene), bits) <= bound
    })
}

// Claim: as division_takes_half_its_quotient_bits_in_cycles.
#[test]
fn default_uv_width_is_the_narrowest_within_the_bound() {
    let bits = TexelMachineConfig::default().texel.coordinate_bits;
    assert!(keeps_bound(bits) && !keeps_bound(bits - 1), "{bits}");
}
