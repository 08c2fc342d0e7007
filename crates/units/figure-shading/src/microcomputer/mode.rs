//! Process 13: mode decision, for the mode register (14), and with it all that is sent once per frame or object.

use super::Microcomputer;
use super::state::Process;
use crate::{Illumination, ScanConfig};
use basrelief_shading::{Raster, light_vectors};
use basrelief_signals::{Frame, ObjectInfo, Polygon};
use std::sync::Arc;

impl Microcomputer {
    /// A frame begins; the cycles that it takes.
    pub(super) fn begin_frame(&mut self, frame: &Arc<Frame>) -> u64 {
        let ScanConfig { subpixel_bits, block, z_bits } = self.scan;
        self.state.raster = Raster::new([frame.width, frame.height], subpixel_bits, z_bits, block);
        self.state.frame = Some(Arc::clone(frame));
        self.state.object = None;
        self.state.lights_changed = true;
        self.run(Process::Mode, u64::from(self.config.mode_cycles))
    }

    /// The polygons that follow are of this object.
    pub(super) fn begin_object(&mut self, object: Arc<ObjectInfo>) {
        self.state.object = Some(object);
        self.state.lights_changed = true;
    }

    /// Brings the illumination up to date for this polygon; the cycles that it takes.
    pub(super) fn set(&mut self, polygon: &Polygon) -> u64 {
        let material = &polygon.material;
        let [r, g, b, _] = material.base_color;
        let old = &self.state.illumination;
        if !self.state.lights_changed && old.lighting == material.lighting && old.color == [r, g, b] {
            return 0;
        }
        self.state.lights_changed = false;
        let centre = self.state.object.as_ref().map_or([0.0; 3], |o| o.centre);
        let mut lights = self.state.frame.as_ref().map_or_else(Vec::new, |frame| light_vectors(frame, centre));
        lights.iter_mut().for_each(|light| light.intensity *= self.shading.is);
        let cycles = u64::from(self.config.setting_cycles_per_light) * lights.len() as u64;
        let (mode, ambient) = (self.shading.mode, self.shading.ia);
        let new = Illumination { mode, lighting: material.lighting, color: [r, g, b], ambient, lights };
        if **old != new {
            self.state.plane = None;
            self.state.illumination = Arc::new(new);
        }
        self.run(Process::Mode, cycles)
    }
}
