//! How wide u and v have to be.

use crate::common::scene_front;
use crate::runs::{config, figure, functional};
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::Scene;
use std::sync::Arc;

/// The largest displacement in the first picture of a demo, of its usual size, with u and v of so many bits \[pixels\].
fn displacement(scene: &Arc<Scene>, bits: u32) -> f64 {
    let config = config(&[("texel.coordinate_bits", &bits.to_string())]);
    figure(&functional(scene_front(scene, &config), &config).1, "displacement_largest")
}

/// Whether both demos keep the bound that is configured.
fn keeps_bound(bits: u32) -> bool {
    let bound = TexelMachineConfig::default().texel.error_bound;
    ["corridor", "turntable"].iter().all(|name| {
        let scene = demo(name, &ViewOptions { frames: Some(1), ..ViewOptions::default() }).unwrap();
        displacement(&Arc::new(scene), bits) <= bound
    })
}

#[test]
fn the_default_width_of_u_and_v_is_the_narrowest_that_keeps_the_bound_on_the_demos() {
    let bits = TexelMachineConfig::default().texel.coordinate_bits;
    assert!(keeps_bound(bits) && !keeps_bound(bits - 1), "{bits}");
}
