//! Costs of the geometry processor (102): charges of its steps, and its hardware.

use crate::config::GeometryConfig;
use crate::work::{self, StepCharge};
use crate::{GeometryProcessor, PolygonLink};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{HardwareKind, OperandWidth};
use basrelief_signals::{LightingStage, Material, Object, Polygon, SentAttributes};

impl GeometryProcessor {
    /// Returns the occupancy in cycles of a step with this charge and a polygon of this size.
    pub(crate) fn kept(&self, charge: StepCharge, polygon_bytes: u64) -> u64 {
        let GeometryConfig { fetch_bytes_per_cycle, link_bytes, .. } = self.config;
        let link = PolygonLink { bytes_per_cycle: link_bytes, taken: self.taken };
        self.operators
            .stream_interval(charge.work, self.config.operators())
            .max(charge.fetched.div_ceil(u64::from(fetch_bytes_per_cycle.max(1))))
            .max(link.cycles(polygon_bytes))
    }

    /// Returns the attributes that are fetched for an object's vertices: those that its material has and the machine accepts, and
    /// normals if it is lit at all. Tangents are always fetched, because the bump decision comes too late to save them.
    pub(crate) fn fetched(&self, object: &Object) -> SentAttributes {
        let may_be_target = object.bump.unwrap_or_else(|| self.is_candidate(object));
        let taken = self.taken.of(&object.material, may_be_target, !object.mesh.colors.is_empty());
        SentAttributes { normal: self.taken.lit != LightingStage::Nowhere, brightness: false, ..taken }
    }

    /// Returns the cycles from the last operands of a polygon to its delivery.
    pub(crate) fn latency(&self) -> u64 {
        work::latency(&self.operators, self.taken)
    }

    /// Reports the rate: the smallest polygon that the machine accepts occupies the link longest of all its minimal work.
    pub(crate) fn tell_rate(&self, stats: &mut UnitStats) {
        let smallest = |bump| self.taken.of(&Material::default(), bump, false).bytes();
        let bytes = Polygon::HEAD_BYTES + 3 * (Polygon::POSITION_BYTES + smallest(true).min(smallest(false)));
        let interval = self.kept(StepCharge { work: work::area(3), fetched: 0 }, bytes);
        stats.rate(0, self.latency() + interval - 1, interval);
    }

    pub(crate) fn tell_hardware(&self, stats: &mut UnitStats) {
        let work = work::program(self.taken.all(), self.taken.lit);
        stats.shared_operators("transform, clip, project, light", self.config.operators(), work, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "matrices", 16 + 9 + 9_u32, NUMBER);
        stats.hardware(HardwareKind::Registers, "lights", 7 * LIGHTS, NUMBER);
        stats.hardware(HardwareKind::Registers, "corners of a clipped polygon", MOST_CORNERS, self.vertex_bits());
        stats.hardware(HardwareKind::Table, "vertex cache", self.config.vertex_cache, INDEX + FLAGS + self.vertex_bits());
        stats.hardware(HardwareKind::Adder, "whether the vertex cache holds an index", self.config.vertex_cache, INDEX);
    }

    /// Returns the size of a transformed vertex \[bits\]: clip and window coordinates, and its attributes.
    fn vertex_bits(&self) -> u32 {
        8 * NUMBER + 8 * self.taken.all().bytes() as u32
    }
}

/// Single-precision number \[bits\].
const NUMBER: u32 = 32;
/// An index \[bits\].
const INDEX: u32 = 32;
/// One bit for a valid vertex and one for a lit vertex.
const FLAGS: u32 = 2;
/// Lights with registers of seven numbers each: direction, half-way vector, intensity. The number is assumed: the minimum that
/// OpenGL requires. A scene with more lights is accepted.
const LIGHTS: u32 = 8;
/// Maximum number of corners of a triangle cut by six planes.
const MOST_CORNERS: u32 = 9;
