//! Mode, Ia and Is as set by a display list for a frame or an object.

use crate::chain::{Config, SIDE, feed, polygon, shade, sun};
use basrelief_figure_shading::{
    HostConfig, HostInterface, Microcomputer, PolygonRoute, RegisterOrder, RegisterWrite, ShadingMode,
};
use basrelief_kernel::{MemoryPorts, Unit};
use basrelief_signals::{Camera, Control, Frame, Lighting, ObjectInfo, ShadingSettings};
use glam::Vec3;
use std::sync::Arc;

const SQUARE: [[f32; 2]; 4] = [[2.0, 2.0], [10.0, 2.0], [10.0, 10.0], [2.0, 10.0]];

fn frame(shading: ShadingSettings) -> Control {
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let lights = vec![sun(Vec3::Z)];
    Control::Frame(Arc::new(Frame { index: 0, width: SIDE, height: SIDE, camera, lights, textures: Vec::new(), shading }))
}

fn object(shading: ShadingSettings) -> Control {
    Control::Object(Arc::new(ObjectInfo { shading, ..ObjectInfo::default() }))
}

fn square() -> Control {
    polygon(&SQUARE, &[Vec3::Z; 4], Lighting { ka: 0.1, kd: 0.2, ks: 0.3, n: 1.0 })
}

/// Returns route and brightness of the square, and the values written to the mode register (14) since the previous polygon.
fn draw(unit: &mut Microcomputer, controls: Vec<Control>) -> (PolygonRoute, f32, Vec<ShadingMode>) {
    let orders = feed(unit, controls).into_iter().filter_map(|(order, ..)| order);
    let modes =
        orders.filter_map(|o| if let RegisterOrder::Write(RegisterWrite::Mode(mode)) = o { Some(mode) } else { None }).collect();
    let mut config = Config::default();
    config.shading.mode = ShadingMode::Normal;
    let shaded = shade(unit, &config, square());
    let figure = shaded.figure.expect("a figure");
    let dots = if shaded.mean.is_empty() { &shaded.linear } else { &shaded.mean };
    (figure.route, dots[0].brightness[0], modes)
}

// Claim: shade, protocol: Mode, Ia and Is can change per frame or object.
#[test]
fn object_settings_override_frame_and_configuration() {
    let mut unit = Config::default().microcomputer();
    let mode = |mode| ShadingSettings { mode: Some(mode), ..ShadingSettings::default() };
    let none = ShadingSettings::default();
    let (route, brightness, modes) = draw(&mut unit, vec![frame(none), object(none)]);
    assert_eq!((route, modes), (PolygonRoute::Flat, vec![ShadingMode::Normal]), "as configured");
    assert!((brightness - 0.6).abs() < 1e-6);
    let (route, _, modes) = draw(&mut unit, vec![object(mode(ShadingMode::Polyhedron))]);
    assert_eq!((route, modes), (PolygonRoute::Polyhedron, vec![ShadingMode::Polyhedron]));
    let (route, _, modes) = draw(&mut unit, vec![object(none)]);
    assert_eq!((route, modes), (PolygonRoute::Flat, vec![ShadingMode::Normal]), "the next object has none of its own");
    let (route, _, modes) = draw(&mut unit, vec![object(none)]);
    assert_eq!((route, modes), (PolygonRoute::Reused, vec![]), "nothing changed");
    let dim = ShadingSettings { ia: Some(0.0), is: Some(0.5), ..none };
    let (route, brightness, _) = draw(&mut unit, vec![object(dim)]);
    assert_eq!(route, PolygonRoute::Flat, "Figure 7: void after a new Ia or Is");
    assert!((brightness - 0.25).abs() < 1e-6, "{brightness}");
    let (_, brightness, modes) = draw(&mut unit, vec![Control::FrameEnd, frame(mode(ShadingMode::Brightness)), object(none)]);
    assert_eq!(modes, [ShadingMode::Brightness], "of the frame");
    assert!((brightness - 0.6).abs() < 1e-6);
    let (route, _, _) = draw(&mut unit, vec![object(ShadingSettings { ia: Some(0.25), ..none })]);
    assert_eq!(route, PolygonRoute::Brightness, "the object says no mode: that of its frame");
}

#[test]
fn host_sends_changed_settings() {
    let mut host = HostInterface::new(HostConfig::default());
    let mut sent = |control| {
        let before = host.state.counters.bytes;
        host.step((Some(control), None), &mut MemoryPorts::default());
        (host.state.counters.bytes - before) / 4
    };
    let all = ShadingSettings { mode: Some(ShadingMode::Polyhedron), ia: Some(0.5), is: Some(2.0) };
    assert_eq!(sent(frame(ShadingSettings::default())), 5 + 4);
    let of_objects = [all, all, ShadingSettings { ia: None, ..all }, ShadingSettings::default(), ShadingSettings::default()];
    assert_eq!(of_objects.map(|shading| sent(object(shading))), [3, 0, 1, 2, 0]);
}
