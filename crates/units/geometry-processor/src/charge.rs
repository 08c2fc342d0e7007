//! What the geometry processor (102) is charged, and what it is built of.

use crate::config::GeometryConfig;
use crate::work;
use crate::{GeometryProcessor, PolygonLink};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{HardwareKind, Work};
use basrelief_signals::{LightingStage, Material, Object, Polygon, SentAttributes};

/// What a step keeps the unit for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Charge {
    /// Arithmetic.
    pub(crate) work: Work,
    /// Fetched of vertices and indices \[bytes\].
    pub(crate) fetched: u64,
}

impl Charge {
    /// More arithmetic.
    pub(crate) fn add(&mut self, work: Work) {
        self.work = self.work.and(work);
    }
}

/// A vertex as it is fetched: three numbers of its position, and these attributes \[bytes\].
pub(crate) fn vertex_bytes(of: SentAttributes) -> u64 {
    12 + of.bytes()
}

/// Indices of a triangle: 16 bits each while they tell all vertices of the object apart \[bytes\].
pub(crate) fn index_bytes(object: &Object) -> u64 {
    3 * if object.mesh.positions.len() <= 1 << 16 { 2 } else { 4 }
}

impl GeometryProcessor {
    /// Cycles for which the unit is kept by what is charged and a polygon of so many bytes.
    pub(crate) fn kept(&self, charge: Charge, polygon_bytes: u64) -> u64 {
        let GeometryConfig { fetch_bytes_per_cycle, link_bytes, .. } = self.config;
        let link = PolygonLink { bytes_per_cycle: link_bytes, taken: self.taken };
        self.operators
            .pace(charge.work, self.config.operators())
            .max(charge.fetched.div_ceil(u64::from(fetch_bytes_per_cycle.max(1))))
            .max(link.cycles(polygon_bytes))
    }

    /// Attributes that are fetched of an object's vertices: those that its material has and the machine takes, and normals where
    /// it is lit at all. Whether a candidate is a bump target is known too late to spare it a tangent.
    pub(crate) fn fetched(&self, object: &Object) -> SentAttributes {
        let may_be_target = object.bump.unwrap_or_else(|| self.is_candidate(object));
        let taken = self.taken.of(&object.material, may_be_target, !object.mesh.colors.is_empty());
        SentAttributes { normal: self.taken.lit != LightingStage::Nowhere, brightness: false, ..taken }
    }

    /// From the last operands of a polygon to its delivery \[cycles\].
    pub(crate) fn latency(&self) -> u64 {
        work::latency(&self.operators, self.taken)
    }

    /// The smallest polygon that the machine can be handed keeps the link longest of what it takes at least: that is the rate.
    pub(crate) fn tell_rate(&self, facts: &mut Facts) {
        let smallest = |bump| self.taken.of(&Material::default(), bump, false).bytes();
        let bytes = Polygon::HEAD_BYTES + 3 * (Polygon::POSITION_BYTES + smallest(true).min(smallest(false)));
        let interval = self.kept(Charge { work: work::area(3), fetched: 0 }, bytes);
        facts.rate(0, self.latency() + interval - 1, interval);
    }

    pub(crate) fn tell_hardware(&self, facts: &mut Facts) {
        facts.operators("transform, clip, project, light", self.config.operators(), NUMBER);
        facts.hardware(HardwareKind::Registers, "matrices", 16 + 9 + 9_u32, NUMBER);
        facts.hardware(HardwareKind::Registers, "lights", 7 * LIGHTS, NUMBER);
        facts.hardware(HardwareKind::Registers, "corners of a clipped polygon", MOST_CORNERS, self.vertex_bits());
        facts.hardware(HardwareKind::Table, "vertex cache", self.config.vertex_cache, INDEX + self.vertex_bits());
    }

    /// A transformed vertex: clip and window coordinates, and all attributes that the machine may take.
    fn vertex_bits(&self) -> u32 {
        let is_taken = |lit: [LightingStage; 2]| lit.contains(&self.taken.lit);
        let all = SentAttributes {
            normal: is_taken([LightingStage::InMachine, LightingStage::Targets]),
            normal_map: self.taken.normal_maps,
            texture: self.taken.textures,
            color: true,
            brightness: is_taken([LightingStage::AtVertices, LightingStage::Targets]),
        };
        8 * NUMBER + 8 * all.bytes() as u32
    }
}

/// A number in single precision \[bits\].
const NUMBER: u32 = 32;
/// An index, with a bit each that says whether the vertex is there and whether it is lit.
const INDEX: u32 = 32 + 2;
/// Lights that there are registers for, seven numbers each: direction, half-way vector, intensity (assumed: as many as OpenGL asks
/// of an implementation; a scene with more is not refused).
const LIGHTS: u32 = 8;
/// Corners of a triangle that six planes cut.
const MOST_CORNERS: u32 = 9;
