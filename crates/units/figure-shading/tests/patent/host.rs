//! Section 4: data that the host sends, and their timing.

use crate::chain::{frame, polygon, sun};
use basrelief_figure_shading::{FinishedPolygon, HostConfig, HostInterface};
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_signals::{Control, Light, LightKind, Lighting, ObjectInfo};
use glam::Vec3;
use std::sync::Arc;

fn unit(config: HostConfig) -> HostInterface {
    HostInterface::new(config)
}

fn send(unit: &mut HostInterface, control: Control) -> Step<Option<Control>> {
    assert_eq!(unit.demand(), Demand::Only(0));
    unit.step((Some(control), None), &mut MemoryPorts::default())
}

fn finish(unit: &mut HostInterface) -> Step<Option<Control>> {
    assert_eq!(unit.demand(), Demand::Only(1));
    unit.step((None, Some(FinishedPolygon)), &mut MemoryPorts::default())
}

fn square(n: f32) -> Control {
    polygon(&[[1.0, 1.0], [5.0, 1.0], [5.0, 5.0], [1.0, 5.0]], &[Vec3::Z; 4], Lighting { n, ..Lighting::default() })
}

fn object() -> Control {
    Control::Object(Arc::new(ObjectInfo { ..ObjectInfo::default() }))
}

// Claim: as polygon_waits_for_a_free_buffer.
#[test]
fn host_bytes_follow_protocol() {
    let mut unit = unit(HostConfig { buffers: 2, ..HostConfig::default() });
    let mut sent = |control| {
        let before = unit.state.counters.bytes;
        let step = send(&mut unit, control);
        let bytes = unit.state.counters.bytes - before;
        assert_eq!(step.occupancy, bytes.div_ceil(4).max(1));
        assert_eq!(step.latency, step.occupancy - 1 + 2, "two cycles after the last word enters");
        bytes / 4
    };
    assert_eq!(sent(frame(vec![sun(Vec3::Z); 2])), 1 + 1 + 3 + 2 * (3 + 1), "mode, Ia, V; L and Is of each light");
    assert_eq!(sent(object()), 0, "the light is at infinity");
    assert_eq!(sent(square(9.0)), 8 + 1 + 4 * 6, "coefficients, count, points and normals");
    assert_eq!(sent(square(9.0)), 1 + 4 * 6, "coefficients did not change");
    finish(&mut unit);
    assert_eq!(unit.state.counters.bytes, 4 * (13 + 33 + 25));
    send(&mut unit, square(10.0));
    assert_eq!(unit.state.counters.bytes, 4 * (13 + 33 + 25 + 33));
}

// Claim: as polygon_waits_for_a_free_buffer.
#[test]
fn point_light_l_is_sent_per_object() {
    let mut unit = unit(HostConfig::default());
    send(&mut unit, frame(vec![Light { kind: LightKind::Point { position: [1.0; 3] }, intensity: 1.0 }, sun(Vec3::Z)]));
    let before = unit.state.counters.bytes;
    send(&mut unit, object());
    assert_eq!(unit.state.counters.bytes - before, 4 * 3);
}

// Claim: shade, protocol: A polygon is finished before the next is accepted. With two buffers, one is transferred ahead. Transfers
// take their bytes and times.
#[test]
fn polygon_waits_for_a_free_buffer() {
    for buffers in [1, 2] {
        let mut unit = unit(HostConfig { buffers, ..HostConfig::default() });
        send(&mut unit, frame(vec![sun(Vec3::Z)]));
        for _ in 0..buffers {
            send(&mut unit, square(9.0));
        }
        for _ in 0..5 {
            assert_eq!(finish(&mut unit).out, None);
            send(&mut unit, square(9.0));
        }
    }
}

// Claim: as polygon_waits_for_a_free_buffer.
#[test]
fn frame_ends_after_all_polygons() {
    let mut unit = unit(HostConfig { buffers: 2, ..HostConfig::default() });
    send(&mut unit, frame(vec![sun(Vec3::Z)]));
    send(&mut unit, square(9.0));
    assert_eq!(send(&mut unit, Control::FrameEnd).out, None);
    assert!(!unit.is_empty());
    assert_eq!(finish(&mut unit).out, Some(Control::FrameEnd));
    assert!(unit.is_empty());
    assert_eq!(send(&mut unit, Control::FrameEnd).out, Some(Control::FrameEnd), "nothing to wait for");
}

// Claim: as zero_area_and_repeated_points_have_no_dots.
#[test]
fn fewer_than_three_points_are_dropped_and_counted() {
    let mut unit = unit(HostConfig::default());
    send(&mut unit, frame(vec![sun(Vec3::Z)]));
    let line = polygon(&[[1.0, 1.0], [5.0, 1.0]], &[Vec3::Z; 2], Lighting::default());
    assert_eq!(send(&mut unit, line).out, None);
    assert_eq!((unit.state.counters.dropped, unit.state.counters.polygons, unit.state.in_flight), (1, 0, 0));
    let square = square(9.0);
    assert_eq!(send(&mut unit, square.clone()).out, Some(square));
}
