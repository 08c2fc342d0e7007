//! Process 13: mode decision, for the mode register (14), and all other data that are sent once per frame or object.

use super::Microcomputer;
use super::state::{CpuProcess, HostSettings};
use crate::cpu::CpuOperations;
use crate::local_memory::{LIGHT, LIGHTS, SETTINGS};
use crate::{ObjectIllumination, ScanConfig};
use basrelief_kernel::OperatorCounts;
use basrelief_shading::{RasterGrid, light_vectors};
use basrelief_signals::{Frame, ObjectInfo, Polygon, ShadingSettings};
use std::sync::Arc;

/// Mode decision: the mode is loaded and compared with the other two.
const DECISION: CpuOperations = CpuOperations { load: 1, integer: 2, ..CpuOperations::NONE };
/// H of a light: L and V added and normalised, and its intensity times Is. L arrives as a unit vector.
const LIGHT_VECTOR: CpuOperations = CpuOperations {
    load: 8,
    store: 4,
    ..CpuOperations::of(OperatorCounts::NORMALIZE.and(OperatorCounts { add: 3, multiply: 1, ..OperatorCounts::NONE }))
};
/// A material: Ka, Kd, Ks, n and colour, and Ka*Ia.
const MATERIAL: CpuOperations = CpuOperations { load: 8, multiply: 1, ..CpuOperations::NONE };

impl Microcomputer {
    /// Begins a frame. Returns its cycles.
    pub(super) fn begin_frame(&mut self, frame: &Arc<Frame>) -> u64 {
        let ScanConfig { subpixel_bits, block, z_bits } = self.scan;
        self.state.raster = RasterGrid::new([frame.width, frame.height], subpixel_bits, z_bits, block);
        self.state.frame = Some(Arc::clone(frame));
        self.state.object = None;
        self.state.lights_changed = true;
        self.decide_mode(frame.shading)
    }

    /// Begins an object. Returns its cycles, and true if its mode differs.
    pub(super) fn begin_object(&mut self, object: Arc<ObjectInfo>) -> (u64, bool) {
        let of_frame = self.state.frame.as_ref().map_or_else(ShadingSettings::default, |frame| frame.shading);
        let (before, said) = (self.state.settings, object.shading.or(of_frame));
        self.state.object = Some(object);
        self.state.lights_changed = true;
        if self.settings(said) == before {
            return (1, false);
        }
        let cycles = self.decide_mode(said);
        (cycles, self.state.settings.mode != before.mode)
    }

    /// Returns the given settings. Unset ones come from the configuration.
    fn settings(&self, said: ShadingSettings) -> HostSettings {
        let c = &self.shading;
        HostSettings { mode: said.mode.unwrap_or(c.mode), ia: said.ia.unwrap_or(c.ia), is: said.is.unwrap_or(c.is) }
    }

    fn decide_mode(&mut self, said: ShadingSettings) -> u64 {
        self.state.settings = self.settings(said);
        self.run(CpuProcess::Mode, DECISION)
    }

    /// Updates the illumination for this polygon. Returns its cycles.
    pub(super) fn set(&mut self, polygon: &Polygon) -> u64 {
        let material = &polygon.material;
        let [r, g, b, _] = material.base_color;
        let old = &self.state.illumination;
        let (lights_changed, color) = (std::mem::take(&mut self.state.lights_changed), [r, g, b]);
        if !lights_changed && old.lighting == material.lighting && old.color == color {
            return 0;
        }
        let centre = self.state.object.as_ref().map_or([0.0; 3], |o| o.centre);
        let mut lights = self.state.frame.as_ref().map_or_else(Vec::new, |frame| light_vectors(frame, centre));
        let HostSettings { mode, ia: ambient, is } = self.state.settings;
        lights.iter_mut().for_each(|light| light.intensity *= is);
        let count = lights.len() as u64;
        let new = ObjectIllumination { mode, lighting: material.lighting, color, ambient, lights };
        if **old != new {
            self.state.plane = None;
            self.state.illumination = Arc::new(new);
        }
        let vectors = if lights_changed { count } else { 0 };
        self.fetch(SETTINGS, MATERIAL.load);
        self.fetch(LIGHTS, vectors * LIGHT);
        self.store_numbers(LIGHTS, vectors * LIGHT);
        self.run(CpuProcess::Mode, MATERIAL.and(LIGHT_VECTOR.times(vectors))) + self.set_limits()
    }
}
