//! Host interface: transfers from the host computer (100), polygon by polygon.

use crate::local_memory::{LIGHT, LIGHTS, LocalPort, PolygonBuffer, SETTINGS};
use crate::{FinishedPolygon, HostConfig};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use basrelief_signals::width::NUMBER;
use basrelief_signals::{Control, Frame, LightKind, Lighting, ObjectInfo, Polygon, ShadingSettings};
use serde::{Deserialize, Serialize};

/// Counters of the host interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct HostInterfaceCounters {
    /// Polygons sent.
    pub polygons: u64,
    /// Polygons of fewer than three points, not sent.
    pub dropped: u64,
    /// Polygons sent that have a colour texture, which the device does not support.
    pub textured: u64,
    /// Bytes sent.
    pub bytes: u64,
}

/// State of the host interface between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HostInterfaceState {
    /// Number of point lights. Their L is sent anew for each object.
    pub point_lights: u64,
    /// Coefficients and colour sent last.
    pub sent: Option<(Lighting, [f32; 4])>,
    /// Mode, Ia and Is of the frame, and those sent last. An object can override them.
    pub shading: [ShadingSettings; 2],
    /// Polygons that the device holds.
    pub in_flight: u32,
    /// True if the end of the frame waits for polygons to finish.
    pub frame_ends: bool,
    /// Counters.
    pub counters: HostInterfaceCounters,
}

/// Host interface. It sends, in the words of the patent: once per frame the mode, Ia, Is, L and V; per object L again for point
/// lights; Ka, Kd (per component), Ks and n at each change; per polygon its points and normals, and colours that are not white.
/// Transfers are per polygon: the next one waits until one of the `buffers` is free, as the feedback of selector (28) reports.
/// The end of the frame waits until all are free.
///
/// If an object overrides mode, Ia or Is, or ends an override, the changed values are sent. All data sent are written to memory
/// (12).
///
/// Input 0 comes from the front end, input 1 is the feedback.
#[derive(Clone, Debug, Default)]
pub struct HostInterface {
    /// Parameters.
    pub config: HostConfig,
    /// State between steps.
    pub state: HostInterfaceState,
}

type Out = Step<Option<Control>>;

/// Maximum number of requests of a step to memory (12): coefficients, points, normals and colours of a polygon.
const MOST_REQUESTS: u32 = 4;

impl HostInterface {
    /// Creates a host interface in its power-on state.
    pub fn new(config: HostConfig) -> Self {
        Self { config, state: HostInterfaceState::default() }
    }

    /// Sends this many numbers.
    fn send(&mut self, numbers: u64, control: Control) -> Out {
        let bytes = numbers * u64::from(self.config.number_bytes);
        self.state.counters.bytes += bytes;
        let cycles = bytes.div_ceil(u64::from(self.config.bytes_per_cycle)).max(1);
        Step::during(cycles, self.config.latency.into(), Some(control))
    }

    /// Writes and counts the numbers of a frame: mode, Ia, V, and L and Is of each light.
    fn frame_numbers(&mut self, frame: &Frame, traffic: &mut MemoryPorts) -> u64 {
        self.state.shading = [frame.shading; 2];
        self.state.point_lights = frame.lights.iter().filter(|l| matches!(l.kind, LightKind::Point { .. })).count() as u64;
        let lights = frame.lights.len() as u64;
        self.port().write(traffic, SETTINGS, 5);
        self.port().write(traffic, LIGHTS, LIGHT * lights);
        5 + 4 * lights
    }

    /// Writes and counts the numbers of an object: L of point lights, and the changes of mode, Ia and Is.
    fn object_numbers(&mut self, object: &ObjectInfo, traffic: &mut MemoryPorts) -> u64 {
        let [of_frame, before] = self.state.shading;
        let now = object.shading.or(of_frame);
        self.state.shading[1] = now;
        let differ = [now.mode != before.mode, now.ia != before.ia, now.is != before.is];
        let settings = differ.into_iter().filter(|differs| *differs).count() as u64;
        self.port().write(traffic, SETTINGS, settings);
        self.port().write(traffic, LIGHTS, LIGHT * self.state.point_lights);
        3 * self.state.point_lights + settings
    }

    fn port(&self) -> LocalPort {
        LocalPort { number_bytes: self.config.number_bytes }
    }

    fn polygon_numbers(&mut self, polygon: &Polygon, traffic: &mut MemoryPorts) -> u64 {
        let (buffer, points) =
            (PolygonBuffer::of(self.state.counters.polygons, self.config.buffers), polygon.vertices.len() as u64);
        let material = &polygon.material;
        let wanted = Some((material.lighting, material.base_color));
        let is_new = self.state.sent != wanted;
        self.state.sent = wanted;
        let coefficients = if is_new { 8 } else { 0 };
        let is_white = polygon.vertices.iter().all(|v| v.color == [1.0; 4]);
        let port = self.port();
        port.write(traffic, SETTINGS + 5, coefficients);
        port.write(traffic, buffer.points(), 1 + 3 * points);
        port.write(traffic, buffer.normals(), 3 * points);
        if !is_white {
            port.write(traffic, buffer.colors(), 3 * points);
        }
        coefficients + 1 + points * if is_white { 6 } else { 9 }
    }

    fn take(&mut self, control: Control, traffic: &mut MemoryPorts) -> Out {
        match &control {
            Control::Frame(frame) => {
                let numbers = self.frame_numbers(frame, traffic);
                self.send(numbers, control)
            }
            Control::Object(object) => {
                let numbers = self.object_numbers(object, traffic);
                self.send(numbers, control)
            }
            Control::Polygon(polygon) if polygon.vertices.len() < 3 => {
                self.state.counters.dropped += 1;
                Step::after(0, None)
            }
            Control::Polygon(polygon) => {
                let numbers = self.polygon_numbers(polygon, traffic);
                self.state.in_flight += 1;
                self.state.counters.polygons += 1;
                self.state.counters.textured += u64::from(polygon.material.color_texture.is_some());
                self.send(numbers, control)
            }
            Control::CodeBook(_) | Control::Criterion(_) => Step::after(0, None),
            Control::FrameEnd => {
                self.state.frame_ends = true;
                self.end_frame()
            }
        }
    }

    /// Sends the end of the frame if it waits for nothing.
    fn end_frame(&mut self) -> Out {
        if !self.state.frame_ends || self.state.in_flight > 0 {
            return Step::after(0, None);
        }
        self.state.frame_ends = false;
        self.send(1, Control::FrameEnd)
    }
}

impl Unit for HostInterface {
    basrelief_kernel::unit_info!("transfers polygons, one or two at a time");
    type In = (Option<Control>, Option<FinishedPolygon>);
    type Out = Option<Control>;

    fn demand(&self) -> Demand {
        let is_full = self.state.in_flight >= self.config.buffers;
        Demand::Only(usize::from(is_full || self.state.frame_ends))
    }

    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Out {
        if let (Some(control), _) = input {
            return self.take(control, traffic);
        }
        self.state.in_flight = self.state.in_flight.saturating_sub(1);
        self.end_frame()
    }

    fn is_empty(&self) -> bool {
        !self.state.frame_ends
    }

    fn largest_step(&self, client: usize) -> u32 {
        if client == LocalPort::CLIENT as usize { MOST_REQUESTS } else { 0 }
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let c = &self.state.counters;
        stats.hardware(
            HardwareKind::Registers,
            "transfer: address and count in memory (12), polygons on their way",
            3_u64,
            NUMBER,
        );
        stats.figure("host_bytes", c.bytes, "bytes", "Data that the host computer sent");
        stats.figure("polygons_sent", c.polygons, "polygons", "Polygons that the host computer sent");
        stats.figure("polygons_dropped", c.dropped, "polygons", "Polygons of fewer than three points, which were not drawn");
        stats.figure("polygons_textured", c.textured, "polygons", "Polygons with a colour texture, which took the base colour");
    }
}
